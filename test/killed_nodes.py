#!/usr/bin/python3
"""Nodes are killed while the robot drives, and respawned: pose, landmarks and map continue."""
import math
import os
import signal
import sys
import time
import unittest
import xmlrpc.client

import rosgraph
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from ram_slam_msgs.msg import LandmarkMap
from rosgraph_msgs.msg import Clock
from tf2_msgs.msg import TFMessage

DRIVE_S = 12.0
TIMEOUT_S = 60.0
LONGEST_GAP_S = 5.0
POSITION_M = 0.1
YAW_RAD = 0.02
KEPT_SHARE = 0.9
BRIDGED_M = 0.3  # what wheels do to a pose that was left to them for some seconds
BRIDGED_RAD = 0.05


def yaw_of(orientation):
    return 2.0 * math.atan2(orientation.z, orientation.w)


def wait_until(condition):
    deadline = time.time() + TIMEOUT_S
    while time.time() < deadline:
        if condition():
            return True
        time.sleep(0.05)
    return False


class KilledNodes(unittest.TestCase):
    def setUp(self):
        self.truth = {}
        self.poses = []
        self.landmarks = None
        self.map = None
        self.map_count = 0
        self.tf_times = []
        self.subscribers = [rospy.Subscriber(*topic, queue_size=100, tcp_nodelay=True) for topic in (
            ("ground_truth", Odometry, self.on_truth), ("pose", PoseWithCovarianceStamped, self.poses.append),
            ("landmarks", LandmarkMap, self.on_landmarks), ("map", OccupancyGrid, self.on_map),
            ("/tf", TFMessage, self.on_tf))]

    def on_truth(self, message):
        self.truth[message.header.stamp.to_nsec()] = message.pose.pose

    def on_landmarks(self, message):
        self.landmarks = message

    def on_map(self, message):
        self.map = message
        self.map_count += 1

    def on_tf(self, message):
        if any(transform.header.frame_id == "map" for transform in message.transforms):
            self.tf_times.append(time.time())

    def pid(self, node):
        uri = rosgraph.Master("/killed_nodes").lookupNode(node)
        return xmlrpc.client.ServerProxy(uri).getPid("/killed_nodes")[2]

    def error(self):
        """Of the newest pose that has a truth, in the frame of the first one: distance and angle."""
        pairs = [(pose.pose.pose, self.truth[pose.header.stamp.to_nsec()]) for pose in list(self.poses)
                 if pose.header.stamp.to_nsec() in self.truth]
        (first, first_truth), (last, last_truth) = pairs[0], pairs[-1]

        def relative(origin, pose):
            yaw = yaw_of(origin.orientation)
            x, y = pose.position.x - origin.position.x, pose.position.y - origin.position.y
            return (math.cos(yaw) * x + math.sin(yaw) * y, math.cos(yaw) * y - math.sin(yaw) * x,
                    yaw_of(pose.orientation) - yaw)

        a, b = relative(first, last), relative(first_truth, last_truth)
        return math.hypot(a[0] - b[0], a[1] - b[1]), abs(math.remainder(a[2] - b[2], 2.0 * math.pi))

    def occupied(self):
        """Places of occupied cells, in cells of the map's resolution."""
        info = self.map.info
        column = round(info.origin.position.x / info.resolution)
        row = round(info.origin.position.y / info.resolution)
        return {(i % info.width + column, i // info.width + row) for i, cell in enumerate(self.map.data) if cell > 50}

    def test_1_the_estimator(self):
        self.assertTrue(wait_until(lambda: len(self.poses) > 10))
        rospy.sleep(DRIVE_S)
        self.assertTrue(wait_until(lambda: self.map is not None))
        walls = self.occupied()
        landmarks = {landmark.id for landmark in self.landmarks.landmarks if landmark.existence_log_odds > 2.0}
        error_m, error_rad = self.error()
        self.assertLess(error_m, POSITION_M)
        pid = self.pid("/fast_slam")
        os.kill(pid, signal.SIGKILL)
        killed = time.time()
        last = max(self.tf_times)
        self.assertTrue(wait_until(lambda: self.tf_times[-1] > killed + 0.5))
        gap_s = next(stamp for stamp in self.tf_times if stamp > killed + 0.5) - last
        rospy.loginfo("map -> odom was missing for %.2f s; error before %.3f m, %.4f rad", gap_s, error_m, error_rad)
        self.assertLess(gap_s, LONGEST_GAP_S)
        self.assertNotEqual(self.pid("/fast_slam"), pid)

        rospy.sleep(DRIVE_S)
        count = self.map_count
        self.assertTrue(wait_until(lambda: self.map_count > count + 1))
        error_m, error_rad = self.error()
        kept_walls = len(walls & self.occupied()) / len(walls)
        now = {landmark.id for landmark in self.landmarks.landmarks}
        rospy.loginfo("error after %.3f m, %.4f rad; %.3f of the walls and %d of %d landmarks kept", error_m, error_rad,
                      kept_walls, len(landmarks & now), len(landmarks))
        self.assertLess(error_m, POSITION_M)
        self.assertLess(error_rad, YAW_RAD)
        self.assertGreater(kept_walls, KEPT_SHARE)
        self.assertGreaterEqual(len(landmarks & now), KEPT_SHARE * len(landmarks))
        self.assertGreater(len(walls), 500)

    def test_2_the_kinematic_model(self):  # F142
        self.assertTrue(wait_until(lambda: len(self.poses) > 10))
        pid = self.pid("/kinematics")
        os.kill(pid, signal.SIGKILL)
        count = len(self.poses)
        rospy.sleep(DRIVE_S)
        self.assertNotEqual(self.pid("/kinematics"), pid)
        self.assertGreater(len(self.poses), count + 100)
        error_m, error_rad = self.error()
        rospy.loginfo("error after kinematics was killed %.3f m, %.4f rad", error_m, error_rad)
        self.assertLess(error_m, BRIDGED_M)
        self.assertLess(error_rad, BRIDGED_RAD)

    def test_3_all_that_keeps_no_state_of_the_pose(self):
        nodes = ("/occupancy_mapper", "/world_map", "/map_smoother", "/robot_state_publisher", "/feature_detector",
                 "/laser_odometry")
        pids = {node: self.pid(node) for node in nodes}
        for node in nodes:
            os.kill(pids[node], signal.SIGKILL)

        def is_back(node):
            try:
                return self.pid(node) != pids[node]
            except (OSError, rosgraph.MasterError):
                return False

        self.assertTrue(wait_until(lambda: all(is_back(node) for node in nodes)))
        self.map_count = 0
        count = len(self.poses)
        self.assertTrue(wait_until(lambda: self.map_count > 1 and len(self.poses) > count + 50))
        error_m, error_rad = self.error()
        rospy.loginfo("error after all others were killed %.3f m, %.4f rad", error_m, error_rad)
        self.assertLess(error_m, BRIDGED_M)

    def test_4_one_leap_of_the_clock(self):
        clock = rospy.Publisher("/clock", Clock, queue_size=1)
        self.assertTrue(wait_until(lambda: clock.get_num_connections() >= 5 and self.map is not None))
        clock.publish(Clock(rospy.Time.now() + rospy.Duration(1000.0)))
        leapt = time.time()
        count = len(self.poses)
        self.assertTrue(wait_until(lambda: self.tf_times[-1] > leapt + 1.0 and len(self.poses) > count + 20))
        self.assertLess(next(stamp for stamp in self.tf_times if stamp > leapt + 0.5) - leapt, LONGEST_GAP_S)
        self.map_count = 0
        self.assertTrue(wait_until(lambda: self.map_count > 1))


if __name__ == "__main__":
    rospy.init_node("killed_nodes")
    rostest.rosrun("ramscout_bringup", "killed_nodes", KilledNodes, sys.argv)
