#!/usr/bin/python3
"""A map is saved, localised in and continued, by the commands of docs/maps.md, each time by new processes.

The robot starts elsewhere each time and is not given its place. The clock starts again, too.
"""
import hashlib
import math
import os
import signal
import subprocess
import tempfile
import time
import unittest

import rospy
import rostest
import yaml
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from nav_msgs.srv import GetMap
from ram_slam_msgs.msg import LandmarkMap, Tracking
from std_msgs.msg import Float32

HERE = os.path.dirname(os.path.realpath(__file__))
TIMEOUT_S = 120.0
MAP_IN_WORLD = (1.0, 6.0)  # where the first run starts; its heading is 0
FIRST_TOUR = ((1, 6), (20, 6), (20, 18), (1, 18), (1, 6), (4, 6))
LOCALISED_TOUR = ((16, 6), (20, 6), (20, 16))
CONTINUED_TOUR = ((3, 6), (39, 6), (39, 18), (20, 18), (20, 12))
FOUND_WITHIN_M = 10.0
MAX_ERROR_M = 0.1
MAX_RMSE_M = 0.05
MIN_GROWTH = 1.2  # of the known cells, by the second half of the building
MIN_KEPT = 0.95
OCCUPIED_PIXEL, UNKNOWN_PIXEL = 0, 205


def yaw_of(orientation):
    return 2.0 * math.atan2(orientation.z, orientation.w)


def run(command):
    """A command of the documentation; its exit code and what it prints."""
    finished = subprocess.run(command, shell=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=TIMEOUT_S)
    return finished.returncode, finished.stdout


def digests(folder):
    return {name: hashlib.sha256(open(os.path.join(folder, name), "rb").read()).hexdigest()
            for name in sorted(os.listdir(folder))}


class Drive:
    """One run of the stack on a tour, and what it published."""

    def __init__(self, start, tour, command):
        self.truth, self.poses, self.tracking, self.latest, self.progress = {}, [], [], {}, 0.0
        self.subscribers = [rospy.Subscriber(*topic, queue_size=2000, tcp_nodelay=True) for topic in (
            ("ground_truth", Odometry, self.on_truth), ("amcl_pose", PoseWithCovarianceStamped, self.poses.append),
            ("tracking", Tracking, self.tracking.append), ("tour_progress", Float32, self.on_progress))]
        self.subscribers += [rospy.Subscriber(name, kind, lambda message, name=name: self.latest.update({name: message}))
                             for name, kind in (("map", OccupancyGrid), ("landmarks", LandmarkMap))]
        self.tour_file = tempfile.NamedTemporaryFile("w", suffix=".yaml")
        self.tour_file.write("speed_mps: 1.0\nwaypoints: %s\n" % [list(point) for point in tour])
        self.tour_file.flush()
        self.processes = [subprocess.Popen(words, start_new_session=True) for words in (
            command.split(),
            ("roslaunch", os.path.join(HERE, "maps_robot.launch"), "start:=%s" % list(start), "tour:=" + self.tour_file.name))]

    def on_truth(self, message):
        pose = message.pose.pose
        self.truth[message.header.stamp.to_nsec()] = (pose.position.x, pose.position.y, yaw_of(pose.orientation))

    def on_progress(self, message):
        self.progress = message.data

    def wait_for_end(self):
        deadline = time.time() + TIMEOUT_S
        while self.progress < 1.0:
            if time.time() > deadline:
                raise AssertionError("the tour did not end: %.3f" % self.progress)
            time.sleep(0.1)
        time.sleep(1.0)

    def stop(self):
        for process in reversed(self.processes):
            os.killpg(process.pid, signal.SIGINT)
        for process in self.processes:
            process.wait(TIMEOUT_S)
        for subscriber in self.subscribers:
            subscriber.unregister()

    def errors(self, after_ns=0):
        """Distances between pose and truth in the map frame."""
        errors = []
        for pose in list(self.poses):
            stamp_ns = pose.header.stamp.to_nsec()
            if stamp_ns <= after_ns or stamp_ns not in self.truth:
                continue
            x, y, _ = self.truth[stamp_ns]
            errors.append(math.hypot(pose.pose.pose.position.x - x + MAP_IN_WORLD[0],
                                     pose.pose.pose.position.y - y + MAP_IN_WORLD[1]))
        return errors

    def found_ns(self):
        return next(message.header.stamp.to_nsec() for message in self.tracking if not message.lost)

    def driven_until(self, stamp_ns):
        way = [place for stamp, place in sorted(self.truth.items()) if stamp <= stamp_ns]
        return sum(math.hypot(b[0] - a[0], b[1] - a[1]) for a, b in zip(way, way[1:]))


def rmse(errors):
    return math.sqrt(sum(error * error for error in errors) / len(errors))


def cells_of(folder):
    """Known and occupied cells of a saved map, by their places in the map frame."""
    with open(os.path.join(folder, "map.yaml")) as file:
        description = yaml.safe_load(file)
    with open(os.path.join(folder, "map.pgm"), "rb") as file:
        assert file.readline() == b"P5\n" and file.readline().startswith(b"#")
        width, height = (int(word) for word in file.readline().split())
        assert file.readline() == b"255\n"
        pixels = file.read()
    column, row = (round(description["origin"][i] / description["resolution"]) for i in (0, 1))
    places = {(i % width + column, height - 1 - i // width + row): pixel for i, pixel in enumerate(pixels)}
    return ({place for place, pixel in places.items() if pixel != UNKNOWN_PIXEL},
            {place for place, pixel in places.items() if pixel == OCCUPIED_PIXEL})


class Maps(unittest.TestCase):
    def setUp(self):
        self.drive = None

    def tearDown(self):
        if self.drive is not None:
            self.drive.stop()

    def folder(self, name):
        return os.path.join(os.environ["ROS_HOME"], "maps", name)

    def test_1_a_map_is_saved(self):
        self.drive = Drive((1, 6, 0), FIRST_TOUR, "roslaunch ramscout_bringup slam.launch")
        self.drive.wait_for_end()
        code, text = run("rosservice call /map_smoother/optimize")
        self.assertIn("success: True", text)
        time.sleep(2.0)  # until estimator and mapper have followed
        code, text = run("rosservice call /world_map/save_map office")
        self.assertEqual(code, 0, text)
        self.assertIn("success: True", text)
        rospy.loginfo("first run: rmse %.4f m", rmse(self.drive.errors()))
        self.assertEqual(sorted(os.listdir(self.folder("office"))), ["map.pgm", "map.world", "map.yaml"])
        code, text = run("rosrun ramscout_bringup inspect_map --folder %s office" % os.path.dirname(self.folder("office")))
        self.assertEqual(code, 0, text)
        rospy.loginfo(text)

    def localise(self, estimator):
        """Drives through the map, and is right from the moment that the robot was found on."""
        self.drive = Drive((16, 6, 0), LOCALISED_TOUR,
                           "roslaunch ramscout_bringup slam.launch mode:=localise map:=office estimator:=" + estimator)
        self.drive.wait_for_end()
        self.assertTrue(self.drive.tracking[0].lost)
        found_ns = self.drive.found_ns()
        errors = self.drive.errors(found_ns)
        rospy.loginfo("localised by %s: found after %.1f m, largest error %.4f m, rmse %.4f m", estimator,
                      self.drive.driven_until(found_ns), max(errors), rmse(errors))
        self.assertLess(self.drive.driven_until(found_ns), FOUND_WITHIN_M)
        self.assertFalse(self.drive.tracking[-1].lost)
        self.assertLess(max(errors), MAX_ERROR_M)

    def test_2_a_robot_is_localised_in_it(self):
        before = digests(self.folder("office"))
        self.localise("fast_slam")
        served = rospy.ServiceProxy("static_map", GetMap)().map
        self.assertEqual(served.data, self.drive.latest["map"].data)
        code, text = run("rosservice call /world_map/save_map copy")
        self.assertIn("success: True", text)
        self.assertEqual(digests(self.folder("copy")), before)
        self.assertEqual(digests(self.folder("office")), before)

    def test_2_so_it_is_by_the_unscented_filter(self):
        before = digests(self.folder("office"))
        self.localise("ukf_localiser")
        self.assertEqual(digests(self.folder("office")), before)

    def test_3_it_is_continued(self):
        before = digests(self.folder("office"))
        self.drive = Drive((3, 6, 0), CONTINUED_TOUR, "roslaunch ramscout_bringup slam.launch mode:=continue map:=office")
        self.drive.wait_for_end()
        found_ns = self.drive.found_ns()
        errors = self.drive.errors(found_ns)
        rospy.loginfo("continued: found after %.1f m, largest error %.4f m, rmse %.4f m", self.drive.driven_until(found_ns),
                      max(errors), rmse(errors))
        self.assertLess(self.drive.driven_until(found_ns), FOUND_WITHIN_M)
        self.assertLess(rmse(errors), MAX_RMSE_M)
        self.assertEqual(digests(self.folder("office")), before)
        code, text = run("rosservice call /map_smoother/optimize")
        rospy.loginfo(text)
        self.assertIn("success: True", text)
        self.assertNotIn(" 0 closures", text)
        time.sleep(2.0)
        code, text = run("rosservice call /world_map/save_map larger_office")
        self.assertIn("success: True", text)
        code, text = run("rosrun ramscout_bringup inspect_map --folder %s larger_office" % os.path.dirname(self.folder("office")))
        self.assertEqual(code, 0, text)
        rospy.loginfo(text)
        known, occupied = cells_of(self.folder("office"))
        known_now, occupied_now = cells_of(self.folder("larger_office"))
        kept = len(occupied & occupied_now) / len(occupied)
        rospy.loginfo("%d cells known, then %d; %.3f of %d occupied ones kept", len(known), len(known_now), kept, len(occupied))
        self.assertGreater(len(known_now), MIN_GROWTH * len(known))
        self.assertGreater(kept, MIN_KEPT)

    def test_4_a_wrong_start_ends_with_one_line(self):
        for arguments, reason in (("mode:=localize map:=office", "mode must be new, continue or localise, not 'localize'"),
                                  ("mode:=localise", "needs the name of a map"),
                                  ("mode:=continue map:=nowhere", "maps/nowhere"),
                                  ("mode:=continue map:=../maps/office", "a file name must be"),
                                  ("map:=office", "mode:=new begins with an empty map")):
            code, text = run("roslaunch ramscout_bringup slam.launch " + arguments)
            self.assertNotEqual(code, 0, arguments)
            self.assertEqual(sum("inspect_map: " in line and reason in line for line in text.splitlines()), 1, text)
            self.assertNotIn("started with pid", text)


if __name__ == "__main__":
    rospy.init_node("maps")
    rostest.rosrun("ramscout_bringup", "maps", Maps)
