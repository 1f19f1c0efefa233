#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Sends one kind of bad odometry after the other and checks answers and diagnostics; ends with good odometry each time."""

import math
import sys
import threading
import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from ram_slam_msgs.srv import SampleStates, SampleStatesResponse as Status

SPEED_MPS = 0.5
PERIOD_S = 0.01
TIMEOUT_S = 10.0


class OdometryFaultsTest(unittest.TestCase):
    """Each test sets the clock to where no other has been, far enough ahead that the history starts again, too."""

    start_s = 1000.0

    @classmethod
    def setUpClass(cls):
        cls.statuses = []
        rospy.Subscriber('/diagnostics', DiagnosticArray, lambda message: cls.statuses.extend(message.status))
        cls.publisher = rospy.Publisher('odom', Odometry, queue_size=1000)
        rospy.wait_for_service('kinematics/sample_states', 20)
        cls.service = staticmethod(rospy.ServiceProxy('kinematics/sample_states', SampleStates, persistent=True))
        while cls.publisher.get_num_connections() == 0:
            rospy.sleep(0.01)

    def setUp(self):
        type(self).start_s += 1000.0
        self.statuses.clear()

    def stamp(self, time_s):
        return rospy.Time.from_sec(self.start_s + time_s)

    def odometry(self, time_s):
        message = Odometry()
        message.header.stamp = self.stamp(time_s)
        message.header.frame_id = 'odom'
        message.child_frame_id = 'base_link'
        message.pose.pose.position.x = SPEED_MPS * time_s
        message.pose.pose.orientation.w = 1.0
        return message

    def drive(self, from_s, to_s, origin_x=0.0):
        for i in range(round(from_s / PERIOD_S), round(to_s / PERIOD_S) + 1):
            message = self.odometry(PERIOD_S * i)
            message.pose.pose.position.x += origin_x
            self.publisher.publish(message)

    def motion(self, from_s, to_s):
        """(x, status): where a robot at the origin is on average after the interval."""
        answer = self.service(400, [0.0] * 1200, self.stamp(from_s), self.stamp(to_s), 1)
        if answer.status != Status.SUCCESS:
            return None, answer.status
        return sum(answer.states[0::3]) / 400, answer.status

    def assertMoves(self, from_s, to_s, delta_m=0.01):
        end = time.time() + TIMEOUT_S
        moved, status = self.motion(from_s, to_s)
        while status != Status.SUCCESS and time.time() < end:
            rospy.sleep(0.02)
            moved, status = self.motion(from_s, to_s)
        self.assertEqual(status, Status.SUCCESS)
        self.assertAlmostEqual(moved, SPEED_MPS * (to_s - from_s), delta=delta_m)

    def assertDiagnosed(self, text):
        """The stamps are far from the clock, which is a cause of its own: looks at all causes."""
        end = time.time() + TIMEOUT_S
        while time.time() < end:
            if any(text in value.value for status in list(self.statuses) for value in status.values):
                return
            rospy.sleep(0.05)
        self.fail('no diagnostics with "%s": %s' % (text, [s.message for s in self.statuses]))

    def test_values_that_are_not_numbers_are_rejected(self):
        self.drive(0.0, 1.0)
        for field, value in ('x', math.nan), ('y', math.inf):
            bad = self.odometry(1.005)
            setattr(bad.pose.pose.position, field, value)
            self.publisher.publish(bad)
        bad = self.odometry(1.006)
        bad.pose.pose.orientation.w = 0.0
        self.publisher.publish(bad)
        bad = self.odometry(1.007)
        bad.twist.twist.angular.z = math.nan
        self.publisher.publish(bad)
        bad = self.odometry(0.0)
        bad.header.stamp = rospy.Time()
        self.publisher.publish(bad)
        self.drive(1.01, 2.0)
        self.assertMoves(0.5, 2.0)
        self.assertDiagnosed('messages lost or dropped')

    def test_covariance_of_the_odometry_is_not_needed(self):
        for i in range(101):
            message = self.odometry(PERIOD_S * i)
            message.pose.covariance = [math.nan, -1.0, 1.8e308] * 12
            self.publisher.publish(message)
        self.assertMoves(0.1, 0.9)

    def test_odometry_of_another_frame_is_rejected_and_named(self):
        self.drive(0.0, 0.5)
        for i in range(120):  # longer than two periods of the diagnostics
            message = self.odometry(0.5 + PERIOD_S * i)
            message.header.frame_id = 'odom_combined'
            message.pose.pose.position.x = 77.0
            self.publisher.publish(message)
            rospy.sleep(0.02)
        self.assertDiagnosed('set odom_frame and base_frame')
        self.drive(0.5, 1.0)
        self.assertMoves(0.1, 0.9)

    def test_jump_is_left_out_and_a_reset_bridged(self):
        self.drive(0.0, 1.0)
        jump = self.odometry(1.005)
        jump.pose.pose.position.y = 5.0
        self.publisher.publish(jump)
        self.drive(1.01, 2.0)
        self.assertMoves(0.5, 2.0)
        self.drive(2.01, 3.0, origin_x=-50.0)
        self.assertMoves(1.5, 3.0, delta_m=0.02)

    def test_clock_that_is_set_back_starts_a_new_history(self):
        self.drive(100.0, 101.0)
        self.assertMoves(100.1, 100.9)
        self.drive(0.0, 1.0)
        self.assertMoves(0.1, 0.9)
        self.assertEqual(self.motion(100.1, 100.9)[1], Status.NOT_YET_AVAILABLE)

    def test_clock_that_is_set_back_during_calls_never_mixes_histories(self):
        self.drive(100.0, 101.0)
        self.assertMoves(100.1, 100.9)
        answers = []
        stop = threading.Event()

        def call():
            service = rospy.ServiceProxy('kinematics/sample_states', SampleStates, persistent=True)
            while not stop.is_set():
                answers.append(service(1, [0.0] * 3, self.stamp(100.1), self.stamp(100.9), 1))

        client = threading.Thread(target=call)
        client.start()
        rospy.sleep(0.2)
        self.drive(0.0, 1.0)
        self.assertMoves(0.1, 0.9)
        stop.set()
        client.join()
        served = [answer.status == Status.SUCCESS for answer in answers]
        first_refused = served.index(False)
        self.assertGreater(first_refused, 0)
        self.assertFalse(any(served[first_refused:]))
        for answer in answers[:first_refused]:
            self.assertAlmostEqual(answer.states[0], SPEED_MPS * 0.8, delta=0.2)
        for answer in answers[first_refused:]:
            self.assertEqual(answer.status, Status.NOT_YET_AVAILABLE)
            self.assertNotEqual(answer.message, '')

    def test_messages_out_of_order_are_put_in_order(self):
        times = [PERIOD_S * i for i in range(201)]
        for i in range(1, len(times) - 20, 20):
            times[i:i + 20] = reversed(times[i:i + 20])
        for time_s in times:
            self.publisher.publish(self.odometry(time_s))
        self.assertMoves(0.15, 1.85)

    def test_silence_is_told_and_a_gap_refused_until_it_is_over(self):
        self.drive(0.0, 1.0)
        self.assertMoves(0.1, 1.0)
        self.statuses.clear()
        self.assertDiagnosed('no odometry any more')
        self.assertEqual(self.motion(0.5, 3.0)[1], Status.NOT_YET_AVAILABLE)
        self.drive(5.0, 6.0)
        self.assertMoves(5.1, 5.9)
        self.assertEqual(self.motion(0.5, 5.5)[1], Status.GAP)
        self.statuses.clear()
        for i in range(120):
            self.publisher.publish(self.odometry(6.01 + PERIOD_S * i))
            rospy.sleep(0.02)
        self.assertNotIn('no odometry', self.statuses[-1].message)


if __name__ == '__main__':
    rospy.init_node('odometry_faults_test')
    rostest.rosrun('ramscout_kinematics', 'odometry_faults', OdometryFaultsTest, sys.argv)
