#!/usr/bin/python3
"""tidy.py [FILE...]: clang-tidy over the cores' sources, or over the files named; needs build/compile_commands.json.

Nodes and programs are left out for the time that ROS's headers take: name them to check them.

A file that was clean is not looked into again while it, .clang-tidy, its command and the workspace's headers that it
includes stay the same: build/tidy holds an empty file named by their hash.
"""
import hashlib
import json
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from os import cpu_count
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CACHE = ROOT / "build" / "tidy"
INCLUDE_FOLDERS = [*ROOT.glob("src/*/include"), *ROOT.glob("src/*/ros"), *ROOT.glob("src/*/benchmark")]


@lru_cache(maxsize=None)
def includes(path):
    """The workspace's headers that a file includes, directly or not."""
    found = set()
    for name in re.findall(r'#include "([^"]+)"', path.read_text()):
        for folder in (path.parent, *INCLUDE_FOLDERS):
            header = (folder / name).resolve()
            if header.is_file() and header != path:
                found |= {header} | includes(header)
                break
    return frozenset(found)


def key_of(path, command):
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes() + command.encode())
    for part in (path, *sorted(includes(path))):
        digest.update(part.read_bytes())
    return digest.hexdigest()


def check(path, command):
    """What clang-tidy found, or an empty text."""
    mark = CACHE / key_of(path, command)
    if mark.exists():
        return ""
    run = subprocess.run(["clang-tidy", "-p", str(ROOT / "build"), "--quiet", "--warnings-as-errors=*", str(path)],
                         capture_output=True, text=True)
    if run.returncode == 0:
        mark.touch()
        return ""
    return run.stdout or run.stderr


def main():
    wanted = {Path(name).resolve() for name in sys.argv[1:]}
    commands = {}
    for entry in json.loads((ROOT / "build" / "compile_commands.json").read_text()):
        path = Path(entry["file"]).resolve()
        if ROOT not in path.parents:
            continue
        is_source = re.fullmatch(r"src/\w+/src/.*", str(path.relative_to(ROOT))) is not None
        if path.is_file() and (path in wanted if wanted else is_source):
            commands[path] = entry["command"]
    CACHE.mkdir(exist_ok=True)
    with ThreadPoolExecutor(cpu_count()) as pool:
        results = [text for text in pool.map(check, commands.keys(), commands.values()) if text]
    findings = sorted(set(re.findall(r"^\S+: (?:warning|error): .*$", "\n".join(results), re.M)))
    print("\n".join(findings or results), end="\n" if results else "", file=sys.stderr)
    sys.exit(1 if results else 0)


main()
