#!/usr/bin/python3
"""fast_slam as a node, against a robot that the test plays: features, odometry's services and tf."""
import sys
import threading
import time

import rospy
import rostest
import tf2_ros
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TransformStamped
from nav_msgs.msg import Path
from rosgraph_msgs.msg import Log
from std_srvs.srv import Empty, SetBool, Trigger

from played_robot import PERIOD_S, SPEED, TIMEOUT_S, PlayedRobot, Topic, feature, wait_until


class FastSlamNode(PlayedRobot):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.diagnostics = Topic("/diagnostics", DiagnosticArray)
        cls.corrected = Topic("corrected_trajectory", Path)
        cls.logs = Topic("/rosout", Log)
        cls.smoothed = rospy.Publisher("smoothed_trajectory", Path, queue_size=1)
        cls.initial_pose = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=10)
        cls.buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.buffer)
        assert wait_until(lambda: cls.features.get_num_connections() > 0 and
                          cls.pose.subscriber.get_num_connections() > 0 and
                          cls.initial_pose.get_num_connections() > 0 and
                          cls.smoothed.get_num_connections() > 0 and
                          cls.corrected.subscriber.get_num_connections() > 0)

    def setUp(self):
        """Starts the filter again at the robot's place."""
        if self.service is None:
            self.serve()
        rospy.wait_for_service("fast_slam/reset", TIMEOUT_S)
        self.assertTrue(rospy.ServiceProxy("fast_slam/reset", Trigger)().success)
        self.begin()

    def localisation(self):
        """Its newest diagnostics."""
        return [status for message in list(self.diagnostics.messages) for status in message.status
                if status.name.endswith("localisation")][-1]

    # The first one by name: its stamps must be those of the wall clock.
    def test_a_consumer_of_tf_sees_no_error_while_the_filter_stands_still(self):
        def in_real_time(odometry=True):
            self.step(odometry)
            time.sleep(max(0.0, self.now - time.time()))

        def at_now():
            return self.buffer.can_transform("map", "odom", rospy.Time.now())

        for _ in range(20):
            in_real_time()
        self.assertTrue(wait_until(at_now))
        errors = []
        stop = threading.Event()

        def consume():
            while not stop.is_set():
                try:
                    self.buffer.lookup_transform("map", "odom", rospy.Time.now())
                except tf2_ros.TransformException as error:
                    errors.append(str(error))
                time.sleep(0.05)

        consumer = threading.Thread(target=consume)
        consumer.start()
        end = time.time() + rospy.get_param("~tf_seconds")
        while time.time() < end:
            for _ in range(20):
                in_real_time()
            in_real_time(odometry=False)  # the filter waits for odometry for a second
            time.sleep(1.5)
            type(self).now = round(time.time(), 3)
        stop.set()
        consumer.join()
        self.assertEqual(errors, [])

    def test_every_list_gets_a_pose_of_its_stamp_that_is_right(self):
        last = self.drive(40)
        self.assertAlmostEqual(last.pose.pose.position.x, self.x(), delta=0.05)
        self.assertAlmostEqual(last.pose.pose.position.y, 0.0, delta=0.05)
        self.assertLess(last.pose.covariance[0], 0.01)

    def test_an_empty_list_is_a_reading(self):
        self.drive(3)
        type(self).now = round(self.now + PERIOD_S, 3)
        type(self).odometry_to = self.now
        message = self.list_at(self.now)
        message.features = []
        self.features.publish(message)
        self.assertTrue(self.answered(self.now))

    def test_lists_from_before_the_odometry_are_dropped(self):  # F58
        type(self).odometry_from = self.now + 0.25
        early = [self.step(), self.step()]
        type(self).odometry_from = self.now + 0.05
        late = self.step()
        self.assertTrue(self.answered(late))
        for stamp in early:
            self.assertFalse(self.answered(stamp, 0.0))
        self.assertAlmostEqual(self.pose.messages[-1].pose.pose.position.x, 0.0, delta=0.02)

    def test_a_list_waits_for_late_odometry(self):
        self.drive(3)
        stamp = self.step(odometry=False)
        self.assertFalse(self.answered(stamp, 0.3))
        type(self).odometry_to = self.now
        self.assertTrue(self.answered(stamp, 1.0))

    def test_goes_on_after_kinematics_died(self):  # F57, F142
        cls = type(self)
        self.drive(20)
        cls.service.shutdown("test")
        cls.service = None
        silent = [self.step() for _ in range(3)]
        time.sleep(1.5)
        self.assertFalse(any(self.answered(stamp, 0.0) for stamp in silent))
        cls.serve()
        cls.odometry_from = self.now - 0.05  # what was before is gone
        for _ in range(30):
            self.step()
            time.sleep(0.05)
        self.assertTrue(self.answered(self.now))
        # The map's landmarks are still in view: the filter knows how far the robot came.
        self.drive(5)
        self.assertAlmostEqual(self.pose.messages[-1].pose.pose.position.x, self.x(), delta=0.1)

    def test_bad_features_change_nothing(self):  # F121, F123, F125, F126
        self.drive(10)
        stamp = self.step()
        self.assertTrue(self.answered(stamp))
        before = self.pose.messages[-1]
        nan, inf = float("nan"), float("inf")
        wrong_frame = self.list_at(stamp)
        wrong_frame.header.frame_id = "laser"
        no_stamp = self.list_at(stamp)
        no_stamp.header.stamp = rospy.Time(0)
        old = self.list_at(stamp - 0.5)
        for message in (wrong_frame, no_stamp, old):
            self.features.publish(message)
        bad = [feature(nan, 0.0), feature(1.0, inf), feature(1.0, 1.0, nan), feature(1.0, 1.0, 0.0),
               feature(1.0, 1.0, -1.0)]
        no_rotation = feature(1.0, 1.0)
        no_rotation.pose.pose.orientation.w = 0.0
        only_bad = self.list_at(stamp)
        only_bad.features = bad + [no_rotation]
        count = len(self.pose.messages)
        self.features.publish(only_bad)
        # The same stamp once more: answered from the very state as before, but for an empty list's nothing.
        self.assertTrue(wait_until(lambda: len(self.pose.messages) > count))
        after = self.pose.messages[-1]
        self.assertEqual(before.header.stamp, after.header.stamp)
        # without a feature the pose is the motion's alone, a few centimetres from the corrected one at most
        self.assertAlmostEqual(before.pose.pose.position.x, after.pose.pose.position.x, delta=0.05)
        self.drive(3)
        self.assertAlmostEqual(self.pose.messages[-1].pose.pose.position.x, self.x(), delta=0.05)

    def test_survives_huge_lists_and_classifiers(self):  # F122, F124
        self.drive(3)
        stamp = round(self.now + PERIOD_S, 3)
        type(self).now = type(self).odometry_to = stamp
        message = self.list_at(stamp)
        message.features[0].classifier = "x" * 1000000
        message.features += [feature(5.0 + 0.001 * i, 3.0) for i in range(20000)]
        self.features.publish(message)
        self.assertTrue(self.answered(stamp, 60.0))
        self.assertAlmostEqual(self.pose.messages[-1].pose.pose.position.x, self.x(), delta=0.1)

    def test_starts_over_when_the_clock_is_set_back(self):
        self.drive(20)
        type(self).now -= 5.0
        type(self).start = self.now + PERIOD_S
        type(self).odometry_from = self.now - 1.0
        count = len(self.pose.messages)
        for _ in range(12):  # a second of the new clock shows that it is one
            stamp = self.step()
        # The stamps were answered before the jump, too: new answers must come, from the origin.
        self.assertTrue(wait_until(lambda: abs(self.pose.messages[-1].header.stamp.to_sec() - stamp) < 1e-6))
        self.assertEqual(len(self.pose.messages), count + 12)
        self.assertAlmostEqual(self.pose.messages[count].pose.pose.position.x, 0.0, delta=0.02)

    def test_one_list_of_another_clock_changes_nothing(self):
        self.drive(20)
        for error_s in (-5.0, 1e6):
            before = self.now
            message = self.list_at(before)
            message.header.stamp = rospy.Time.from_sec(before + error_s)
            self.features.publish(message)
            self.drive(3)
            self.assertAlmostEqual(self.pose.messages[-1].pose.pose.position.x, self.x(), delta=0.05)
        self.assertTrue(wait_until(lambda: any(
            "stamp of another clock" in value.key for value in self.localisation().values)))

    def test_a_second_node_that_publishes_map_to_odom_is_reported_with_its_name(self):
        self.drive(3)
        transform = TransformStamped()
        transform.header.frame_id = "map"
        transform.child_frame_id = "odom"
        transform.transform.rotation.w = 1.0

        def is_reported():
            transform.header.stamp = rospy.Time.from_sec(self.now - 1.0)
            self.broadcaster.sendTransform(transform)
            self.drive(1)
            status = self.localisation()
            return status.level == 2 and any("two nodes publish the transform to odom" in value.value
                                             for value in status.values)

        self.assertTrue(wait_until(is_reported))
        self.assertTrue(any("two nodes" in value.value and rospy.get_name() in value.value
                            for value in self.localisation().values))
        self.assertTrue(wait_until(lambda: is_reported() and any(
            "two nodes publish" in log.msg for log in self.logs.messages)))

    def test_initial_pose_is_taken_over_or_rejected(self):  # F132
        self.drive(3)
        message = PoseWithCovarianceStamped()
        message.header.frame_id = "map"
        message.pose.pose.position.x = 30.0
        message.pose.pose.orientation.w = 1.0  # covariance all zero: floored
        wrong = PoseWithCovarianceStamped()
        wrong.header.frame_id = "odom"
        wrong.pose.pose.position.x = 50.0
        wrong.pose.pose.orientation.w = 1.0
        not_finite = PoseWithCovarianceStamped()
        not_finite.header.frame_id = "map"
        not_finite.pose.pose.position.x = float("nan")
        not_finite.pose.pose.orientation.w = 1.0
        for each in (message, wrong, not_finite):  # apart: the node keeps the newest two
            self.initial_pose.publish(each)
            time.sleep(0.3)
        # Far from every landmark that it knows: nothing corrects it.
        self.assertAlmostEqual(self.drive(1).pose.pose.position.x, 30.0, delta=0.3)

    def test_a_correction_that_moves_the_pose_is_told_to_all(self):  # F135
        def follow(stretch):
            path = Path()
            path.header.frame_id = "map"
            for i in range(21):
                pose = PoseStamped()
                pose.header.stamp = rospy.Time.from_sec(round(self.now - PERIOD_S * (20 - i), 3))
                pose.pose.position.x = stretch * SPEED * PERIOD_S * i
                pose.pose.orientation.w = 1.0
                path.poses.append(pose)
            count = len(self.corrected.messages)
            self.smoothed.publish(path)
            self.assertTrue(wait_until(lambda: len(self.corrected.messages) > count))
            return self.corrected.messages[-1].poses

        def warnings():
            return [log.msg for log in self.logs.messages if "moves the pose by" in log.msg]

        self.drive(40)
        follow(1.0)
        self.assertEqual(warnings(), [])
        poses = follow(1.5)
        moved = 0.5 * SPEED * PERIOD_S * 20
        self.assertTrue(wait_until(lambda: len(warnings()) == 1))
        self.assertAlmostEqual(poses[-1].pose.position.x - poses[0].pose.position.x, 3.0 * moved, delta=0.02)
        self.assertTrue(wait_until(
            lambda: abs(self.pose.messages[-1].pose.pose.position.x - self.x() - moved) < 0.05))
        self.assertAlmostEqual(self.drive(5).pose.pose.position.x, self.x() + moved, delta=0.1)

    def test_pause_drops_features(self):
        self.drive(2)
        pause = rospy.ServiceProxy("fast_slam/pause", SetBool)
        self.assertTrue(pause(True).success)
        self.assertFalse(self.answered(self.step(), 0.5))
        self.assertTrue(pause(False).success)
        self.drive(2)

    def test_global_localization_finds_the_robot_in_its_map(self):
        self.assertTrue(wait_until(lambda: self.lost.messages and not self.lost.messages[-1].data))
        self.drive(200)  # 10 m
        globally = rospy.ServiceProxy("global_localization", Empty)
        globally()
        self.assertTrue(wait_until(lambda: self.lost.messages[-1].data))
        lost = self.drive(1)
        self.assertGreater(lost.pose.covariance[0], 1000.0)
        self.assertTrue(wait_until(lambda: any(
            status.level == 2 and any(value.value.startswith("lost: ") for value in status.values)
            for message in self.diagnostics.messages[-10:] for status in message.status
            if status.name.endswith("localisation"))))
        for _ in range(300):
            self.drive(1)
            if not self.lost.messages[-1].data:
                break
        self.assertFalse(self.lost.messages[-1].data, "not found again within 15 m")
        found = self.drive(1)
        self.assertAlmostEqual(found.pose.pose.position.x, self.x(), delta=0.15)
        self.assertAlmostEqual(found.pose.pose.position.y, 0.0, delta=0.15)

if __name__ == "__main__":
    rospy.init_node("fast_slam_node_test")
    rostest.rosrun("ram_slam", "fast_slam_node", FastSlamNode, sys.argv)
