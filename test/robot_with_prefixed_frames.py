#!/usr/bin/python3
"""The stack of one of two robots, in a namespace and with prefixed frames, knows where its robot is and maps in its frames."""
import math
import threading
import unittest

import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from ram_slam_msgs.msg import FeatureList
from tf2_msgs.msg import TFMessage

TIMEOUT_S = 30.0
DISTANCE_M = 1.5
MAX_ERROR_M = 0.05


def yaw_of(rotation):
    return 2.0 * math.atan2(rotation.z, rotation.w)


class RobotWithPrefixedFrames(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.latest = {}
        cls.frames = set()
        cls.changed = threading.Condition()
        for topic, kind in (("ground_truth", Odometry), ("features", FeatureList), ("map", OccupancyGrid)):
            rospy.Subscriber("/alpha/" + topic, kind, cls.receive, topic)
        for topic in ("/tf", "/tf_static"):
            rospy.Subscriber(topic, TFMessage, cls.receive_tf)
        cls.buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.buffer)
        cls.command = rospy.Publisher("/alpha/cmd_vel", Twist, queue_size=1)

    @classmethod
    def receive(cls, message, topic):
        with cls.changed:
            cls.latest[topic] = message
            cls.changed.notify_all()

    @classmethod
    def receive_tf(cls, message):
        with cls.changed:
            cls.frames.update(frame for t in message.transforms for frame in (t.header.frame_id, t.child_frame_id))

    def wait_for(self, condition, what):
        with self.changed:
            self.assertTrue(self.changed.wait_for(condition, TIMEOUT_S), what)

    def truth(self):
        pose = self.latest["ground_truth"].pose.pose
        return pose.position.x, pose.position.y, yaw_of(pose.orientation)

    def drive(self, turn_rate, until):
        command = Twist()
        command.linear.x, command.angular.z = 0.4, turn_rate
        deadline = rospy.Time.now() + rospy.Duration(TIMEOUT_S)
        while not until() and rospy.Time.now() < deadline:
            self.command.publish(command)
            rospy.sleep(0.05)
        self.assertTrue(until())

    def test_it_knows_where_its_robot_is_and_maps(self):
        self.wait_for(lambda: {"ground_truth", "features"} <= set(self.latest), "no truth or no features")
        self.assertEqual(self.latest["features"].header.frame_id, "alpha/base_link")
        start = self.truth()
        self.drive(0.1, lambda: math.dist(self.truth()[:2], start[:2]) > DISTANCE_M)
        self.command.publish(Twist())
        rospy.sleep(1.0)  # until it stands
        estimate = self.buffer.lookup_transform("alpha/map", "alpha/base_link", rospy.Time(0)).transform
        x, y, yaw = self.truth()
        cos, sin = math.cos(start[2]), math.sin(start[2])
        driven = (cos * (x - start[0]) + sin * (y - start[1]), cos * (y - start[1]) - sin * (x - start[0]))
        self.assertLess(math.dist(driven, (estimate.translation.x, estimate.translation.y)), MAX_ERROR_M)
        self.assertAlmostEqual(math.remainder(yaw - start[2] - yaw_of(estimate.rotation), math.tau), 0.0, delta=0.02)
        self.wait_for(lambda: "map" in self.latest and any(cell > 50 for cell in self.latest["map"].data), "no map")
        self.assertEqual(self.latest["map"].header.frame_id, "alpha/map")
        strangers = {frame for frame in self.frames if not frame.startswith(("alpha/", "beta/"))}
        self.assertLessEqual(strangers, {"world"})


if __name__ == "__main__":
    rospy.init_node("robot_with_prefixed_frames_test")
    rostest.rosrun("ramscout_bringup", "robot_with_prefixed_frames", RobotWithPrefixedFrames)
