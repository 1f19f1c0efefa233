#!/usr/bin/python3
"""Every node starts alone, stops on SIGTERM, and refuses bad parameters with one FATAL line and a non-zero exit code."""
import itertools
import os
import re
import signal
import subprocess
import time
import unittest

import rostest

# node type: (package, a parameter it has, a value out of its range)
NODES = {
    "fast_slam": ("ram_slam", "particle_amount", "-1"),
    "laser_odometry": ("ram_slam", "key_scan_distance_m", "0.0"),
    "map_smoother": ("ram_slam", "key_scan_distance_m", "0.0"),
    "occupancy_mapper": ("ram_slam", "resolution", "0.0"),
    "kinematics": ("ramscout_kinematics", "buffer_duration_s", "-1.0"),
    "feature_detector": ("ramscout_feature_detector", "ppm", "0"),
    "simulator": ("ramscout_sim", "physics_rate_hz", "-1.0"),
}
START_TIMEOUT_S = 20.0
ALIVE_S = 1.5
STOP_TIMEOUT_S = 5.0
fresh_number = itertools.count()  # parameters outlive their node: no name is used twice


def start(node, *parameters):
    package = NODES[node][0]
    return subprocess.Popen(
        ["rosrun", package, node, "__name:=%s_%d" % (node, next(fresh_number)), *parameters],
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

    def starts_alone_and_stops_on_request(self, node):
        process = start(node)
        time.sleep(ALIVE_S)
        exit_code = process.poll()
        os.killpg(process.pid, signal.SIGTERM)
        output, _ = process.communicate(timeout=STOP_TIMEOUT_S)
        self.assertIsNone(exit_code, output)


def add_tests(node):
    _, key, bad_value = NODES[node]
    tests = {
        "starts_alone_and_stops_on_request": lambda self: self.starts_alone_and_stops_on_request(node),
        "refuses_an_unknown_key": lambda self: self.refuses(node, "_no_such_key:=1", "no_such_key"),
        "refuses_a_value_out_of_range": lambda self: self.refuses(node, "_%s:=%s" % (key, bad_value), key),
        "refuses_a_wrong_type": lambda self: self.refuses(node, "_%s:=text" % key, key),
    }
    for name, test in tests.items():
        setattr(NodesStartAndRefuse, "test_%s_%s" % (node, name), test)


for node_type in NODES:
    add_tests(node_type)

if __name__ == "__main__":
    rostest.rosrun("ramscout_bringup", "nodes_start_and_refuse", NodesStartAndRefuse)
