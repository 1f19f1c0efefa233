#!/usr/bin/python3
"""The occupancy mapper as a node: what it publishes, saves and redraws, and what it refuses."""
import math
import os
import shutil
import sys
import threading
import time
import unittest

import rospy
import rostest
import tf2_msgs.msg
from geometry_msgs.msg import PoseStamped, TransformStamped
from map_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import MapMetaData, OccupancyGrid, Path
from nav_msgs.srv import GetMap
from ram_slam_msgs.srv import SaveMap
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Trigger

TIMEOUT_S = 10.0
RANGE_M = 3.0


def wait_until(condition):
    deadline = time.time() + TIMEOUT_S
    while time.time() < deadline:
        if condition():
            return True
        time.sleep(0.02)
    return False


def transform(parent, child, stamp, x, yaw=0.0):
    message = TransformStamped()
    message.header.stamp = rospy.Time.from_sec(stamp)
    message.header.frame_id = parent
    message.child_frame_id = child
    message.transform.translation.x = x
    message.transform.rotation.z = math.sin(yaw / 2)
    message.transform.rotation.w = math.cos(yaw / 2)
    return message


def scan(stamp):
    """All beams, a full turn of them, hit at RANGE_M."""
    message = LaserScan()
    message.header.stamp = rospy.Time.from_sec(stamp)
    message.header.frame_id = "laser"
    message.angle_min = -math.pi
    message.angle_increment = 2 * math.pi / 720
    message.angle_max = math.pi - message.angle_increment
    message.range_min = 0.1
    message.range_max = 20.0
    message.ranges = [RANGE_M] * 720
    return message


def cell(grid, x, y):
    column = int(math.floor((x - grid.info.origin.position.x) / grid.info.resolution))
    row = int(math.floor((y - grid.info.origin.position.y) / grid.info.resolution))
    if not (0 <= column < grid.info.width and 0 <= row < grid.info.height):
        return -1
    return grid.data[row * grid.info.width + column]


class OccupancyMapperNode(unittest.TestCase):
    def setUp(self):
        self.folder = rospy.get_param("/map_folder")
        shutil.rmtree(self.folder, ignore_errors=True)
        self.scans = rospy.Publisher("scan", LaserScan, queue_size=10)
        self.transforms = rospy.Publisher("/tf", tf2_msgs.msg.TFMessage, queue_size=10)
        self.corrections = rospy.Publisher("corrected_trajectory", Path, queue_size=1)
        self.received = {}
        self.subscribers = [
            rospy.Subscriber(topic, kind, lambda message, topic=topic: self.received.setdefault(topic, []).append(message))
            for topic, kind in (("map", OccupancyGrid), ("map_metadata", MapMetaData), ("map_updates", OccupancyGridUpdate))
        ]
        for service in ("dynamic_map", "occupancy_mapper/save_map", "occupancy_mapper/reset"):
            rospy.wait_for_service(service, TIMEOUT_S)
        self.dynamic_map = rospy.ServiceProxy("dynamic_map", GetMap)
        self.save_map = rospy.ServiceProxy("occupancy_mapper/save_map", SaveMap)
        rospy.ServiceProxy("occupancy_mapper/reset", Trigger)()
        self.assertTrue(wait_until(lambda: self.scans.get_num_connections() and self.transforms.get_num_connections()
                                   and self.corrections.get_num_connections()))

    def tearDown(self):
        for subscriber in self.subscribers:
            subscriber.unregister()
        shutil.rmtree(self.folder, ignore_errors=True)

    def see(self, stamp, x):
        """A scan of a robot at (x, 0); the laser sits 0.5 m ahead of its base."""
        self.transforms.publish([transform("map", "odom", stamp, 0.0), transform("odom", "base_link", stamp, x),
                                 transform("base_link", "laser", stamp, 0.5)])
        self.scans.publish(scan(stamp))

    def grid(self):
        return self.dynamic_map().map

    def test_map_shows_what_the_laser_saw_and_is_published_again_and_again(self):
        self.see(100.0, 0.025)
        self.assertTrue(wait_until(lambda: cell(self.grid(), 0.525, 0.025) == 0))
        grid = self.grid()
        self.assertEqual(cell(grid, 0.525 + RANGE_M, 0.025), 100)
        self.assertEqual(cell(grid, 0.525, RANGE_M - 0.1), 0)
        self.assertEqual(cell(grid, 0.525, RANGE_M + 0.2), -1)
        self.assertEqual(grid.header.frame_id, "map")
        self.assertEqual(grid.header.stamp.to_sec(), 100.0)
        self.received.clear()
        self.assertTrue(wait_until(lambda: len(self.received.get("map", [])) >= 2 and self.received.get("map_metadata")))
        self.assertEqual(self.received["map"][-1].data, grid.data)
        self.assertEqual(self.received["map_metadata"][-1], grid.info)

    def test_changes_inside_the_map_are_published_as_updates(self):
        self.see(100.0, 0.025)
        self.assertTrue(wait_until(lambda: self.received.get("map")))
        self.received.clear()
        self.see(101.0, 0.225)
        self.assertTrue(wait_until(lambda: self.received.get("map_updates") or self.received.get("map")))
        grid = self.grid()
        for update in self.received.get("map_updates", []):
            rows = [grid.data[(update.y + row) * grid.info.width + update.x:][:update.width] for row in range(update.height)]
            self.assertEqual(update.data, tuple(value for row in rows for value in row))

    def test_corrected_trajectory_moves_what_was_drawn(self):
        self.see(100.0, 0.025)
        self.assertTrue(wait_until(lambda: cell(self.grid(), 0.525 + RANGE_M, 0.025) == 100))
        path = Path()
        path.header.frame_id = "map"
        pose = PoseStamped()
        pose.header.stamp = rospy.Time.from_sec(100.0)
        pose.pose.position.x = 0.025
        pose.pose.position.y = 2.0
        pose.pose.orientation.w = 1.0
        path.poses = [pose]
        self.corrections.publish(path)
        self.assertTrue(wait_until(lambda: cell(self.grid(), 0.525 + RANGE_M, 2.025) == 100))
        self.assertEqual(cell(self.grid(), 0.525, -RANGE_M + 0.1), -1)

    def test_scan_without_a_pose_is_dropped_and_later_ones_are_mapped(self):
        self.see(100.0, 0.025)
        self.assertTrue(wait_until(lambda: self.grid().info.width > 0))
        self.scans.publish(scan(100.1))  # no transform states where that was
        lost = scan(100.2)
        lost.header.frame_id = "nowhere"
        self.scans.publish(lost)
        bad = scan(100.3)
        bad.ranges = []
        self.scans.publish(bad)
        for k in range(4):
            self.see(101.0 + 0.3 * k, 1.025 + k)
        self.assertTrue(wait_until(lambda: cell(self.grid(), 4.525 + RANGE_M, 0.025) == 100))

    def test_time_that_jumps_back_starts_a_new_map(self):
        self.see(100.0, 0.025)
        self.assertTrue(wait_until(lambda: self.grid().info.width > 0))
        # The first transforms may arrive before the jump was seen and be forgotten with the old ones.
        stamps = iter(range(1000))
        self.assertTrue(wait_until(lambda: self.see(10.0 + 0.2 * next(stamps), 30.025) or
                                   cell(self.grid(), 30.525 + RANGE_M, 0.025) == 100))
        self.assertEqual(cell(self.grid(), 0.525, 0.025), -1)

    def test_one_scan_of_another_clock_leaves_the_map_as_it_is(self):
        self.see(100.0, 0.025)
        self.assertTrue(wait_until(lambda: self.grid().info.width > 0))
        for stamp in (95.0, 100.1, 1000100.0, 100.2):
            self.scans.publish(scan(stamp))
        self.see(100.3, 30.025)
        self.assertTrue(wait_until(lambda: cell(self.grid(), 30.525 + RANGE_M, 0.025) == 100))
        self.assertEqual(cell(self.grid(), 0.525 + RANGE_M, 0.025), 100)

    def test_map_is_saved_in_its_folder_and_nowhere_else(self):
        answer = self.save_map("early")
        self.assertFalse(answer.success)
        self.assertIn("no map yet", answer.message)
        self.see(100.0, 0.025)
        self.assertTrue(wait_until(lambda: self.grid().info.width > 0))
        answer = self.save_map("office-1")
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(sorted(os.listdir(self.folder)), ["office-1.pgm", "office-1.yaml"])
        with open(os.path.join(self.folder, "office-1.yaml")) as file:
            self.assertIn("image: office-1.pgm\n", file.read())
        for name in ("", "..", "../escape", "/tmp/escape", "a/b", ".hidden", "a;b", "$(touch x)", "x" * 5000):
            self.assertFalse(self.save_map(name).success, name)
        self.assertEqual(sorted(os.listdir(self.folder)), ["office-1.pgm", "office-1.yaml"])
        self.assertFalse(os.path.exists(os.path.join(self.folder, "../escape.pgm")))

    def test_saves_at_the_same_time_are_all_whole(self):
        self.see(100.0, 0.025)
        self.assertTrue(wait_until(lambda: self.grid().info.width > 0))
        answers = []
        savers = [threading.Thread(target=lambda: answers.append(self.save_map("shared"))) for _ in range(8)]
        for saver in savers:
            saver.start()
        for saver in savers:
            saver.join()
        self.assertEqual([answer.success for answer in answers], [True] * 8, answers)
        grid = self.grid()
        with open(os.path.join(self.folder, "shared.pgm"), "rb") as file:
            self.assertEqual(len(file.read().split(b"255\n", 1)[1]), grid.info.width * grid.info.height)
        self.assertEqual(sorted(os.listdir(self.folder)), ["shared.pgm", "shared.yaml"])

    def test_save_that_fails_reports_why(self):
        self.see(100.0, 0.025)
        self.assertTrue(wait_until(lambda: self.grid().info.width > 0))
        os.makedirs(os.path.join(self.folder, "taken.pgm"))
        answer = self.save_map("taken")
        self.assertFalse(answer.success)
        self.assertIn("Is a directory", answer.message)


if __name__ == "__main__":
    rospy.init_node("occupancy_mapper_node_test")
    rostest.rosrun("ram_slam", "occupancy_mapper_node", OccupancyMapperNode, sys.argv)
