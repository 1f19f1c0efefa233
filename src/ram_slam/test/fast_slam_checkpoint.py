#!/usr/bin/python3
"""fast_slam killed and started again: it continues from its checkpoint, or reports why not (F143)."""
import glob
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time

import rosnode
import rospy
import rostest
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

from played_robot import PERIOD_S, POLES, TIMEOUT_S, PlayedRobot, wait_until

RESPAWN_DELAY_S = 1.0  # as in fast_slam.launch
LONGEST_GAP_S = 5.0
PLACE_M = 0.05


class FastSlamCheckpoint(PlayedRobot):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.tf_times = []  # when map -> odom came
        cls.tf = rospy.Subscriber("/tf", TFMessage, cls.on_tf, queue_size=100, tcp_nodelay=True)

    @classmethod
    def on_tf(cls, message):
        if any(transform.header.frame_id == "map" for transform in message.transforms):
            cls.tf_times.append(time.time())

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.file = os.path.join(self.folder.name, "here", "fast_slam.checkpoint")
        self.log = os.path.join(self.folder.name, "log")
        self.node = None
        self.begin()

    def tearDown(self):
        if self.node is not None:
            self.node.kill()
            self.node.wait()
        self.folder.cleanup()

    def launch(self, file=None):
        with open(self.log, "a") as log:
            self.node = subprocess.Popen(
                ["rosrun", "ram_slam", "fast_slam", "__name:=fast_slam", "_particle_amount:=50",
                 "_node/checkpoint_file:=" + (file or self.file), "_node/checkpoint_period:=0.5"],
                stdout=log, stderr=subprocess.STDOUT)

    def run_node(self, file=None):
        """Starts the node, and drives in real time until it has answered."""
        count = len(self.pose.messages)
        self.launch(file)
        self.assertTrue(wait_until(lambda: self.answered(self.step(), PERIOD_S)))
        return self.pose.messages[count].header.stamp.to_sec()

    def run_again(self, file=None):
        """The same with an empty map, of which the first answered reading is the origin."""
        self.origin = self.x(self.run_node(file))

    def kill(self):
        self.node.send_signal(signal.SIGKILL)
        self.node.wait()
        self.node = None

    def kept(self):
        """Waits for a checkpoint of what there is now."""
        stamp = self.now
        changed = os.path.getmtime(self.file) if os.path.exists(self.file) else 0.0
        self.drive(7)
        self.assertGreater(self.now, stamp + 0.6)
        self.assertTrue(wait_until(lambda: os.path.exists(self.file) and os.path.getmtime(self.file) > changed))

    def error(self):
        """Of the newest pose, x and y."""
        message = self.pose.messages[-1]
        place = message.pose.pose.position
        return place.x - self.x(message.header.stamp.to_sec()) + self.origin, place.y

    def expect_right_pose(self, delta=PLACE_M):
        self.drive(1)
        for error in self.error():
            self.assertAlmostEqual(error, 0.0, delta=delta)

    def places(self):
        """The newest landmarks, identifier -> place."""
        return {landmark.id: (landmark.feature.pose.pose.position.x, landmark.feature.pose.pose.position.y)
                for landmark in self.landmarks.messages[-1].landmarks}

    def times_logged(self, text):
        with open(self.log) as log:
            return log.read().count(text)

    def test_killed_again_and_again_it_goes_on_with_its_map(self):
        stop = threading.Event()

        def drive():
            while not stop.is_set():
                self.step()
                time.sleep(PERIOD_S)

        self.run_again()
        driver = threading.Thread(target=drive)
        driver.start()
        try:
            newest_id = 0
            for _ in range(3):
                time.sleep(4.0)
                before = self.places()
                error_before = self.error()
                newest_id = max(newest_id, max(before))
                self.kill()
                killed = time.time()
                last = max(self.tf_times)
                time.sleep(RESPAWN_DELAY_S)
                count = len(self.landmarks.messages)
                self.launch()
                self.assertTrue(wait_until(lambda: self.tf_times[-1] > killed))
                first = min(stamp for stamp in self.tf_times if stamp > killed)
                rospy.loginfo("map -> odom was missing for %.2f s", first - last)
                self.assertLess(first - last, LONGEST_GAP_S)
                self.assertTrue(wait_until(lambda: len(self.landmarks.messages) > count + 1))
                after = self.places()
                for was, now in zip(error_before, self.error()):
                    self.assertAlmostEqual(was, now, delta=PLACE_M)
                for identifier in before.keys() & after.keys():
                    for old, new in zip(before[identifier], after[identifier]):
                        self.assertAlmostEqual(old, new, delta=PLACE_M)
                # What was learned in the last half second only may be gone.
                self.assertGreaterEqual(len(before.keys() & after.keys()), len(before) - 2)
                for identifier in after.keys() - before.keys():
                    self.assertGreater(identifier, newest_id)
        finally:
            stop.set()
            driver.join()
        self.expect_right_pose(delta=3 * PLACE_M)  # on a way without loops it drifts, killed or not
        self.assertFalse(self.lost.messages[-1].data)
        # Later features were taken for the old landmarks: no pole has two.
        for pole in POLES:
            near = [place for place in self.places().values()
                    if abs(place[0] + self.origin - pole[0]) + abs(place[1] - pole[1]) < 0.3]
            self.assertLessEqual(len(near), 1)

    def test_without_odometry_since_then_it_is_lost_in_its_map_and_found(self):
        self.run_again()
        self.drive(200)  # 10 m
        self.kept()
        known = self.places()
        self.kill()
        type(self).now += 60.0
        type(self).start += 60.0
        type(self).odometry_from = self.now  # kinematics was started again, too
        self.run_node()
        self.assertTrue(wait_until(lambda: self.lost.messages[-1].data))
        for _ in range(300):
            self.drive(1)
            if not self.lost.messages[-1].data:
                break
        self.assertFalse(self.lost.messages[-1].data, "not found again within 15 m")
        self.drive(15)
        self.expect_right_pose(delta=0.15)
        self.assertTrue(known.keys() <= self.places().keys())

    def test_a_file_that_is_none_is_put_aside_and_the_map_is_empty(self):
        garbage = b"RAMWORLD but not really"
        os.makedirs(os.path.dirname(self.file))
        with open(self.file, "wb") as file:
            file.write(garbage)
        self.run_again()
        self.expect_right_pose()
        self.assertEqual(self.times_logged("No checkpoint to continue from"), 1)
        with open(self.file + ".refused-1", "rb") as file:
            self.assertEqual(file.read(), garbage)
        self.kept()

    def test_a_checkpoint_of_another_run_of_the_clock_is_put_aside(self):
        self.run_again()
        self.drive(20)
        self.kept()
        self.kill()
        with open(self.file, "rb") as file:
            kept = file.read()
        type(self).now -= 100.0
        type(self).start = self.now + PERIOD_S
        type(self).odometry_from = self.now
        self.run_again()
        self.expect_right_pose()
        self.assertTrue(wait_until(lambda: os.path.exists(self.file + ".refused-1")))
        with open(self.file + ".refused-1", "rb") as file:
            self.assertEqual(file.read(), kept)
        type(self).now += 100.0

    def test_a_folder_that_cannot_be_written_is_told_once_and_holds_nothing_up(self):
        blocked = os.path.join(self.folder.name, "file")
        open(blocked, "w").close()
        self.run_again(file=os.path.join(blocked, "checkpoint"))
        self.drive(30)  # several attempts
        self.expect_right_pose()
        self.assertTrue(wait_until(lambda: self.times_logged("no checkpoint can be written") > 0))
        self.drive(30)
        self.assertEqual(self.times_logged("no checkpoint can be written"), 1)

    def test_after_rosnode_kill_it_goes_on_with_its_map(self):
        self.run_again()
        self.drive(60)
        self.kept()
        known = self.places()
        self.assertEqual(rosnode.kill_nodes(["/fast_slam"])[0], ["/fast_slam"])
        self.node.wait(TIMEOUT_S)
        self.assertTrue(os.path.exists(self.file))
        self.run_node()
        self.drive(15)
        self.expect_right_pose()
        self.assertTrue(known.keys() <= self.places().keys())

    def test_after_a_reset_or_an_orderly_end_there_is_nothing_to_go_on_from(self):
        self.run_again()
        self.kept()
        self.assertTrue(rospy.ServiceProxy("fast_slam/reset", Trigger)().success)
        self.assertTrue(wait_until(lambda: not os.path.exists(self.file)))
        self.drive(20)
        self.kept()
        self.node.send_signal(signal.SIGINT)
        self.assertEqual(self.node.wait(TIMEOUT_S), 0)
        self.assertEqual(glob.glob(self.file + "*"), [])


if __name__ == "__main__":
    rospy.init_node("fast_slam_checkpoint_test")
    rostest.rosrun("ram_slam", "fast_slam_checkpoint", FastSlamCheckpoint, sys.argv)
