#!/usr/bin/python3
"""landmark_smoother as a node beside fast_slam, against a robot that the test plays."""
import sys

import rospy
import rostest
from nav_msgs.msg import Path
from ram_slam_msgs.msg import LandmarkMap
from std_srvs.srv import Trigger

from played_robot import POLES, TIMEOUT_S, PlayedRobot, Topic, wait_until


class LandmarkSmootherNode(PlayedRobot):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.trajectory = Topic("trajectory", Path)
        cls.smoothed_trajectory = Topic("smoothed_trajectory", Path)
        cls.corrected_trajectory = Topic("corrected_trajectory", Path)
        cls.smoothed_landmarks = Topic("smoothed_landmarks", LandmarkMap)
        rospy.wait_for_service("landmark_smoother/smooth", TIMEOUT_S)
        cls.smooth = rospy.ServiceProxy("landmark_smoother/smooth", Trigger)
        assert wait_until(lambda: cls.features.get_num_connections() == 2 and
                          cls.smoothed_landmarks.subscriber.get_num_connections() > 0 and
                          cls.smoothed_trajectory.subscriber.get_num_connections() > 0)

    def test_a_drive_is_smoothed(self):
        answer = self.smooth()
        self.assertFalse(answer.success)
        self.assertIn("no features", answer.message)
        self.begin()
        self.drive(100)

        def has_long_trajectory():
            return self.trajectory.messages and len(self.trajectory.messages[-1].poses) > 80

        self.assertTrue(wait_until(has_long_trajectory))
        for bad in (self.list_at(self.now - 3600.0), self.list_at(self.now)):
            bad.header.frame_id = "nowhere"
            self.features.publish(bad)
        self.assertTrue(wait_until(lambda: self.smooth().success))
        self.assertTrue(wait_until(lambda: self.smoothed_landmarks.messages and self.smoothed_trajectory.messages))
        path = self.smoothed_trajectory.messages[-1].poses
        self.assertGreater(len(path), 80)
        for pose in path:
            self.assertAlmostEqual(pose.pose.position.x, self.x(pose.header.stamp.to_sec()), delta=0.01)
            self.assertAlmostEqual(pose.pose.position.y, 0.0, delta=0.01)
        self.assertTrue(wait_until(lambda: self.corrected_trajectory.messages), "the estimator does not follow")
        landmarks = self.smoothed_landmarks.messages[-1]
        self.assertEqual(landmarks.header.frame_id, "map")
        self.assertGreaterEqual(len(landmarks.landmarks), 4)
        for landmark in landmarks.landmarks:
            place = landmark.feature.pose.pose.position
            nearest = min((px - place.x) ** 2 + (py - place.y) ** 2 for px, py in POLES) ** 0.5
            self.assertLess(nearest, 0.01)
            self.assertGreater(landmark.feature.pose.covariance[0], 0.0)


if __name__ == "__main__":
    rospy.init_node("landmark_smoother_test")
    rostest.rosrun("ram_slam", "landmark_smoother_node", LandmarkSmootherNode, sys.argv)
