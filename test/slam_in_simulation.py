#!/usr/bin/python3
"""The whole stack drives the office tour: its estimate is good, its files are complete, its bag can be run again.

The launch file beside it starts the graph with a recorder of the bag given in `~bag`.
"""
import hashlib
import json
import os
import subprocess
import tempfile
import time
import unittest

import rosbag
import rospy
import rostest

RESULT_FILES = ("map.pgm", "map.yaml", "map.png", "trajectory.tum", "trajectory_online.tum", "landmarks.yaml",
                "summary.json")
MAX_OFFLINE_POSITION_ERROR_M = 0.15
MAX_OFFLINE_YAW_ERROR_DEG = 1.5
MIN_OCCUPIED_IOU = 0.7  # within one cell
MIN_FREE_IOU = 0.95
MAX_WALL_DISTANCE_M = 0.06


def run(*command, timeout_s=600):
    finished = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=timeout_s)
    return finished.returncode, finished.stdout


def digests(folder):
    names = sorted(name for name in os.listdir(folder) if name != "timing.json")
    return {name: hashlib.sha256(open(os.path.join(folder, name), "rb").read()).hexdigest() for name in names}


class SlamInSimulation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.live = os.path.join(cls.folder.name, "live")
        os.mkdir(cls.live)
        cls.status, cls.output = run("rosrun", "ramscout_bringup", "record_results", "_output:=" + cls.live)
        print(cls.output)
        subprocess.run(["rosnode", "kill", "/record"], stdout=subprocess.DEVNULL, timeout=30)
        cls.bag = rospy.get_param("/slam_in_simulation/bag")
        deadline = time.time() + 30.0
        while not os.path.exists(cls.bag) and time.time() < deadline:
            time.sleep(0.1)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()
        if os.path.exists(cls.bag):
            os.remove(cls.bag)

    def test_1_the_verdict_is_good_and_all_files_are_there(self):
        self.assertEqual(self.status, 0, self.output)
        for name in RESULT_FILES + ("ground_truth.tum",):
            self.assertGreater(os.path.getsize(os.path.join(self.live, name)), 0, name)
        with open(os.path.join(self.live, "summary.json")) as file:
            summary = json.load(file)
        self.assertGreater(summary["distance_m"], 100.0)

    def test_2_the_bag_shows_everything_from_any_second_on(self):
        last = {"/map": None, "/landmarks": None, "laser": None}
        longest_gap_s = dict.fromkeys(last, 0.0)
        with rosbag.Bag(self.bag) as bag:
            start_s = bag.get_start_time()
            for topic, message, stamp in bag.read_messages(topics=["/map", "/landmarks", "/tf_static"]):
                key = topic
                if topic == "/tf_static":
                    if not any(transform.child_frame_id == "laser" for transform in message.transforms):
                        continue
                    key = "laser"
                longest_gap_s[key] = max(longest_gap_s[key], stamp.to_sec() - (last[key] or start_s))
                last[key] = stamp.to_sec()
        for key, gap_s in longest_gap_s.items():
            self.assertIsNotNone(last[key], key)
            self.assertLess(gap_s, 15.0, key)

    def test_3_run_bag_gives_the_same_bytes_twice_and_is_as_good(self):
        folders = [os.path.join(self.folder.name, name) for name in ("first", "second")]
        for folder in folders:
            status, output = run("rosrun", "ramscout_bringup", "run_bag", self.bag, "--output", folder)
            self.assertEqual(status, 0, output)
        for name in RESULT_FILES:
            self.assertIn(name, digests(folders[0]))
        self.assertEqual(digests(folders[0]), digests(folders[1]))

        table_file = os.path.join(self.folder.name, "errors.json")
        status, output = run("rosrun", "ramscout_bringup", "evaluate", os.path.join(folders[0], "trajectory.tum"),
                             "--ground-truth", os.path.join(self.live, "ground_truth.tum"), "--json", table_file)
        self.assertEqual(status, 0, output)
        with open(table_file) as file:
            rms = {row["name"]: row["rms"] for row in json.load(file)}
        self.assertLess(rms["absolute, aligned (ATE): position"], MAX_OFFLINE_POSITION_ERROR_M)
        self.assertLess(rms["absolute, aligned (ATE): yaw"], MAX_OFFLINE_YAW_ERROR_DEG)

    def test_4_the_map_looks_like_the_world(self):
        true_map = os.path.join(self.folder.name, "true_map")
        status, output = run("rosrun", "ramscout_sim", "export_world_map", rospy.get_param("/simulator/world"), true_map)
        self.assertEqual(status, 0, output)
        quality_file = os.path.join(self.folder.name, "quality.json")
        status, output = run("rosrun", "ramscout_bringup", "evaluate_map", os.path.join(self.live, "map.yaml"),
                             "--true-map", true_map + ".yaml",
                             "--trajectory", os.path.join(self.live, "trajectory.tum"),
                             "--ground-truth", os.path.join(self.live, "ground_truth.tum"), "--json", quality_file)
        self.assertEqual(status, 0, output)
        with open(quality_file) as file:
            quality = json.load(file)
        self.assertGreater(quality["occupied IoU"], MIN_OCCUPIED_IOU)
        self.assertGreater(quality["free IoU"], MIN_FREE_IOU)
        self.assertLess(quality["wall distance, mean [m]"], MAX_WALL_DISTANCE_M)


if __name__ == "__main__":
    rospy.init_node("slam_in_simulation_setup", anonymous=True, disable_rostime=True)
    rostest.rosrun("ramscout_bringup", "slam_in_simulation", SlamInSimulation)
