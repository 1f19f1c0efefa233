#!/usr/bin/python3
"""A robot and a lidar are files: every launch file takes a new one by its path, and the graph runs with it."""
import pathlib
import shutil
import signal
import subprocess
import tempfile
import unittest

import rospy
import rostest
import yaml
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

ROOT = pathlib.Path(__file__).resolve().parent.parent
NEW_LIDAR = {"feature_detector": {"laser_range_sigma": 0.017}, "laser_odometry": {"max_range_m": 7.0},
             "simulator": {"lidar": {"beams": 123, "range_max_m": 7.0, "scan_rate_hz": 20.0}}}
NEW_ROBOT = {"kinematics": {"model": "differential", "differential": {"wheel_separation_m": 0.41}},
             "simulator": {"laser_frame": "laser"}}
LAUNCHES = {"full": (), "ramscout": (), "RAMscout": (), "two_robots": (), "features": (), "fast_slam": (), "map": (),
            "smoothing": (), "landmark_smoothing": (), "demo": ("bag:=none",), "play": ("bag:=none",)}


def parameters(launch, *arguments):
    run = subprocess.run(["roslaunch", "--dump-params", "ramscout_bringup", launch + ".launch", *arguments], check=True,
                         stdout=subprocess.PIPE, text=True)
    return yaml.safe_load(run.stdout)


class RobotsAndLidars(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        folder = pathlib.Path(self.folder.name)
        (folder / "new_lidar.yaml").write_text(yaml.safe_dump(NEW_LIDAR))
        (folder / "new_robot.yaml").write_text(yaml.safe_dump(NEW_ROBOT))
        shutil.copy(ROOT / "config/robots/ramscout.urdf", folder / "new_robot.urdf")
        self.arguments = ("robot:=%s" % (folder / "new_robot"), "lidar:=%s" % (folder / "new_lidar"))

    def test_every_launch_file_takes_a_new_robot_and_a_new_lidar(self):
        for launch, needed in LAUNCHES.items():
            with self.subTest(launch=launch):
                values = parameters(launch, *needed, *self.arguments)
                self.assertEqual(values["/kinematics/differential/wheel_separation_m"], 0.41)
                self.assertEqual(values["/feature_detector/laser_range_sigma"], 0.017)
                self.assertEqual(values["/laser_odometry/max_range_m"], 7.0)
                self.assertEqual(values["/simulator/lidar/beams"], 123)

    def test_every_shipped_robot_and_lidar_can_be_named(self):
        names = [[path.stem for path in sorted((ROOT / "config" / kind).glob("*.yaml"))] for kind in ("robots", "lidars")]
        for robot in names[0]:
            values = parameters("full", "robot:=" + robot)
            self.assertIn('name="%s"' % robot, values["/robot_description"].lower())
        for lidar in names[1]:
            shipped = yaml.safe_load((ROOT / "config/lidars" / (lidar + ".yaml")).read_text())
            values = parameters("full", "lidar:=" + lidar)
            self.assertEqual(values["/simulator/lidar/beams"], shipped["simulator"]["lidar"]["beams"])

    def test_the_graph_runs_with_a_new_robot_and_a_new_lidar(self):
        launch = subprocess.Popen(["roslaunch", "--wait", "ramscout_bringup", "ramscout.launch", *self.arguments],
                                  stdout=subprocess.DEVNULL)
        self.addCleanup(launch.wait)
        self.addCleanup(launch.send_signal, signal.SIGINT)
        rospy.init_node("robots_and_lidars")
        self.assertEqual(len(rospy.wait_for_message("scan", LaserScan, timeout=60.0).ranges), 123)
        rospy.wait_for_message("laser_odom", Odometry, timeout=60.0)


if __name__ == "__main__":
    rostest.rosrun("ramscout_bringup", "robots_and_lidars", RobotsAndLidars)
