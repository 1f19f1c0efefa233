#!/usr/bin/python3
"""check_docs.py: what the documents name must exist.

Relative links; `make` targets; `roslaunch PACKAGE FILE` with its arguments; `rosrun PACKAGE PROGRAM`; paths; and names with
an underscore in backticks (parameters, topics, files, functions), which must occur somewhere in the sources.
"""
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# Names of ROS and catkin that the sources do not use.
OTHERS_NAMES = {"ROS_DEBUG", "ROS_ERROR", "ROS_FATAL", "catkin_generate_changelog"}
# The first part of a path that belongs to this repository; others (results/, build/) come into being when things run.
OWN_FOLDERS = ("src/", "config/", "docs/", "launch/", "scripts/", "test/")


def tracked():
    return subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\n")[:-1]


def words_of_sources(files):
    words = {"%s_%s" % (path.name, kind) for path in (ROOT / "src").iterdir() for kind in ("test", "benchmark")}
    for name in files:
        path = ROOT / name
        words.update(re.findall(r"\w+", name))
        if path.suffix not in (".md", ".rst", ".png") and path.is_file():
            words.update(re.findall(r"\w+", path.read_text(errors="replace")))
    return words


def dead_links(document, text):
    for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", text):
        if "://" not in target and not (document.parent / target).exists():
            yield "link to " + target


def unknown_targets(text):
    makefile = (ROOT / "Makefile").read_text()
    targets = set(re.findall(r"^([\w-]+):", makefile, re.M))
    for target in re.findall(r"(?:^|`)make ([a-z][\w-]*)", text, re.M):
        if target not in targets:
            yield "make " + target


def wrong_launches(text):
    for package, name, rest in re.findall(r"roslaunch (\w+) ([\w.]+)([^`\n]*)", text):
        path = next((path for way in ("*/", "**/") for path in (ROOT / "src" / package).glob(way + name)), None)
        if path is None:
            yield "roslaunch %s %s" % (package, name)
            continue
        known = {arg.get("name") for arg in ElementTree.parse(path).getroot().iter("arg")}
        for argument in re.findall(r"(\w+):=", rest):
            if argument not in known:
                yield "argument %s of %s" % (argument, name)


def unknown_programs(text):
    for package, program in re.findall(r"rosrun (\w+) ([a-z]\w*)", text):
        cmake = ROOT / "src" / package / "CMakeLists.txt"
        if cmake.exists() and not re.search(r"(add_executable\(|scripts/)%s\b" % program, cmake.read_text()):
            yield "rosrun %s %s" % (package, program)


def missing_paths(text):
    for code in re.findall(r"`([^`\n]+)`", text):
        for path in re.findall(r"[\w./*-]+", code):
            if path.startswith(OWN_FOLDERS) and re.fullmatch(r"[\w./*-]+", code):
                if not any(list(folder.glob(path.rstrip("/"))) for folder in (ROOT, *(ROOT / "src").iterdir())):
                    yield "path " + path


def unknown_names(text, words):
    for code in re.findall(r"`([A-Za-z]\w*(?:[/:.]+\w+)*)(?:\(\))?`", text):
        for name in re.findall(r"\w+", code):
            if "_" in name and name not in words | OTHERS_NAMES:
                yield "name " + name


def main():
    files = tracked()
    words = words_of_sources(files)
    findings = []
    for name in files:
        if not name.endswith(".md") or name == "docs/parameters.md":  # that one is made from the code
            continue
        document = ROOT / name
        text = document.read_text()
        prose = re.sub(r"```diff.*?```", "", text, flags=re.S)  # what a reader is to add does not exist yet
        found = [*dead_links(document, text), *unknown_targets(text), *wrong_launches(prose), *unknown_programs(prose),
                 *missing_paths(prose)]
        if name != "docs/parameters.md":  # made from tables, in which keys get their prefixes
            found += unknown_names(prose, words)
        findings += ["%s: no such %s" % (name, what) for what in dict.fromkeys(found)]
    print("\n".join(findings), end="\n" if findings else "", file=sys.stderr)
    sys.exit(1 if findings else 0)


main()
