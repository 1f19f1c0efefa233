#!/usr/bin/python3
"""What laser_odometry publishes before any scan has come."""
import sys
import unittest

import rospy
import rostest
from ram_slam_msgs.msg import LidarCalibration


class LaserOdometryNode(unittest.TestCase):
    def test_the_correction_of_the_lidar_is_zero_at_the_start(self):
        # After a restart map_smoother and occupancy_mapper would keep the correction of before.
        message = rospy.wait_for_message("lidar_calibration", LidarCalibration, timeout=20.0)
        self.assertEqual((message.turn_time, message.turn_time_deviation), (0.0, 0.0))
        self.assertEqual(message.header.stamp, rospy.Time())
        self.assertEqual(message.header.frame_id, "base_link")


if __name__ == "__main__":
    rospy.init_node("laser_odometry_node_test")
    rostest.rosrun("ram_slam", "laser_odometry_node", LaserOdometryNode, sys.argv)
