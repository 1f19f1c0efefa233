#!/usr/bin/python3
"""Each cause why there is no map is named on /diagnostics within two seconds, with what to do; system_check agrees; of a
healthy robot no cause is named and nothing is logged that is not fine.

Each test plays a robot in a namespace of its own and starts the few nodes that can see the cause."""
import math
import os
import signal
import subprocess
import threading
import time
import unittest

import roslib.packages
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty
from tf2_msgs.msg import TFMessage

NAMED_WITHIN_S = 2.0
LATE_S = 1.0  # of messages on a busy machine
TIMEOUT_S = 20.0
PERIOD_S = 0.05
BEAMS = 361
PACKAGES = {"feature_detector": "ramscout_feature_detector", "kinematics": "ramscout_kinematics",
            "system_check": "ramscout_bringup"}


def program(node):
    return roslib.packages.find_node(PACKAGES.get(node, "ram_slam"), node)[0]


def transform(parent, child, stamp, x=0.0, yaw=0.0):
    message = TransformStamped()
    message.header.stamp, message.header.frame_id, message.child_frame_id = stamp, parent, child
    message.transform.translation.x = x
    message.transform.rotation.z, message.transform.rotation.w = math.sin(0.5 * yaw), math.cos(0.5 * yaw)
    return message


class Robot(threading.Thread):
    """Stands in a room of 5 m x 4 m, or turns, and publishes scan, odom and tf."""

    def __init__(self, space, **differences):
        super().__init__(daemon=True)
        how = {"scan": "scan", "odom": "odom", "mount": True, "odom_tf": True, "odom_frame": "odom", "offset_s": 0.0,
               "turn_radps": 0.0, "mirrored": False, **differences}
        self.how = how
        self.stopped = threading.Event()
        self.scan = how["scan"] and rospy.Publisher(space + "/" + how["scan"], LaserScan, queue_size=10)
        self.odom = how["odom"] and rospy.Publisher(space + "/" + how["odom"], Odometry, queue_size=10)
        self.tf = rospy.Publisher(space + "/tf", TFMessage, queue_size=10)
        self.start()

    @staticmethod
    def range_m(bearing):
        x, y = math.cos(bearing), math.sin(bearing)
        return min((3.0 if x > 0.0 else 2.0) / max(1e-9, abs(x)), (2.5 if y > 0.0 else 1.5) / max(1e-9, abs(y)))

    def scan_message(self, stamp, yaw):
        message = LaserScan()
        message.header.stamp, message.header.frame_id = stamp, "laser"
        message.angle_min, message.angle_max = -0.75 * math.pi, 0.75 * math.pi
        message.angle_increment = 1.5 * math.pi / (BEAMS - 1)
        message.range_min, message.range_max = 0.1, 20.0
        message.ranges = [self.range_m(yaw + message.angle_min + i * message.angle_increment) for i in range(BEAMS)]
        if self.how["mirrored"]:
            message.ranges.reverse()
        return message

    def run(self):
        yaw = 0.0
        while not self.stopped.wait(PERIOD_S):
            yaw += self.how["turn_radps"] * PERIOD_S
            now = rospy.Time.now()
            stamp = now + rospy.Duration(self.how["offset_s"])
            transforms = [transform("base_link", "laser", now, x=0.1)] if self.how["mount"] else []
            if self.how["odom_tf"]:
                transforms.append(transform("odom", "base_link", now, yaw=yaw))
            self.tf.publish(TFMessage(transforms))
            if self.odom:
                message = Odometry()
                message.header.stamp, message.header.frame_id = stamp, self.how["odom_frame"]
                message.child_frame_id = "base_link"
                message.pose.pose.orientation.z, message.pose.pose.orientation.w = math.sin(0.5 * yaw), math.cos(0.5 * yaw)
                self.odom.publish(message)
            if self.scan:
                self.scan.publish(self.scan_message(stamp, yaw))

    def stop(self):
        self.stopped.set()
        self.join()
        for publisher in (self.scan, self.odom, self.tf):
            if publisher:
                publisher.unregister()


class Causes(unittest.TestCase):
    statuses = []  # (when, status)
    logs = []

    @classmethod
    def setUpClass(cls):
        rospy.Subscriber("/diagnostics", DiagnosticArray, lambda message: cls.statuses.extend(
            (time.time(), status) for status in message.status))
        rospy.Subscriber("/rosout", Log, cls.logs.append)

    def setUp(self):
        self.space = "/" + self.id().split(".")[-1]
        self.processes = {}
        self.robots = []

    def tearDown(self):
        for robot in self.robots:
            robot.stop()
        for process in self.processes.values():
            process.kill()
            process.wait()

    def robot(self, **differences):
        self.robots.append(Robot(self.space, **differences))

    def node(self, node, *arguments, name=None):
        """Starts one in the namespace of the test."""
        name = name or node
        self.processes[name] = subprocess.Popen(
            [program(node), "__ns:=" + self.space, "__name:=" + name, "/tf:=tf", "/tf_static:=tf_static", *arguments],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def estimator(self, name="fast_slam", *arguments):
        self.node("fast_slam", "_particle_amount:=20", *arguments, name=name)

    def stack(self):
        for node in ("laser_odometry", "feature_detector", "occupancy_mapper"):
            self.node(node)
        self.node("kinematics", "odom:=laser_odom")
        self.estimator()

    def of(self, node, since=0.0):
        return [(when, status) for when, status in list(self.statuses)
                if status.name.startswith("%s/%s: " % (self.space, node)) and when >= since]

    def wait(self, condition, what):
        end = time.time() + TIMEOUT_S
        while time.time() < end:
            if condition():
                return
            time.sleep(0.05)
        self.fail(what() if callable(what) else what)

    def named(self, node, *texts, since=None):
        """A node states an ERROR with these texts two seconds after it has started, or after a time."""
        def found():
            return [when for when, status in self.of(node, since or 0.0)
                    if status.level == 2 and all(text in status.message for text in texts)]

        self.wait(found, lambda: "%s: %s" % (texts, [(s.level, s.message) for _, s in self.of(node)][-5:]))
        begin = since or self.of(node)[0][0]
        self.assertLess(found()[0] - begin, NAMED_WITHIN_S + LATE_S)

    def is_ok(self, node):
        statuses = self.of(node)
        return statuses and statuses[-1][1].level == 0

    def system_check(self):
        finished = subprocess.run([program("system_check"), "__ns:=" + self.space], capture_output=True, text=True,
                                  timeout=TIMEOUT_S, check=False)
        return finished.returncode, finished.stdout

    def test_no_scan(self):
        self.robot(scan=None)
        self.node("laser_odometry")
        self.named("laser_odometry", "no node publishes %s/scan" % self.space, "start the driver of the lidar")
        code, output = self.system_check()
        self.assertEqual(code, 1)
        self.assertIn("The first broken link is scan: no scans: no node publishes", output)

    def test_wrong_scan_topic(self):
        self.robot(scan="front/scan")
        self.node("feature_detector")
        self.named("feature_detector", "start with scan:=%s/front/scan" % self.space)

    def test_wrong_base_frame(self):
        self.robot()
        self.node("feature_detector", "_base_frame:=base_footprint")
        self.named("feature_detector", "there is no frame base_footprint, but above laser there is base_link, odom",
                   "set base_frame")

    def test_no_mount(self):
        self.robot(mount=False)
        self.node("laser_odometry")
        self.named("laser_odometry", "no transform base_link -> laser on tf", "start robot_state_publisher")
        code, output = self.system_check()
        self.assertEqual(code, 1)
        self.assertIn("The first broken link is tf: no transform base_link -> laser", output)

    def test_wrong_odometry_frame(self):
        self.robot()
        self.estimator("fast_slam", "_node/odom_frame:=odom_combined")
        self.named("fast_slam", "no node publishes")  # the gravest one is that there are no features
        self.wait(lambda: any("there is no frame odom_combined, but above base_link there is odom; set odom_frame" in value.value
                              for value in self.of("fast_slam")[-1][1].values), "tf")

    def test_no_odometry(self):
        self.robot(odom=None)
        self.node("laser_odometry")
        self.named("laser_odometry", "no node publishes %s/odom" % self.space, "start the driver of the wheels")

    def test_no_transform_from_odometry_to_base(self):
        self.robot(odom_tf=False)
        self.node("feature_detector")
        self.estimator()
        self.named("fast_slam", "no transform odom -> base_link on tf", "must also publish it")

    def test_odometry_of_another_frame(self):
        self.robot(odom_frame="odom_combined")
        self.node("kinematics")
        self.named("kinematics", "no usable odometry", "'odom_combined'", "set odom_frame and base_frame")

    def test_stamps_that_are_old(self):
        self.robot(offset_s=-5.0)
        self.node("laser_odometry")
        self.named("laser_odometry", "are 5 s older than the clock", "set the clocks")

    def test_stamps_that_are_ahead(self):
        self.robot(offset_s=5.0)
        self.node("kinematics")
        self.named("kinematics", "are 5 s newer than the clock", "set the clocks")

    def test_stamps_of_another_clock(self):
        self.robot(offset_s=-1e7)
        self.node("laser_odometry")
        self.named("laser_odometry", "are 116 days older than the clock", "use_sim_time")

    def test_simulated_time_without_a_clock(self):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.delete_param, "/use_sim_time")
        self.node("world_map")
        self.wait(lambda: self.of("world_map"), "it does not start")
        self.named("world_map", "use_sim_time is set, but nothing comes on /clock", "start the simulator")

    def test_upside_down(self):
        self.robot(turn_radps=0.6, mirrored=True)
        self.node("laser_odometry")
        self.named("laser_odometry", "turn against each other", "180 degrees about x")

    def test_two_estimators(self):
        self.robot()
        self.node("feature_detector")
        self.node("kinematics")
        self.estimator()
        self.wait(lambda: self.is_ok("fast_slam"), lambda: self.of("fast_slam")[-1])
        self.estimator("fast_slam_2")
        self.wait(lambda: any("two nodes publish the transform to odom" in status.message and
                              self.space + "/fast_slam_2" in status.message for _, status in self.of("fast_slam")),
                  lambda: self.of("fast_slam")[-1])

    def test_a_node_that_is_stopped_and_one_that_is_dead(self):
        self.robot()
        self.stack()
        self.wait(lambda: self.is_ok("kinematics"), lambda: self.of("kinematics")[-1])
        stopped = time.time()
        self.processes["laser_odometry"].send_signal(signal.SIGSTOP)
        self.named("kinematics", "no odometry any more: %s/laser_odometry" % self.space, "it is stopped", since=stopped)
        code, output = self.system_check()
        self.assertEqual(code, 1)
        self.assertIn("The first broken link is odometry: %s/laser_odometry reports nothing" % self.space, output)
        killed = time.time()
        self.processes["laser_odometry"].kill()
        self.named("kinematics", "%s/laser_odometry does not answer; start it again" % self.space, since=killed)

    def test_kinematics_that_is_stopped(self):
        self.robot()
        self.stack()
        self.wait(lambda: self.is_ok("fast_slam"), lambda: self.of("fast_slam")[-1])
        stopped = time.time()
        self.processes["kinematics"].send_signal(signal.SIGSTOP)
        self.named("fast_slam", "does not answer: kinematics is stopped", since=stopped)

    def test_disk_full(self):
        self.robot()
        self.node("occupancy_mapper", "_map_folder:=/proc/maps")  # a file system without space
        self.wait(lambda: any("the disk of /proc/maps is full" in value.value and "remove files" in value.value
                              for _, status in self.of("occupancy_mapper") for value in status.values),
                  lambda: self.of("occupancy_mapper")[-1])

    def test_lost(self):
        self.robot()
        self.stack()
        self.wait(lambda: self.is_ok("fast_slam"), lambda: self.of("fast_slam")[-1])
        time.sleep(1.0)
        called = time.time()
        rospy.ServiceProxy(self.space + "/global_localization", Empty)()
        self.named("fast_slam", "lost: ", "set its pose (initialpose)", since=called)

    def test_of_a_healthy_robot_no_cause_is_named(self):
        nodes = ("laser_odometry", "feature_detector", "kinematics", "fast_slam", "occupancy_mapper")
        self.robot(turn_radps=0.2)
        self.stack()
        self.wait(lambda: all(self.is_ok(node) for node in nodes), lambda: [self.of(node)[-1] for node in nodes])
        start = time.time()
        code, output = self.system_check()
        self.assertEqual(code, 0, output)
        self.assertEqual(output.count("\nok "), 7, output)
        time.sleep(8.0)
        named = [(status.name, status.message) for node in nodes for _, status in self.of(node, start) if status.level]
        self.assertEqual(named, [])
        lines = [log.msg for log in self.logs if log.name.startswith(self.space) and log.level >= Log.WARN]
        self.assertEqual(lines, [])


if __name__ == "__main__":
    rospy.init_node("causes", disable_rostime=True)
    rostest.rosrun("ramscout_bringup", "causes", Causes)
