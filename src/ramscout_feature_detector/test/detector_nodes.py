#!/usr/bin/python3
"""The detectors as nodes: scans of any shape from any mounting, and what they refuse."""
import io
import math
import subprocess
import threading
import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from ram_slam_msgs.msg import FeatureList
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

TIMEOUT_S = 10.0
SILENCE_S = 0.5
NAN = float("nan")
ROOM = (-2.0, -1.7, 2.2, 1.9)  # left, bottom, right, top, in the base frame
CORNERS = [(ROOM[i], ROOM[j]) for i in (0, 2) for j in (1, 3)]
# frame: x, y, yaw in the base frame, and whether the laser counts its beams the other way round
MOUNTINGS = {"laser": (0.1, 0.05, 0.3, 1.0), "hanging_laser": (-0.1, 0.0, -0.2, -1.0)}


def range_in_room(x, y, angle):
    """Exact distance from a place in the room to its walls."""
    c, s = math.cos(angle), math.sin(angle)
    to_x = ((ROOM[2] if c > 0 else ROOM[0]) - x) / c if abs(c) > 1e-12 else math.inf
    to_y = ((ROOM[3] if s > 0 else ROOM[1]) - y) / s if abs(s) > 1e-12 else math.inf
    return min(to_x, to_y)


def mounting(frame, x, y, rotation):
    """Of a laser on the robot; rotation: quaternion x, y, z, w."""
    message = TransformStamped()
    message.header.frame_id = "base_link"
    message.child_frame_id = frame
    message.transform.translation.x, message.transform.translation.y = x, y
    q = message.transform.rotation
    q.x, q.y, q.z, q.w = rotation
    return message


def mountings():
    messages = [mounting("tilted_laser", 0.0, 0.0, (0.0, math.sin(0.25), 0.0, math.cos(0.25)))]
    for frame, (x, y, yaw, direction) in MOUNTINGS.items():
        c, s = math.cos(yaw / 2), math.sin(yaw / 2)
        # Upside down: half a turn about the laser's x axis, then the yaw.
        messages.append(mounting(frame, x, y, (0.0, 0.0, s, c) if direction > 0 else (c, s, 0.0, 0.0)))
    return TFMessage(messages)


class TruncatedScan(LaserScan):
    """Loses its end on the wire."""

    def serialize(self, buff):
        whole = io.BytesIO()
        LaserScan.serialize(self, whole)
        buff.write(whole.getvalue()[:-1000])


class DetectorNodes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stamp = 100.0
        cls.lists = []
        cls.edges = []
        cls.logs = []
        cls.tf = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        cls.tf.publish(mountings())
        cls.publisher = rospy.Publisher("scan", LaserScan, queue_size=10)
        cls.subscribers = [
            rospy.Subscriber("features", FeatureList, cls.lists.append),
            rospy.Subscriber("edges", FeatureList, cls.edges.append),
            rospy.Subscriber("/rosout", Log, cls.logs.append)]
        cls.wait_until(lambda: cls.publisher.get_num_connections() == 2)
        cls.wait_until(lambda: all(s.get_num_connections() >= 1 for s in cls.subscribers))
        for frame in MOUNTINGS:  # until the mountings have arrived
            cls.wait_until(lambda: cls.send_and_wait(cls.scan(frame=frame), 0.2) is not None)

    @staticmethod
    def wait_until(condition, timeout_s=TIMEOUT_S):
        deadline = time.time() + timeout_s
        while time.time() < deadline:
            if condition():
                return True
            time.sleep(0.01)
        return False

    @classmethod
    def scan(cls, frame="laser", angle_min=-math.pi, increment=2 * math.pi / 720, count=720):
        cls.stamp += 0.1
        x, y, yaw, direction = MOUNTINGS.get(frame.lstrip("/"), MOUNTINGS["laser"])
        message = LaserScan()
        message.header.stamp = rospy.Time.from_sec(cls.stamp)
        message.header.frame_id = frame
        message.angle_min = angle_min
        message.angle_increment = increment
        message.angle_max = angle_min + (count - 1) * increment
        message.range_min = 0.05
        message.range_max = 20.0
        message.ranges = [range_in_room(x, y, yaw + direction * (angle_min + i * increment)) for i in range(count)]
        return message

    @classmethod
    def send_and_wait(cls, scan, timeout_s=TIMEOUT_S):
        """The features of that scan, or None."""
        cls.publisher.publish(scan)
        found = []

        def arrived():
            found[:] = [features for features in cls.lists if features.header.stamp == scan.header.stamp]
            return bool(found)

        return found[0] if cls.wait_until(arrived, timeout_s) else None

    def corners_of(self, scan):
        features = self.send_and_wait(scan)
        self.assertIsNotNone(features)
        self.assertEqual(features.header.frame_id, "base_link")
        places = [(f.pose.pose.position.x, f.pose.pose.position.y) for f in features.features]
        for place in places:
            self.assertLess(min(math.dist(place, corner) for corner in CORNERS), 0.02, places)
        return len(places)

    def skips(self, scan):
        self.assertIsNone(self.send_and_wait(scan, SILENCE_S))
        self.assertEqual(self.corners_of(self.scan()), 4)  # and goes on

    def test_a_full_turn_shows_the_four_corners(self):
        self.assertEqual(self.corners_of(self.scan()), 4)

    def test_clockwise_scans_show_the_same(self):
        self.assertEqual(self.corners_of(self.scan(angle_min=math.pi, increment=-2 * math.pi / 720)), 4)

    def test_beams_may_be_counted_in_another_turn(self):
        self.assertEqual(self.corners_of(self.scan(angle_min=3 * math.pi)), 4)

    def test_any_field_of_view_and_size(self):
        for count in (181, 361, 447, 461, 1081, 2000):
            scan = self.scan(angle_min=-0.75 * math.pi, increment=1.5 * math.pi / (count - 1), count=count)
            self.assertGreaterEqual(self.corners_of(scan), 2, count)

    def test_a_laser_mounted_upside_down(self):
        self.assertEqual(self.corners_of(self.scan(frame="hanging_laser")), 4)

    def test_two_lasers_on_one_topic(self):
        for frame in ("laser", "hanging_laser", "laser"):
            self.assertEqual(self.corners_of(self.scan(frame=frame)), 4)

    def test_a_leading_slash_is_left_out(self):
        self.assertEqual(self.corners_of(self.scan(frame="/laser")), 4)

    def test_frames_that_are_empty_unknown_or_tilted_are_skipped(self):
        for frame in ("", "nowhere", "tilted_laser"):
            self.skips(self.scan(frame=frame))

    def test_readings_without_meaning_yield_an_empty_list(self):
        for value in (NAN, math.inf, -math.inf, 0.0, -1.0, 1e30, 1e-40):
            scan = self.scan()
            scan.ranges = [value] * len(scan.ranges)
            self.assertEqual(self.corners_of(scan), 0, value)
        for node in ("/feature_detector", "/edge_detector"):
            self.assertTrue(self.wait_until(lambda: self.logged(node, Log.WARN, "no reading contains information")))

    def test_a_few_readings_without_meaning_do_no_harm(self):
        scan = self.scan()
        scan.ranges[10::97] = [NAN] * len(scan.ranges[10::97])
        self.assertGreaterEqual(self.corners_of(scan), 2)

    def test_scans_that_cannot_be_used_are_skipped(self):
        for change in (
                lambda s: setattr(s, "ranges", []), lambda s: setattr(s, "ranges", [1.0] * 100000),
                lambda s: setattr(s, "angle_increment", 0.0), lambda s: setattr(s, "angle_increment", NAN),
                lambda s: setattr(s, "angle_increment", 1e-9), lambda s: setattr(s, "angle_min", math.inf),
                lambda s: setattr(s, "range_min", 30.0), lambda s: setattr(s, "range_max", NAN),
                lambda s: setattr(s, "range_min", -1.0), lambda s: setattr(s.header, "stamp", rospy.Time())):
            scan = self.scan()
            change(scan)
            self.skips(scan)

    def test_times_and_intensities_without_meaning_do_no_harm(self):
        for value in (NAN, -1.0, math.inf, 1e30):
            scan = self.scan()
            scan.time_increment = scan.scan_time = value
            scan.intensities = [value] * 3
            scan.angle_max = value
            self.assertEqual(self.corners_of(scan), 4, value)

    def test_what_is_assumed_about_the_range_limit_is_reported(self):
        for range_max, level, text in (
                (math.inf, Log.WARN, "range_max is no limit; 100 m is assumed"),
                (2.0, Log.INFO, "readings at range_max; taken to mean that nothing came back")):
            scan = self.scan()
            scan.range_max = range_max
            self.assertIsNotNone(self.send_and_wait(scan))
            for node in ("/feature_detector", "/edge_detector"):
                self.assertTrue(self.wait_until(lambda: self.logged(node, level, text)), (node, text))

    def test_a_message_that_comes_twice_counts_once(self):
        scan = self.scan()
        self.assertIsNotNone(self.send_and_wait(scan))
        self.publisher.publish(scan)
        self.assertEqual(self.corners_of(self.scan()), 4)  # the next one is through
        self.assertEqual(sum(features.header.stamp == scan.header.stamp for features in self.lists), 1)

    def logged(self, node, level, text):
        return any(log.name == node and log.level == level and text in log.msg for log in self.logs)

    def test_what_is_odd_but_can_be_used_is_warned_of_once_by_both(self):
        for attribute, value, text in (
                ("angle_max", 0.0, "number of ranges"), ("time_increment", NAN, "time_increment is"),
                ("scan_time", -1.0, "scan_time is"), ("intensities", [NAN] * 3, "number of intensities")):
            for _ in range(3):
                scan = self.scan()
                setattr(scan, attribute, value)
                self.assertEqual(self.corners_of(scan), 4, attribute)
            for node in ("/feature_detector", "/edge_detector"):
                self.assertTrue(self.wait_until(lambda: self.logged(node, Log.WARN, text)), text)
                self.assertEqual(sum(log.name == node and text in log.msg and " laser:" in log.msg
                                     for log in self.logs), 1, text)
        self.assertEqual(self.corners_of(self.scan(frame="/laser")), 4)
        self.assertTrue(self.wait_until(lambda: self.logged("/edge_detector", Log.WARN, "begins with a slash")))

    def test_a_truncated_scan_is_skipped_and_named(self):
        scan = self.scan()
        self.skips(TruncatedScan(*[getattr(scan, slot) for slot in LaserScan.__slots__]))
        self.assertTrue(self.wait_until(lambda: self.logged("/feature_detector", Log.ERROR, "deserializing")))

    def test_a_publisher_of_another_type_is_refused(self):
        other = subprocess.Popen(["rostopic", "pub", "-r", "20", "scan", "std_msgs/String", "no scan"],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

        def publishers():
            state = rospy.get_master().getSystemState()[2][0]
            return next(nodes for topic, nodes in state if topic == rospy.resolve_name("scan"))

        try:
            self.assertTrue(self.wait_until(lambda: len(publishers()) == 2))
            for _ in range(5):
                self.assertEqual(self.corners_of(self.scan()), 4)
        finally:
            other.terminate()
            other.wait()

    def prints(self, detector, topic, text):
        """Whether a detector started on a topic prints a text."""
        node = subprocess.Popen(["rosrun", "ramscout_feature_detector", detector, "__name:=bare_" + detector,
                                 "scan:=" + topic, "features:=nowhere"], stderr=subprocess.PIPE, text=True)
        limit = threading.Timer(TIMEOUT_S, node.terminate)
        limit.start()
        try:
            return any(text in line for line in node.stderr)
        finally:
            limit.cancel()
            node.terminate()
            node.wait()
            node.stderr.close()

    def test_a_node_without_parameters_reports_it(self):
        for detector in ("feature_detector", "edge_detector"):
            self.assertTrue(self.prints(detector, "nothing", "all are at their defaults"), detector)

    def test_a_topic_of_another_type_is_named(self):
        other = rospy.Publisher("no_scan", String, queue_size=1)
        texts = []
        subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, lambda message: texts.extend(
            status.message for status in message.status if "bare_edge_detector" in status.name))
        node = subprocess.Popen(["rosrun", "ramscout_feature_detector", "edge_detector", "__name:=bare_edge_detector",
                                 "scan:=no_scan", "features:=nowhere"], stderr=subprocess.DEVNULL)
        try:
            self.assertTrue(self.wait_until(lambda: any(
                "carries std_msgs/String, not sensor_msgs/LaserScan" in text for text in texts)), texts)
        finally:
            node.terminate()
            node.wait()
            subscriber.unregister()
            other.unregister()

    def test_both_detectors_run_side_by_side(self):
        scan = self.scan()
        corners = self.send_and_wait(scan)
        self.assertTrue(self.wait_until(lambda: any(e.header.stamp == scan.header.stamp for e in self.edges)))
        edges = next(e for e in self.edges if e.header.stamp == scan.header.stamp)
        self.assertEqual({f.type for f in corners.features}, {"corner"})
        self.assertEqual({f.type for f in edges.features}, {"edge"})
        self.assertEqual(len(edges.features), 4)
        for feature in corners.features + edges.features:
            self.assertTrue(feature.classifier.startswith({"corner": "pg1:", "edge": "pg2:"}[feature.type]))
            self.assertGreater(feature.pose.covariance[0], 0.0)
            self.assertGreaterEqual(feature.pose.covariance[14], 1e6)  # height is not observed

    def test_markers_and_picture_on_request(self):
        markers, pictures = [], []
        subscribers = [rospy.Subscriber("feature_markers", MarkerArray, markers.append),
                       rospy.Subscriber("feature_image", Image, pictures.append)]
        self.assertTrue(self.wait_until(lambda: all(s.get_num_connections() == 1 for s in subscribers)))

        def shown():
            self.send_and_wait(self.scan())
            return markers and pictures

        self.assertTrue(self.wait_until(shown))
        self.assertEqual({m.ns for m in markers[-1].markers}, {"one_sigma", "bisectors", "excluded"})
        ellipses = next(m for m in markers[-1].markers if m.ns == "one_sigma")
        self.assertEqual(len(ellipses.points), 4 * 2 * 24)
        picture = pictures[-1]
        self.assertEqual((picture.encoding, picture.width, picture.height), ("rgb8", 1500, 500))
        self.assertEqual(len(picture.data), picture.step * picture.height)
        for border in (500, 1000):
            column = [picture.data[picture.step * row + 3 * border] for row in range(picture.height)]
            self.assertEqual(set(column), {90})
        for subscriber in subscribers:
            subscriber.unregister()


if __name__ == "__main__":
    rospy.init_node("detector_nodes_test")
    rostest.rosrun("ramscout_feature_detector", "detector_nodes", DetectorNodes)
