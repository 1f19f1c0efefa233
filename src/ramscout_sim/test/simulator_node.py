#!/usr/bin/python3
"""The simulator as a node: topics, frames, clock, services, lock step."""
import math
import subprocess
import threading
import time

import rospy
import rostest
from geometry_msgs.msg import Pose2D, PoseStamped, Twist
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock, Log
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import String
from std_srvs.srv import Empty, SetBool
from tf2_msgs.msg import TFMessage

from ramscout_sim.srv import SetPose, SetRate, Step
from simulator_testing import PATIENCE_S, SimulatorTest

ROOM_START_X_M = 4.0  # room.yaml
TOPICS = {"/clock": Clock, "scan": LaserScan, "odom": Odometry, "ground_truth": Odometry,
          "joint_states": JointState, "/tf": TFMessage}


class SimulatorNode(SimulatorTest):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("simulator_node_test")
        cls.scans = []
        cls.warnings = []
        cls.answers = True
        cls.answer = rospy.Publisher("answer", PoseStamped, queue_size=100)
        cls.command = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("/rosout", Log, cls.receive_log)
        cls.connect(TOPICS, {"pause": SetBool, "reset": Empty, "set_pose": SetPose, "set_rate": SetRate, "step": Step})

    @classmethod
    def receive(cls, name, message):
        with cls.changed:
            if name == "scan":
                cls.scans.append(message)
            super().receive(name, message)
        if name == "scan" and cls.answers:
            cls.answer.publish(PoseStamped(header=message.header))

    @classmethod
    def receive_log(cls, message):
        with cls.changed:
            cls.warnings.append(message.msg)
            cls.changed.notify_all()

    def setUp(self):
        type(self).answers = True
        self.call["set_rate"](0.0)
        self.call["reset"]()
        self.call["pause"](False)
        self.wait_for(lambda: set(self.latest) == set(TOPICS), "not every topic came: %s" % list(self.latest))

    def pause(self):
        """Pauses at rest and forgets what came before."""
        self.assertTrue(self.call["pause"](True).success)
        time.sleep(0.2)  # for messages that are on their way

    def test_topics_carry_standard_frames(self):
        self.wait_for(lambda: len(self.scans) > 1, "no scans")
        self.pause()
        self.assertEqual(self.latest["scan"].header.frame_id, "laser")
        self.assertEqual(len(self.latest["scan"].ranges), 1081)
        self.assertFalse(any(math.isnan(r) for r in self.latest["scan"].ranges))
        self.assertEqual(self.latest["odom"].header.frame_id, "odom")
        self.assertEqual(self.latest["odom"].child_frame_id, "base_link")
        self.assertEqual(self.latest["ground_truth"].header.frame_id, "world")
        self.assertEqual(self.latest["joint_states"].name, ["left_wheel_joint", "right_wheel_joint"])
        transform = self.latest["/tf"].transforms[0]
        self.assertEqual((transform.header.frame_id, transform.child_frame_id), ("odom", "base_link"))

    def test_a_paused_clock_stands_and_step_moves_it_by_what_was_asked(self):
        self.pause()
        first = self.call["step"](0.5)
        self.assertTrue(first.success, first.message)
        second = self.call["step"](0.25)
        self.assertTrue(second.success, second.message)
        self.assertAlmostEqual((second.now - first.now).to_sec(), 0.25, places=6)
        self.wait_for(lambda: (second.now - self.latest["/clock"].clock).to_sec() < 0.0101, "the clock stayed behind")
        time.sleep(0.3)
        self.assertLessEqual(self.latest["/clock"].clock, second.now)

    def test_steps_out_of_range_or_while_running_are_refused(self):
        self.assertFalse(self.call["step"](0.1).success)
        self.pause()
        for duration in (0.0, -1.0, 1e9, float("nan"), float("inf")):
            response = self.call["step"](duration)
            self.assertFalse(response.success, duration)
            self.assertIn("duration", response.message)

    def test_rates_out_of_range_are_refused(self):
        for rate in (-1.0, 1e9, float("nan"), float("inf")):
            response = self.call["set_rate"](rate)
            self.assertFalse(response.success, rate)
            self.assertIn("real_time_factor", response.message)
        self.assertTrue(self.call["set_rate"](0.0).success)

    def test_teleports_are_refused_into_walls_and_to_nowhere(self):
        self.pause()
        for x, y in ((0.0, 2.5), (float("nan"), 2.5), (1e9, 0.0)):
            response = self.call["set_pose"](Pose2D(x, y, 0.0))
            self.assertFalse(response.success, (x, y))
            self.assertTrue(response.message)
        self.assertTrue(self.call["set_pose"](Pose2D(2.0, 1.5, 1.0)).success)
        self.assertTrue(self.call["step"](0.1).success)
        self.wait_for(lambda: abs(self.latest["ground_truth"].pose.pose.position.x - 2.0) < 1e-3, "not teleported")
        self.assertLess(abs(self.latest["odom"].pose.pose.position.x), 1e-3)

    def test_services_are_answered_at_once_at_full_speed(self):
        self.call["set_rate"](0.0)
        self.wait_for(lambda: len(self.scans) > 50, "it does not run")
        durations = []
        for _ in range(50):
            begin = time.time()
            self.assertTrue(self.call["set_rate"](0.0).success)
            durations.append(time.time() - begin)
        # With a mutex that the simulation takes again before others see it free, seconds.
        self.assertLess(sorted(durations)[45], 0.2)

    def test_reset_starts_again(self):
        self.pause()
        self.assertTrue(self.call["step"](1.0).success)
        self.call["reset"]()
        response = self.call["step"](0.2)
        self.assertTrue(response.success, response.message)
        self.assertAlmostEqual(response.now.to_sec(), 1.2, places=6)

    def test_reset_repeats_every_scan(self):
        runs = []
        for _ in range(2):
            self.pause()
            self.call["reset"]()
            with self.changed:
                self.scans.clear()
            self.assertTrue(self.call["step"](1.0).success)
            self.wait_for(lambda: len(self.scans) >= 39, "only %d scans" % len(self.scans))
            runs.append([(scan.header.stamp, scan.ranges) for scan in self.scans[:39]])
        self.assertEqual(runs[0], runs[1])
        self.assertNotEqual(runs[0][0][1], runs[0][1][1])  # each has noise of its own

    def test_resuming_elsewhere_after_a_pause_is_a_kidnapping(self):
        self.wait_for(lambda: len(self.scans) > 1, "no scans")
        faults = []
        subscriber = rospy.Subscriber("faults", String, lambda message: faults.append(message.data))
        while subscriber.get_num_connections() == 0:
            time.sleep(0.02)
        self.pause()
        stopped = self.latest["/clock"].clock
        time.sleep(0.5)  # however long: no simulated time passes
        self.assertTrue(self.call["set_pose"](Pose2D(2.0, 1.5, 1.0)).success)
        odometry = self.latest["odom"].pose.pose.position.x
        self.call["pause"](False)
        self.wait_for(lambda: faults and self.latest["/clock"].clock > stopped, "no kidnapping reported")
        subscriber.unregister()
        self.assertIn("kind: kidnap", faults[0])
        self.pause()
        self.assertAlmostEqual(self.latest["ground_truth"].pose.pose.position.x, 2.0, delta=1e-3)
        self.assertAlmostEqual(self.latest["odom"].pose.pose.position.x, odometry, delta=1e-3)

    def test_resets_amid_other_calls_are_served_one_after_the_other(self):
        self.pause()
        failures = []

        def hammer(name, *arguments):
            try:
                for _ in range(10):
                    self.call[name](*arguments)
            except rospy.ServiceException as error:
                failures.append(error)

        threads = [threading.Thread(target=hammer, args=call)
                   for call in (("reset",), ("step", 0.2), ("set_pose", Pose2D(2.0, 1.5, 1.0)), ("set_rate", 0.0))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])
        self.call["reset"]()
        response = self.call["step"](0.2)
        self.assertTrue(response.success, response.message)
        self.assertAlmostEqual(response.now.to_sec(), 1.2, places=6)
        self.wait_for(lambda: (response.now - self.latest["ground_truth"].header.stamp).to_sec() < 0.0101, "no truth")
        self.assertAlmostEqual(self.latest["ground_truth"].pose.pose.position.x, ROOM_START_X_M, delta=1e-3)

    def command_until(self, forward, left, turn, condition, what):
        """Commands again and again; `condition` is asked with the messages locked."""
        message = Twist()
        message.linear.x, message.linear.y, message.angular.z = forward, left, turn
        deadline = time.time() + PATIENCE_S
        while time.time() < deadline:
            self.command.publish(message)
            with self.changed:
                if self.changed.wait_for(condition, 0.05):
                    return
        self.fail(what)

    def warned(self, *words):
        return any(all(word in warning for word in words) for warning in self.warnings)

    def speed(self):
        return abs(self.latest["ground_truth"].twist.twist.linear.x)

    def test_commands_that_make_no_sense_are_told_and_do_no_harm(self):
        self.call["set_rate"](1.0)
        self.command_until(50.0, 0.0, 0.0, lambda: self.warned("cmd_vel", "50", "clamped"), "no warning of the clamping")
        self.assertLess(self.speed(), 1.6)
        self.call["reset"]()
        self.command_until(0.3, 0.0, 0.0, lambda: self.speed() > 0.25, "it does not drive")
        self.command_until(float("nan"), 0.0, 0.0, lambda: self.warned("cmd_vel", "not finite"), "no warning of NaN")
        self.wait_for(lambda: self.speed() < 0.01, "it does not stop at NaN")
        self.command_until(0.0, 0.3, 0.0, lambda: self.warned("cmd_vel", "cannot do"), "no warning of the motion to the left")
        truth = self.latest["ground_truth"]
        self.assertLess(abs(truth.twist.twist.linear.y), 0.01)
        self.assertFalse(any(math.isnan(v) for v in truth.pose.covariance))

    def test_a_robot_without_commands_stops_and_both_of_two_commanders_are_named(self):
        self.call["set_rate"](1.0)
        other = subprocess.Popen(["rostopic", "pub", "-r", "20", "cmd_vel", "geometry_msgs/Twist", "{linear: {x: 0.1}}"],
                                 stdout=subprocess.DEVNULL)
        try:
            self.command_until(0.2, 0.0, 0.0, lambda: self.warned("rostopic", rospy.get_name(), "the last wins"),
                               "no warning of two commanders")
        finally:
            other.terminate()
            other.wait()
        self.wait_for(lambda: self.speed() < 0.01, "it does not stop")

    def test_without_an_answer_the_clock_waits_even_after_a_reset(self):
        self.wait_for(lambda: self.latest["/clock"].clock.to_sec() > 3.0, "the clock does not run")
        type(self).answers = False
        self.call["reset"]()
        time.sleep(1.0)
        # Held at the first or second scan without an answer, not seconds further.
        self.assertLess(self.latest["/clock"].clock.to_sec(), 1.5)


if __name__ == "__main__":
    rostest.rosrun("ramscout_sim", "simulator_node", SimulatorNode)
