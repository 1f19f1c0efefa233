#!/usr/bin/python3
"""Two robots in one world: names, frames, what they see of each other, commands, teleoperation."""
import os
import pty
import subprocess

import rospy
import rostest
import yaml
from geometry_msgs.msg import Pose2D, Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import Bool, String
from std_srvs.srv import Empty, SetBool
from tf2_msgs.msg import TFMessage

from ramscout_sim.srv import InjectFault, SetPose
from simulator_testing import PATIENCE_S, SimulatorTest

ROBOTS = ("alpha", "beta")
TOPICS = {"scan": LaserScan, "odom": Odometry, "ground_truth": Odometry, "joint_states": JointState,
          "faults": String, "collision": Bool, "cmd_vel": Twist}


class TwoRobots(SimulatorTest):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("two_robots_test")
        cls.frames = set()
        services = {"pause": SetBool, "reset": Empty}
        for robot in ROBOTS:
            services[robot + "/set_pose"] = SetPose
            services[robot + "/inject_fault"] = InjectFault
        cls.connect({"/%s/%s" % (robot, topic): kind for robot in ROBOTS for topic, kind in TOPICS.items()}, services)
        for topic in ("/tf", "/tf_static"):
            rospy.Subscriber(topic, TFMessage, cls.receive_tf)
        cls.commands = {robot: rospy.Publisher("/%s/cmd_vel" % robot, Twist, queue_size=1) for robot in ROBOTS}

    @classmethod
    def receive_tf(cls, message):
        with cls.changed:
            cls.frames.update((t.header.frame_id, t.child_frame_id) for t in message.transforms)
            cls.changed.notify_all()

    def setUp(self):
        self.call["reset"]()
        with self.changed:
            self.latest.clear()
        needed = {"/%s/%s" % (robot, topic) for robot in ROBOTS for topic in ("scan", "odom", "ground_truth", "joint_states")}
        self.wait_for(lambda: needed <= set(self.latest), "not every topic came")

    def x_of(self, robot):
        return self.latest["/%s/ground_truth" % robot].pose.pose.position.x

    def test_frames_carry_the_names(self):
        for robot in ROBOTS:
            self.assertEqual(self.latest["/%s/scan" % robot].header.frame_id, robot + "/laser")
            self.assertEqual(self.latest["/%s/odom" % robot].header.frame_id, robot + "/odom")
            self.assertEqual(self.latest["/%s/odom" % robot].child_frame_id, robot + "/base_link")
            self.assertEqual(self.latest["/%s/ground_truth" % robot].header.frame_id, "world")
            self.wait_for(lambda: {(robot + "/odom", robot + "/base_link"), (robot + "/base_link", robot + "/laser")}
                          <= self.frames, "tf of %s: %s" % (robot, sorted(self.frames)))

    def test_they_start_where_they_were_told_and_see_each_other(self):
        self.assertAlmostEqual(self.x_of("alpha"), 1.0, delta=0.01)
        self.assertAlmostEqual(self.x_of("beta"), 4.0, delta=0.01)
        for robot in ROBOTS:  # lidar to the other's lidar, 0.2 m before either base
            self.assertAlmostEqual(self.latest["/%s/scan" % robot].ranges[540], 3.0 - 0.4 - 0.03, delta=0.1)

    def test_a_command_moves_its_own_robot_only(self):
        command = Twist()
        command.linear.x = 0.3
        deadline = rospy.Time.now() + rospy.Duration(20.0)
        while self.x_of("alpha") < 1.2 and rospy.Time.now() < deadline:
            self.commands["alpha"].publish(command)
            rospy.sleep(0.05)
        self.assertGreater(self.x_of("alpha"), 1.2)
        self.assertAlmostEqual(self.x_of("beta"), 4.0, delta=0.01)

    def test_a_kidnapping_is_recorded_and_refused_onto_the_other_robot(self):
        refused = self.call["alpha/set_pose"](Pose2D(4.0, 2.5, 0.0))
        self.assertFalse(refused.success)
        self.assertIn("solid", refused.message)
        self.assertTrue(self.call["alpha/set_pose"](Pose2D(2.0, 1.0, 0.5)).success)
        self.wait_for(lambda: "/alpha/faults" in self.latest, "no record of it")
        record = yaml.safe_load(self.latest["/alpha/faults"].data)
        self.assertEqual((record["kind"], record["pose"]), ("kidnap", [2.0, 1.0, 0.5]))
        self.wait_for(lambda: abs(self.x_of("alpha") - 2.0) < 0.01, "not moved")
        self.assertAlmostEqual(self.latest["/alpha/odom"].pose.pose.position.x, 0.0, delta=0.01)

    def test_a_collision_is_told(self):
        def collides():
            return "/beta/collision" in self.latest and self.latest["/beta/collision"].data

        self.assertFalse(collides())
        self.assertTrue(self.call["beta/set_pose"](Pose2D(4.0, 1.0, 0.0)).success)
        command = Twist()
        command.linear.x = 1.0
        deadline = rospy.Time.now() + rospy.Duration(20.0)
        while not collides() and rospy.Time.now() < deadline:
            self.commands["beta"].publish(command)
            rospy.sleep(0.05)
        self.assertTrue(collides())

    def test_the_keyboard_drives(self):
        controller, terminal = pty.openpty()
        teleop = subprocess.Popen(["rosrun", "ramscout_sim", "teleop", "__ns:=alpha"], stdin=terminal,
                                  stdout=subprocess.PIPE)
        try:
            self.wait_for(lambda: "/alpha/cmd_vel" in self.latest, "teleop does not start")
            os.write(controller, b"wwa")
            self.wait_for(lambda: "/alpha/cmd_vel" in self.latest and
                          abs(self.latest["/alpha/cmd_vel"].angular.z - 0.2) < 1e-9, "no command")
            self.assertAlmostEqual(self.latest["/alpha/cmd_vel"].linear.x, 0.2)
            os.write(controller, b" q")
            self.assertEqual(teleop.wait(PATIENCE_S), 0)
        finally:
            teleop.kill()
            teleop.communicate()
            os.close(controller)
            os.close(terminal)
        self.assertEqual(self.latest["/alpha/cmd_vel"].linear.x, 0.0)


if __name__ == "__main__":
    rostest.rosrun("ramscout_sim", "two_robots", TwoRobots)
