#!/usr/bin/python3
"""The whole stack drives the office tour: its estimate is good, its files are complete, its bag can be run again.

The launch file beside it starts the graph with a recorder of the bag given in `~bag`.
"""
import hashlib
import json
import os
import signal
import socket
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
MAX_START_S = 2.0  # until the bag has published where the laser is
MAX_LATE_SCANS = 2  # the last ones may still wait for their odometry when the bag ends


def run(*command, timeout_s=600):
    finished = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=timeout_s)
    return finished.returncode, finished.stdout


def copy_bag(source, target, wanted, seconds):
    """Copies messages for which wanted(topic, message) gives a message, of the first seconds of a bag.

    Returns the stamps of its scans.
    """
    scans = []
    with rosbag.Bag(source) as bag, rosbag.Bag(target, "w") as copy:
        end = rospy.Time.from_sec(bag.get_start_time() + seconds)
        for topic, message, stamp in bag.read_messages(end_time=end):
            message = wanted(topic, message)
            if message is not None:
                copy.write(topic, message, stamp)
                if topic == "/scan":
                    scans.append(message.header.stamp.to_sec())
    return scans


def sensors_only(topic, message):
    if topic == "/tf":
        message.transforms = [entry for entry in message.transforms if entry.header.frame_id != "map"]
        return message
    return message if topic in ("/scan", "/odom", "/tf_static") else None


def scans_only(topic, message):
    return message if topic in ("/scan", "/tf_static") else None


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return str(probe.getsockname()[1])


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

    def test_1_the_summary_is_good_and_all_files_are_there(self):
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

        self.expect_good(folders[0])

    def expect_good(self, folder):
        table_file = os.path.join(folder, "errors.json")
        status, output = run("rosrun", "ramscout_bringup", "evaluate", os.path.join(folder, "trajectory.tum"),
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

    def test_5_run_bag_stops_with_what_it_has(self):
        folder = os.path.join(self.folder.name, "stopped")
        process = subprocess.Popen(["rosrun", "ramscout_bringup", "run_bag", self.bag, "--output", folder],
                                   stdout=subprocess.PIPE, text=True, start_new_session=True)
        shown = ""
        while shown.count("*") < 10:
            character = process.stdout.read(1)
            self.assertNotEqual(character, "", shown)
            shown += character
        os.killpg(process.pid, signal.SIGINT)
        shown += process.communicate(timeout=120)[0]
        self.assertEqual(process.returncode, 0, shown)
        self.assertIn("stopped", shown)
        with open(os.path.join(folder, "summary.json")) as file:
            self.assertLess(json.load(file)["distance_m"], 100.0)
        self.expect_good(folder)

    def test_6_without_odometry_the_scans_tell_the_motion(self):
        bag = os.path.join(self.folder.name, "scans.bag")
        scans = copy_bag(self.bag, bag, scans_only, 30.0)
        folder = os.path.join(self.folder.name, "scans")
        status, output = run("rosrun", "ramscout_bringup", "run_bag", bag, "--output", folder)
        self.assertEqual(status, 0, output)
        with open(os.path.join(folder, "summary.json")) as file:
            summary = json.load(file)
        self.assertIn("scans alone", summary["motion_from"])
        self.assertEqual(summary["poses"], len(scans))
        self.expect_good(folder)

    def test_7_a_bag_played_to_the_stack_loses_nothing(self):
        bag = os.path.join(self.folder.name, "sensors.bag")
        scans = copy_bag(self.bag, bag, sensors_only, 30.0)
        folder = os.path.join(self.folder.name, "played")
        os.mkdir(folder)
        port = free_port()
        environment = dict(os.environ, ROS_MASTER_URI="http://localhost:" + port)
        finished = subprocess.run(
            ["roslaunch", "-p", port, "ramscout_bringup", "play.launch", "bag:=" + bag, "rate:=2", "delay:=15",
             "output:=" + folder],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=180, env=environment)
        with open(os.path.join(folder, "trajectory_online.tum")) as file:
            poses = {line.split()[0] for line in file if not line.startswith("#")}
        first = min(float(stamp) for stamp in poses)
        self.assertLess(first, scans[0] + MAX_START_S, finished.stdout)
        possible = sum(1 for stamp in scans if stamp > first - 1e-6)
        self.assertGreaterEqual(len(poses), possible - MAX_LATE_SCANS, finished.stdout)
        self.expect_good(folder)

    def test_8_a_carmen_log_becomes_a_bag(self):
        log = os.path.join(self.folder.name, "room.clf")
        bag = os.path.join(self.folder.name, "room.bag")
        with open(log, "w") as file:
            for i in range(5):
                pose = "%.2f 0 0" % (0.1 * i)
                file.write("FLASER 180 " + " ".join(["2.5"] * 180) + " %s %s %d.0 host %d.0\n" % (pose, pose, i + 1, i))
        status, output = run("rosrun", "ramscout_bringup", "log_to_bag", log, bag)
        self.assertEqual(status, 0, output)
        with rosbag.Bag(bag) as written:
            topics = {name: info.message_count for name, info in written.get_type_and_topic_info().topics.items()}
            odometry = [message.pose.pose.position.x for _, message, _ in written.read_messages(topics=["/odom"])]
        self.assertEqual(topics, {"/scan": 5, "/odom": 5, "/tf": 5, "/tf_static": 1})
        self.assertEqual(odometry, [0.0, 0.1, 0.2, 0.3, 0.4])


if __name__ == "__main__":
    rospy.init_node("slam_in_simulation_setup", anonymous=True, disable_rostime=True)
    rostest.rosrun("ramscout_bringup", "slam_in_simulation", SlamInSimulation)
