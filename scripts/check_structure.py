#!/usr/bin/python3
"""check_structure.py: who may include whom, how long files and functions may be, and which tests there must be.

Cores know no ROS and print nothing; the simulator knows no SLAM code; a lower folder of ram_slam does not include a higher one. Every source of
a core has a test file of its name, or a comment in the package's CMakeLists.txt names it.
"""
import math
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MOST_LINES = 400
MOST_FUNCTION_LINES = 60
MOST_FUNCTION_LINES_P95 = 30
LEAST_TEST_SHARE = 0.7  # lines of tests for each line of sources
MOST_CONSTANTS = 150  # in sources; what tunes behaviour is a parameter
CONSTANT = re.compile(r"^\s*(?:static |inline )*(?:constexpr|const) [\w:<>, ]+ k[A-Z]\w*(?:\[\w*\])? ?[={]", re.M)
ROS = re.compile(r'#include [<"](ros/|rosbag/|tf2|pluginlib/|\w+_msgs/|std_srvs/)')
PRINT = re.compile(r"\bf?printf\(|std::(cout|cerr|clog)\b")
SLAM = re.compile(r"\b(ram_slam|ramscout_kinematics|ramscout_feature_detector)(/|::|</)")
# Floors of ram_slam, lowest first: a folder may include its own and lower floors.
FLOORS = [["geometry"], ["landmarks", "sensing", "motion", "io"], ["scan_matching", "calibration", "pose_graph", "occupancy"],
          ["smoothing", "fast_slam", "world_map"], ["ekf_slam", "ukf_localiser"], ["tracking"], ["estimation"], ["stages"]]
FLOOR_OF = {folder: floor for floor, folders in enumerate(FLOORS) for folder in folders}


def lines_matching(name, pattern):
    for number, line in enumerate((ROOT / name).read_text().splitlines(), 1):
        match = pattern.search(line)
        if match:
            yield number, line.strip(), match


def boundary_findings(name):
    if re.match(r"src/\w+/(include|src)/", name):
        for number, line, _ in lines_matching(name, ROS):
            yield "%s:%d: a core includes ROS: %s" % (name, number, line)
        if not name.endswith("_main.cpp"):
            for number, line, _ in lines_matching(name, PRINT):
                yield "%s:%d: a core prints: %s" % (name, number, line)
    if name.startswith("src/ramscout_sim/"):
        for number, line, _ in lines_matching(name, SLAM):
            yield "%s:%d: the simulator uses SLAM code: %s" % (name, number, line)
    own = re.match(r"src/ram_slam/(?:include/ram_slam|src)/(\w+)/", name)
    if own:
        if own[1] not in FLOOR_OF:
            yield "%s: its folder has no floor in scripts/check_structure.py" % name
            return
        for number, _, match in lines_matching(name, re.compile(r'#include "ram_slam/(\w+)/')):
            if FLOOR_OF.get(match[1], -1) > FLOOR_OF[own[1]]:
                yield "%s:%d: %s/ includes %s/, which is above it" % (name, number, own[1], match[1])


def blanked(text):
    """The text with comments, strings and directives replaced by spaces."""
    pattern = r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*'
    return re.sub(pattern, lambda match: re.sub(r"[^\n]", " ", match[0]), text, flags=re.S | re.M)


def functions(text):
    """First line and number of lines of each function's body, found by matching braces."""
    text = blanked(text)
    open_braces = []  # kind and position of each
    head = 0  # where the declaration before a brace begins
    for match in re.finditer(r"[{};]", text):
        at = match.start()
        if match[0] == "{":
            outer = open_braces[-1][0] if open_braces else "scope"
            declaration = text[head:at]
            kind = "block"
            if outer == "scope" and re.search(r"\b(namespace|class|struct|enum|union|extern)\b[^()]*$", declaration):
                kind = "scope"
            elif outer == "scope" and re.search(r"\)\s*(const|noexcept|override|final|->[^{]*|\s)*(:[^;]*)?$", declaration):
                kind = "function"
            open_braces.append((kind, at))
            if kind != "block":
                head = at + 1
        elif match[0] == "}":
            kind, start = open_braces.pop()
            if kind == "function" and text[at + 1:].lstrip()[:1] in (",", "{"):
                continue  # it initialised a member; the body follows
            if kind == "function":
                yield text.count("\n", 0, start) + 1, text.count("\n", start, at) + 1
            if kind != "block" or open_braces and open_braces[-1][0] != "scope":
                head = at + 1
        else:
            head = at + 1


def function_findings(names):
    lengths = []
    for name in names:
        for line, length in functions((ROOT / name).read_text()):
            lengths.append(length)
            if length > MOST_FUNCTION_LINES:
                yield "%s:%d: a function of %d lines, at most %d" % (name, line, length, MOST_FUNCTION_LINES)
    p95 = sorted(lengths)[math.ceil(0.95 * len(lengths)) - 1]
    if p95 > MOST_FUNCTION_LINES_P95:
        yield "one function in twenty has more than %d lines, at most %d" % (p95 - 1, MOST_FUNCTION_LINES_P95)


def untested_findings(name):
    own = re.match(r"(src/\w+)/src/((?:.*/)?(\w+))\.cpp$", name)
    if not own or name.endswith("_main.cpp") or (ROOT / own[1] / "test" / (own[2] + "_test.cpp")).is_file():
        return
    comments = " ".join(re.findall(r"^\s*#(.*)", (ROOT / own[1] / "CMakeLists.txt").read_text(), re.M))
    if not re.search(r"\b%s\b" % own[3], comments):
        yield "%s: no test/%s_test.cpp, and no comment in %s/CMakeLists.txt states why" % (name, own[2], own[1])


def test_share_findings(files):
    """Benchmarks and fuzzers are neither sources nor tests."""
    def lines_of(pattern):
        return sum(len((ROOT / name).read_text().splitlines()) for name in files if re.fullmatch(pattern, name))
    sources = lines_of(r"src/\w+/(include|src|ros|apps)/.*\.(hpp|cpp|py)")
    tests = lines_of(r"(src/\w+/)?test/.*\.(hpp|cpp|py)")
    if tests < LEAST_TEST_SHARE * sources:
        yield "%d lines of tests for %d lines of sources, wanted %.1f for each" % (tests, sources, LEAST_TEST_SHARE)


def main():
    files = subprocess.run(["git", "ls-files", "*.hpp", "*.cpp", "*.py", "*/CMakeLists.txt", "*/package.xml"], cwd=ROOT,
                           check=True, capture_output=True, text=True).stdout.split()
    files = [name for name in files if (ROOT / name).is_file()]
    code = [name for name in files if re.fullmatch(r"src/\w+/(include|src|ros|apps)/.*\.(hpp|cpp)", name)]
    findings = list(function_findings(code))
    constants = sum(len(CONSTANT.findall((ROOT / name).read_text())) for name in code if name.endswith(".cpp"))
    if constants > MOST_CONSTANTS:
        findings.append("%d constants in sources, at most %d" % (constants, MOST_CONSTANTS))
    findings += test_share_findings(files)
    for name in files:
        findings += boundary_findings(name)
        findings += untested_findings(name)
        count = len((ROOT / name).read_text().splitlines())
        if count > MOST_LINES:
            findings.append("%s: %d lines, at most %d" % (name, count, MOST_LINES))
    print("\n".join(findings), end="\n" if findings else "", file=sys.stderr)
    sys.exit(1 if findings else 0)


main()
