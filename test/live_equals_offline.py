#!/usr/bin/python3
"""One recording through the live graph in lock-step and through run_bag: the same poses, the same drops by reason.

A robot drives one and a quarter rounds about a block of shelves, so that a loop is closed on the way. The recording
repeats a scan and an odometry message, which both sides must drop.
"""
import json
import math
import os
import random
import subprocess
import tempfile
import time
import unittest
import xmlrpc.client

import rosbag
import rosgraph
import rospy
import rostest
import tf2_ros
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped
from nav_msgs.msg import Odometry, Path
from ram_slam_msgs.msg import FeatureList, SmoothingStatus
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

START_S = 1000.0
SCAN_PERIOD_S = 0.1
ODOMETRY_PERIOD_S = 0.04
DURATION_S = 50.0
TURN_RATE = 0.16  # rad/s about the centre of the ellipse
RADII_M = (4.5, 3.0)
BEAMS = 241
FIELD_OF_VIEW = math.radians(240.0)
MOUNT_X_M = 0.2
REPEATED_SCAN = 150
REPEATED_ODOMETRY = 400
TOLERANCE_M = 1e-6
# How many nodes must be connected to what a node publishes before the first scan is played.
CONNECTIONS = {("/laser_odometry", "/laser_odom"): 2, ("/feature_detector", "/features"): 3,
               ("/map_smoother", "/smoothed_trajectory"): 1, ("/map_smoother", "/map_pose"): 1}
STAGES = {"/laser_odometry: odometry": "odometry", "/fast_slam: localisation": "estimator",
          "/map_smoother: smoothing": "smoothing"}


def box(x_min, y_min, x_max, y_max):
    corners = [(x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)]
    return list(zip(corners, corners[1:] + corners[:1]))


WALLS = (box(-6.5, -5.0, 6.5, 5.0) + box(-2.8, -1.2, 2.8, 1.2) + box(5.6, 1.0, 6.5, 2.2) + box(-6.5, -4.0, -5.4, -2.8)
         + box(-1.0, 4.2, 0.3, 5.0) + box(2.0, -5.0, 2.9, -4.1))


def stamp_at(time_s):
    """Of whole microseconds."""
    stamp_us = round(1e6 * (START_S + time_s))
    return rospy.Time(stamp_us // 1000000, 1000 * (stamp_us % 1000000))


def true_pose(time_s):
    angle = TURN_RATE * time_s
    heading = math.atan2(RADII_M[1] * math.cos(angle), -RADII_M[0] * math.sin(angle))
    return RADII_M[0] * math.cos(angle), RADII_M[1] * math.sin(angle), heading


def distance_along(x, y, bearing):
    """To the nearest wall."""
    dx, dy = math.cos(bearing), math.sin(bearing)
    nearest = math.inf
    for (ax, ay), (bx, by) in WALLS:
        ex, ey = bx - ax, by - ay
        determinant = dx * ey - dy * ex
        if abs(determinant) < 1e-12:
            continue
        distance = ((ax - x) * ey - (ay - y) * ex) / determinant
        along = ((ax - x) * dy - (ay - y) * dx) / determinant
        if 0.0 < distance < nearest and 0.0 <= along <= 1.0:
            nearest = distance
    return nearest


def scan_at(time_s, noise):
    x, y, yaw = true_pose(time_s)
    x, y = x + MOUNT_X_M * math.cos(yaw), y + MOUNT_X_M * math.sin(yaw)
    scan = LaserScan()
    scan.header.stamp = stamp_at(time_s)
    scan.header.frame_id = "laser"
    scan.angle_min = -0.5 * FIELD_OF_VIEW
    scan.angle_max = 0.5 * FIELD_OF_VIEW
    scan.angle_increment = FIELD_OF_VIEW / (BEAMS - 1)
    scan.range_min, scan.range_max = 0.1, 20.0
    scan.ranges = [distance_along(x, y, yaw + scan.angle_min + i * scan.angle_increment) + noise.gauss(0.0, 0.01)
                   for i in range(BEAMS)]
    return scan


def odometry_messages():
    """Wheels that drive two per cent too far and drift in heading."""
    messages = []
    x = y = yaw = 0.0
    before = true_pose(0.0)
    for i in range(int(DURATION_S / ODOMETRY_PERIOD_S) + 3):
        now = true_pose(i * ODOMETRY_PERIOD_S)
        step = 1.02 * math.hypot(now[0] - before[0], now[1] - before[1])
        turn = math.remainder(now[2] - before[2], 2.0 * math.pi)
        yaw += 0.5 * turn
        x, y = x + step * math.cos(yaw), y + step * math.sin(yaw)
        yaw += 0.5 * turn + 0.002 * step
        before = now
        message = Odometry()
        message.header.stamp = stamp_at(i * ODOMETRY_PERIOD_S)
        message.header.frame_id = "odom"
        message.child_frame_id = "base_link"
        message.pose.pose.position.x, message.pose.pose.position.y = x, y
        message.pose.pose.orientation.z, message.pose.pose.orientation.w = math.sin(0.5 * yaw), math.cos(0.5 * yaw)
        messages.append(message)
    messages.insert(REPEATED_ODOMETRY, messages[REPEATED_ODOMETRY])
    return messages


def recording():
    """(topic, message) in the order of the stamps; of equal stamps odometry comes first."""
    noise = random.Random(1)
    scans = [scan_at(0.05 + i * SCAN_PERIOD_S, noise) for i in range(int(DURATION_S / SCAN_PERIOD_S))]
    scans.insert(REPEATED_SCAN, scans[REPEATED_SCAN])
    messages = [("odom", message) for message in odometry_messages()] + [("scan", message) for message in scans]
    return sorted(messages, key=lambda pair: (pair[1].header.stamp, pair[0] == "scan"))


def mount():
    transform = TransformStamped()
    transform.header.stamp = stamp_at(0.0)
    transform.header.frame_id, transform.child_frame_id = "base_link", "laser"
    transform.transform.translation.x = MOUNT_X_M
    transform.transform.rotation.w = 1.0
    return transform


def run_offline(messages, folder):
    path = os.path.join(folder, "recording.bag")
    with rosbag.Bag(path, "w") as bag:
        stamp = messages[0][1].header.stamp
        bag.write("/tf_static", TFMessage([mount()]), stamp)
        for topic, message in messages:
            bag.write("/" + topic, message, message.header.stamp)
    output = os.path.join(folder, "offline")
    subprocess.run(["rosrun", "ramscout_bringup", "run_bag", path, "--output", output, "--live-settings"], check=True,
                   stdout=subprocess.DEVNULL, timeout=120)
    with open(os.path.join(output, "trajectory_online.tum"), encoding="utf-8") as lines:
        rows = [line.split() for line in lines if not line.startswith("#")]
    poses = {int(round(float(row[0]) * 1e6)): (float(row[1]), float(row[2])) for row in rows}
    with open(os.path.join(output, "summary.json"), encoding="utf-8") as summary:
        return poses, json.load(summary)


class LiveGraph:
    def __init__(self):
        self.poses = {}
        self.features_us = 0
        self.smoothed_us = 0
        self.corrections_sent = self.corrections_followed = 0
        self.dropped = {}
        options = {"queue_size": 1000, "tcp_nodelay": True}
        self.subscribers = [
            rospy.Subscriber("pose", PoseWithCovarianceStamped, self.on_pose, **options),
            rospy.Subscriber("features", FeatureList, self.on_features, **options),
            rospy.Subscriber("smoothing_status", SmoothingStatus, self.on_smoothed, **options),
            rospy.Subscriber("corrected_trajectory", Path, self.on_correction, **options),
            rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics, **options)]
        self.publishers = {"odom": rospy.Publisher("odom", Odometry, **options),
                           "scan": rospy.Publisher("scan", LaserScan, **options)}
        self.transforms = tf2_ros.StaticTransformBroadcaster()
        self.transforms.sendTransform(mount())

    def on_pose(self, message):
        position = message.pose.pose.position
        self.poses[microseconds(message)] = (position.x, position.y)

    def on_features(self, message):
        self.features_us = microseconds(message)

    def on_smoothed(self, message):
        self.corrections_sent = message.correction_count
        self.smoothed_us = microseconds(message)

    def on_correction(self, _):
        self.corrections_followed += 1

    def on_diagnostics(self, message):
        for status in message.status:
            if status.name in STAGES:
                self.dropped[STAGES[status.name]] = {
                    entry.key[len("dropped: "):]: int(entry.value.split(",")[0])
                    for entry in status.values if entry.key.startswith("dropped: ")}

    def is_connected(self):
        # scan and the static transform: detector, laser odometry, estimator, smoother; odom: laser odometry
        return (self.publishers["scan"].get_num_connections() >= 4 and self.publishers["odom"].get_num_connections() >= 1
                and self.transforms.pub_tf.get_num_connections() >= 4
                and all(subscriber.get_num_connections() >= 1 for subscriber in self.subscribers)
                and all(outgoing_connections(*output) >= count for output, count in CONNECTIONS.items()))

    def is_done_with(self, stamp_us):
        return (stamp_us in self.poses and self.smoothed_us >= stamp_us
                and self.corrections_followed >= self.corrections_sent)

    def play(self, messages):
        """Each scan waits until the one before has gone through every node."""
        waiting_us = []
        for topic, message in messages:
            self.publishers[topic].publish(message)
            if topic == "scan":
                waiting_us.append(microseconds(message))
                # Odometry sets the estimator going: by then it shall have the scan and its features.
                wait_until(lambda: self.features_us >= waiting_us[-1], 10.0)
            while topic == "odom" and waiting_us and waiting_us[0] <= microseconds(message):
                stamp_us = waiting_us.pop(0)
                if not wait_until(lambda: self.is_done_with(stamp_us), 10.0):
                    raise RuntimeError("no result for the scan of %.6f s" % (1e-6 * stamp_us))


def outgoing_connections(node, topic):
    """Of a node that publishes a topic, as its own slave API states them."""
    _, _, address = xmlrpc.client.ServerProxy(rosgraph.get_master_uri()).lookupNode(rospy.get_name(), node)
    if not address:
        return 0
    _, _, connections = xmlrpc.client.ServerProxy(address).getBusInfo(rospy.get_name())
    return sum(1 for connection in connections if connection[2] == "o" and connection[4] == topic)


def microseconds(message):
    return message.header.stamp.to_nsec() // 1000


def wait_until(condition, timeout_s):
    deadline = time.time() + timeout_s
    while not condition():
        if time.time() > deadline:
            return False
        time.sleep(0.001)
    return True


class LiveEqualsOffline(unittest.TestCase):
    def test_poses_and_drops(self):
        messages = recording()
        with tempfile.TemporaryDirectory() as folder:
            offline, summary = run_offline(messages, folder)
        live = LiveGraph()
        self.assertTrue(wait_until(live.is_connected, 30.0), "the nodes are not connected")
        time.sleep(1.0)  # the static transform is on its way
        live.play(messages)
        self.assertGreater(summary["loop_closures"], 0, "the drive closes no loop")
        self.assertGreater(live.corrections_followed, 0, "no correction was followed")
        self.assertEqual(sorted(offline), sorted(live.poses))
        worst_m, worst_us = max((math.dist(live.poses[stamp_us], offline[stamp_us]), stamp_us) for stamp_us in offline)
        different = [stamp_us for stamp_us in sorted(offline)
                     if math.dist(live.poses[stamp_us], offline[stamp_us]) > TOLERANCE_M]
        self.assertLessEqual(worst_m, TOLERANCE_M, "at %.6f s; %d poses differ, the first ones at %s us"
                             % (1e-6 * worst_us, len(different), different[:3]))
        dropped = {stage: {row["reason"]: row["count"] for row in summary["left_out"][stage]}
                   for stage in STAGES.values()}
        self.assertEqual(dropped["odometry"], {"stamp not later than the one before": 2})
        self.assertTrue(wait_until(lambda: live.dropped == dropped, 5.0), "%s, offline %s" % (live.dropped, dropped))


if __name__ == "__main__":
    rospy.init_node("live_equals_offline")
    rostest.rosrun("ramscout_bringup", "live_equals_offline", LiveEqualsOffline)
