#!/usr/bin/python3
"""check_structure.py: who may include whom, and how long a file may be.

Cores know no ROS; the simulator knows no SLAM code; a lower folder of ram_slam does not include a higher one. (How long a
function may be is clang-tidy's, .clang-tidy.)
"""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MOST_LINES = 400
ROS = re.compile(r'#include [<"](ros/|rosbag/|tf2|pluginlib/|\w+_msgs/|std_srvs/)')
SLAM = re.compile(r"\b(ram_slam|ramscout_kinematics|ramscout_feature_detector)(/|::|</)")
# Floors of ram_slam, lowest first: a folder may include its own and lower floors.
FLOORS = [["geometry"], ["landmarks", "sensing", "motion", "io"], ["scan_matching", "calibration", "pose_graph", "occupancy"],
          ["smoothing", "fast_slam", "world_map"], ["tracking"], ["estimation"], ["stages"]]
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


def main():
    files = subprocess.run(["git", "ls-files", "*.hpp", "*.cpp", "*.py", "*/CMakeLists.txt", "*/package.xml"], cwd=ROOT,
                           check=True, capture_output=True, text=True).stdout.split()
    findings = []
    for name in files:
        if not (ROOT / name).is_file():
            continue
        findings += boundary_findings(name)
        count = len((ROOT / name).read_text().splitlines())
        if count > MOST_LINES:
            findings.append("%s: %d lines, at most %d" % (name, count, MOST_LINES))
    print("\n".join(findings), end="\n" if findings else "", file=sys.stderr)
    sys.exit(1 if findings else 0)


main()
