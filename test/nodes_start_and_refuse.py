#!/usr/bin/python3
"""Every node starts alone with its shipped file, stops on SIGTERM, and refuses bad parameters with one FATAL
line and a non-zero exit code. (A key of a shipped file that no node reads makes its node refuse to start.)"""
import itertools
import os
import pathlib
import re
import signal
import subprocess
import time
import unittest

import rostest

# shipped file, named as its node: (package, a parameter it has, a value out of its range)
NODES = {
    "ekf_slam": ("ram_slam", "max_landmarks", "0"),
    "ukf_localiser": ("ram_slam", "association_gate", "0.0"),
    "fast_slam": ("ram_slam", "particle_amount", "-1"),
    "landmark_smoother": ("ram_slam", "reading_share", "0.0"),
    "laser_odometry": ("ram_slam", "key_scan_distance_m", "0.0"),
    "map_smoother": ("ram_slam", "key_scan_distance_m", "0.0"),
    "occupancy_mapper": ("ram_slam", "resolution", "0.0"),
    "kinematics": ("ramscout_kinematics", "buffer_duration_s", "-1.0"),
    "edge_detector": ("ramscout_feature_detector", "bend_scale", "0.0"),
    "feature_detector": ("ramscout_feature_detector", "ppm", "0"),
    "simulator": ("ramscout_sim", "physics_rate_hz", "-1.0"),
    "world_map": ("ram_slam", "map_folder", None),  # has texts only: any number is one, none is out of range
}
ESTIMATORS = ("ekf_slam", "ukf_localiser")  # run by the node fast_slam, too
CONFIG = pathlib.Path(__file__).resolve().parent.parent / "config"
NEEDED = {"simulator": ["_robot:=" + str(CONFIG / "robots" / "ramscout.urdf")]}  # it has no robot of its own
START_TIMEOUT_S = 20.0
ALIVE_S = 1.5
STOP_TIMEOUT_S = 5.0
fresh_number = itertools.count()  # parameters outlive their node: no name is used twice


def start(node, *parameters, file=None):
    package = NODES[node][0]
    name = "%s_%d" % (node, next(fresh_number))
    if file is not None:
        subprocess.run(["rosparam", "load", str(file), "/" + name], check=True, stdout=subprocess.DEVNULL)
    if node in ESTIMATORS:
        node, parameters = "fast_slam", ("_node/estimator:=" + node, *parameters)
    return subprocess.Popen(
        ["rosrun", package, node, "__name:=" + name, *parameters],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)


def fatal_lines(output):
    return [line for line in output.splitlines() if re.search(r"FATAL", line)]


class NodesStartAndRefuse(unittest.TestCase):
    def refuses(self, node, parameter, expected):
        process = start(node, parameter)
        try:
            output, _ = process.communicate(timeout=START_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            self.fail("%s with %s did not exit" % (node, parameter))
        self.assertNotEqual(process.returncode, 0, output)
        self.assertEqual(len(fatal_lines(output)), 1, output)
        self.assertIn(expected, fatal_lines(output)[0])

    def starts_alone_and_stops_on_request(self, node, file):
        process = start(node, *NEEDED.get(node, []), file=file)
        time.sleep(ALIVE_S)
        exit_code = process.poll()
        if exit_code is None:
            os.killpg(process.pid, signal.SIGTERM)
        output, _ = process.communicate(timeout=STOP_TIMEOUT_S)
        self.assertIsNone(exit_code, output)

    def test_every_shipped_file_belongs_to_a_node(self):
        others = {"reuse"}  # of scripts/reuse.py
        self.assertEqual({path.stem for path in CONFIG.glob("*.yaml")} - others, set(NODES))


def add_tests(node):
    _, key, bad_value = NODES[node]
    tests = {"refuses_an_unknown_key": lambda self: self.refuses(node, "_no_such_key:=1", "no_such_key")}
    if bad_value is not None:
        tests["refuses_a_value_out_of_range"] = lambda self: self.refuses(node, "_%s:=%s" % (key, bad_value), key)
        tests["refuses_a_wrong_type"] = lambda self: self.refuses(node, "_%s:=text" % key, key)
    tests["starts_alone_with_its_file_and_stops_on_request"] = (
        lambda self: self.starts_alone_and_stops_on_request(node, CONFIG / (node + ".yaml")))
    for name, test in tests.items():
        setattr(NodesStartAndRefuse, "test_%s_%s" % (node, name), test)


for node_type in NODES:
    add_tests(node_type)

if __name__ == "__main__":
    rostest.rosrun("ramscout_bringup", "nodes_start_and_refuse", NodesStartAndRefuse)
