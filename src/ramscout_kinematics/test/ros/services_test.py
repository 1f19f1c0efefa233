#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Drives the node by odometry messages and checks its four services, good requests and bad ones."""

import math
import os
import subprocess
import sys
import threading
import unittest
import xmlrpc.client

import rospy
import rostest
from nav_msgs.msg import Odometry
from ram_slam_msgs.srv import (PredictState, PredictStateWithCovariance, SampleState, SampleStates,
                               SampleStatesResponse as Status)

START_S = 1000.0
RADIUS_M = 2.0
TURN_RATE_RADPS = 1.0
SPEED_MPS = RADIUS_M * TURN_RATE_RADPS
WHEEL_SEPARATION_M = 0.40
WHEEL_NOISE = 1.0e-4

# A client that calls for ever.
CLIENT = """
import rospy
from ram_slam_msgs.srv import SampleStates
rospy.wait_for_service('kinematics/sample_states', 20)
service = rospy.ServiceProxy('kinematics/sample_states', SampleStates, persistent=True)
start, end = rospy.Time(%d), rospy.Time(%d)
print('calling', flush=True)
while True:
    service(100000, [0.0] * 300000, start, end, 7)
""" % (START_S, START_S + 1)


def odometry(time_s):
    """On a circle to the left that starts at the origin along x."""
    message = Odometry()
    message.header.stamp = rospy.Time.from_sec(START_S + time_s)
    message.header.frame_id = 'odom'
    message.child_frame_id = 'base_link'
    yaw = TURN_RATE_RADPS * time_s
    message.pose.pose.position.x = RADIUS_M * math.sin(yaw)
    message.pose.pose.position.y = RADIUS_M * (1.0 - math.cos(yaw))
    message.pose.pose.orientation.z = math.sin(yaw / 2.0)
    message.pose.pose.orientation.w = math.cos(yaw / 2.0)
    message.twist.twist.linear.x = SPEED_MPS
    message.twist.twist.angular.z = TURN_RATE_RADPS
    return message


def stamp(time_s):
    return rospy.Time.from_sec(START_S + time_s)


class ServicesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        names = ('predict', PredictState), ('predict_with_covariance', PredictStateWithCovariance), \
            ('sample', SampleState), ('sample_states', SampleStates)
        for name, service in names:
            rospy.wait_for_service('kinematics/' + name, 20)
            setattr(cls, name, staticmethod(rospy.ServiceProxy('kinematics/' + name, service, persistent=True)))
        no_odometry = cls.sample_states(1, [0.0] * 3, stamp(0.0), stamp(1.0), 0)
        assert no_odometry.status == Status.NO_ODOMETRY, no_odometry
        publisher = rospy.Publisher('odom', Odometry, queue_size=1000)
        while publisher.get_num_connections() == 0:
            rospy.sleep(0.01)
        for i in range(201):
            publisher.publish(odometry(0.01 * i))
        while cls.sample_states(1, [0.0] * 3, stamp(0.0), stamp(2.0), 0).status != Status.SUCCESS:
            rospy.sleep(0.01)

    def assertFails(self, call, *arguments, **named):
        with self.assertRaises(rospy.ServiceException):
            call(*arguments, **named)

    def test_predict_moves_the_state_along_a_quarter_circle(self):
        quarter = math.pi / 2.0
        for state in [1.0, 2.0, 0.0], [1.0, 2.0, 0.3, 0.01, -0.02, 0.0]:
            moved = self.predict(state=state, from_=stamp(0.0), to=stamp(quarter)).state
            self.assertEqual(len(moved), len(state))
            self.assertAlmostEqual(moved[0], 3.0, places=5)
            self.assertAlmostEqual(moved[1], 4.0, places=5)
            self.assertAlmostEqual(moved[-1], quarter, places=5)
            for passed_through, before in zip(moved[2:-1], state[2:-1]):
                self.assertAlmostEqual(passed_through, before, places=6)

    def test_predict_with_covariance_adds_the_closed_form_noise(self):
        quarter = math.pi / 2.0
        answer = self.predict_with_covariance(
            state=[0.0] * 6, cov=[0.0] * 36, from_=stamp(0.0), to=stamp(quarter))
        q_s = WHEEL_NOISE * 2.0 / 4.0
        q_t = WHEEL_NOISE * 2.0 / WHEEL_SEPARATION_M ** 2
        q_st = WHEEL_NOISE * WHEEL_SEPARATION_M / RADIUS_M / (2.0 * WHEEL_SEPARATION_M)
        r = RADIUS_M
        self.assertAlmostEqual(answer.cov[0], math.pi * r / 4.0 * (q_s + q_t * r * r - 2.0 * r * q_st), places=6)
        self.assertAlmostEqual(answer.cov[35], q_t * quarter * r, places=6)
        self.assertAlmostEqual(answer.cov[5], r * (q_st - q_t * r), places=6)
        self.assertEqual(answer.cov[5], answer.cov[30])
        self.assertEqual([answer.cov[7 * i] for i in (2, 3, 4)], [0.0, 0.0, 0.0])

    def test_sample_spreads_as_predicted_and_never_repeats(self):
        draws = [self.sample(state=[0.0] * 3, from_=stamp(0.5), to=stamp(1.5)).state for _ in range(1000)]
        self.assertEqual(len(set(draws)), len(draws))
        predicted = self.predict_with_covariance(
            state=[0.0] * 3, cov=[0.0] * 9, from_=stamp(0.5), to=stamp(1.5))
        for i in range(3):
            variance = sum((draw[i] - predicted.state[i]) ** 2 for draw in draws) / len(draws)
            self.assertAlmostEqual(variance / predicted.cov[4 * i], 1.0, delta=4.0 * math.sqrt(2.0 / len(draws)))

    def test_sample_states_repeats_with_its_seed(self):
        states = [0.1 * i for i in range(60)]
        first = self.sample_states(10, states, stamp(0.5), stamp(1.5), 7)
        self.assertEqual(first.status, Status.SUCCESS)
        self.assertEqual(first.message, '')
        self.assertEqual(len(first.states), 60)
        self.assertEqual(first.states, self.sample_states(10, states, stamp(0.5), stamp(1.5), 7).states)
        self.assertNotEqual(first.states, self.sample_states(10, states, stamp(0.5), stamp(1.5), 8).states)

    def test_empty_interval_returns_the_state(self):
        answer = self.sample_states(2, [1.0, 2.0, 0.5, 3.0, 4.0, -0.5], stamp(1.005), stamp(1.005), 3)
        self.assertEqual(answer.states, (1.0, 2.0, 0.5, 3.0, 4.0, -0.5))

    def test_bad_states_fail(self):
        interval = {'from_': stamp(0.0), 'to': stamp(1.0)}
        for state in [], [0.0], [0.0] * 4, [0.0] * 5, [0.0] * 7, [0.0] * 1000000, \
                [0.0, float('nan'), 0.0], [float('inf'), 0.0, 0.0]:
            self.assertFails(self.predict, state=state, **interval)
            self.assertFails(self.sample, state=state, **interval)
            self.assertFails(self.predict_with_covariance, state=state, cov=[0.0] * len(state) ** 2
                             if len(state) < 10 else [], **interval)
        for count, size in (0, 0), (1, 2), (2, 7), (2, 5), (100001, 300003), (3, 0):
            answer = self.sample_states(count, [0.0] * size, stamp(0.0), stamp(1.0), 0)
            self.assertEqual(answer.status, Status.INVALID_STATE)
            self.assertNotEqual(answer.message, '')
            self.assertEqual(len(answer.states), 0)

    def test_bad_covariances_fail(self):
        interval = {'from_': stamp(0.0), 'to': stamp(1.0)}
        good = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
        self.predict_with_covariance(state=[0.0] * 3, cov=good, **interval)
        for cov in good[:8], good + [0.0], [float('nan')] * 9, [-1.0] + good[1:], [1.0, 0.5] + good[2:]:
            self.assertFails(self.predict_with_covariance, state=[0.0] * 3, cov=cov, **interval)

    def test_bad_intervals_fail_at_once_with_the_reason(self):
        zero = rospy.Time()
        cases = [(stamp(1.0), stamp(0.5), Status.INVALID_INTERVAL), (zero, stamp(0.5), Status.INVALID_INTERVAL),
                 (stamp(0.5), zero, Status.INVALID_INTERVAL), (stamp(-1.0), stamp(0.5), Status.TOO_OLD),
                 (stamp(0.5), stamp(2.3), Status.NOT_YET_AVAILABLE), (stamp(0.0), stamp(3600.0), Status.NOT_YET_AVAILABLE)]
        for start, end, status in cases:
            answer = self.sample_states(1, [0.0] * 3, start, end, 0)
            self.assertEqual(answer.status, status, answer.message)
            self.assertNotEqual(answer.message, '')
            self.assertFails(self.predict, state=[0.0] * 3, from_=start, to=end)

    def resident_bytes(self):
        uri = rospy.get_master().lookupNode(rospy.resolve_name('kinematics'))[2]
        pid = xmlrpc.client.ServerProxy(uri).getPid('/test')[2]
        with open('/proc/%d/statm' % pid) as file:
            return int(file.read().split()[1]) * os.sysconf('SC_PAGE_SIZE')

    def test_thousands_of_calls_are_all_answered_and_take_no_memory(self):
        failed = []

        def call(count, persistent):
            service = rospy.ServiceProxy('kinematics/sample_states', SampleStates, persistent=True)
            for _ in range(count):
                if not persistent:
                    service = rospy.ServiceProxy('kinematics/sample_states', SampleStates)
                answer = service(10, [0.0] * 30, stamp(0.5), stamp(1.5), 7)
                if answer.status != Status.SUCCESS or len(answer.states) != 30:
                    failed.append(answer)

        def call_from_four_clients():
            clients = [threading.Thread(target=call, args=arguments)
                       for arguments in ((500, True), (500, True), (100, False), (100, False))]
            for client in clients:
                client.start()
            for client in clients:
                client.join()

        call_from_four_clients()
        before = self.resident_bytes()
        call_from_four_clients()
        self.assertEqual(failed, [])
        self.assertLess(self.resident_bytes() - before, 2_000_000)

    def test_clients_killed_in_their_calls_do_no_harm(self):
        for _ in range(3):
            client = subprocess.Popen([sys.executable, '-c', CLIENT], stdout=subprocess.PIPE)
            self.assertEqual(client.stdout.readline(), b'calling\n')
            client.kill()
            client.wait()
            client.stdout.close()
            self.assertEqual(self.sample_states(1, [0.0] * 3, stamp(0.0), stamp(1.0), 0).status, Status.SUCCESS)

    def test_what_predict_answers_repeats(self):
        """`predict` and `sample` have the same checksum, so ROS connects a client of the one with the other."""
        answers = {self.predict(state=[0.0] * 3, from_=stamp(0.0), to=stamp(1.0)).state for _ in range(100)}
        self.assertEqual(len(answers), 1)
        self.assertEqual(PredictState._md5sum, SampleState._md5sum)

    def test_services_of_the_estimator_cannot_be_mistaken_for_others(self):
        others = {PredictState._md5sum, SampleState._md5sum}
        used = {PredictStateWithCovariance._md5sum, SampleStates._md5sum}
        self.assertEqual(len(used), 2)
        self.assertFalse(used & others)


if __name__ == '__main__':
    rospy.init_node('kinematics_services_test')
    rostest.rosrun('ramscout_kinematics', 'kinematics_services', ServicesTest, sys.argv)
