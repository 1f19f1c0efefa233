"""A CARMEN log of an exact drive around the pillar of a room, and what the tests of programs share."""
import math
import os
import subprocess
import tempfile
import unittest

PROGRAMS = os.environ["RAMSCOUT_PROGRAMS"]  # the folder of the programs under test
CONFIG = os.path.join(os.path.dirname(__file__), "..", "..", "..", "..", "config")
FIRST_STAMP_S = 100.0
PERIOD_S = 0.2
STEPS = 60
MOUNT_X_M = 0.1  # the laser is ahead of the base
ROOM = [(-4, -3), (4, -3), (4, 1), (5, 1), (5, 2), (4, 2), (4, 3), (-4, 3)]
PILLAR = [(-0.5, -0.4), (0.6, -0.4), (0.6, 0.4), (-0.5, 0.4)]


def walls():
    return [(corners[i - 1], corners[i]) for corners in (ROOM, PILLAR) for i in range(len(corners))]


def cast_ray(x, y, bearing):
    """Distance to the nearest wall: p + t d = a + s (b - a), by Cramer's rule."""
    dx, dy = math.cos(bearing), math.sin(bearing)
    nearest = math.inf
    for (ax, ay), (bx, by) in walls():
        ex, ey, rx, ry = bx - ax, by - ay, ax - x, ay - y
        determinant = dy * ex - dx * ey
        if abs(determinant) < 1e-12:
            continue
        t = (ry * ex - rx * ey) / determinant
        s = (dx * ry - dy * rx) / determinant
        if t > 0.0 and 0.0 <= s <= 1.0:
            nearest = min(nearest, t)
    return nearest


def true_poses():
    """Stamp [s], x, y [m], yaw [rad] of the base: half an ellipse around the pillar."""
    poses = []
    for i in range(STEPS):
        angle = math.pi * i / STEPS
        yaw = math.atan2(1.6 * math.cos(angle), -2.0 * math.sin(angle))
        poses.append((FIRST_STAMP_S + PERIOD_S * i, 2.0 * math.cos(angle), 1.6 * math.sin(angle), yaw))
    return poses


def laser_line(pose, wheel_scale=1.05):
    """A FLASER line of 181 readings; the wheels stretch the drive."""
    stamp, x, y, yaw = pose
    laser_x, laser_y = x + MOUNT_X_M * math.cos(yaw), y + MOUNT_X_M * math.sin(yaw)
    ranges = ["%.3f" % cast_ray(laser_x, laser_y, yaw + math.radians(beam - 90)) for beam in range(181)]
    base_x, base_y = wheel_scale * x, wheel_scale * y
    return "FLASER 181 %s %.6f %.6f %.6f %.6f %.6f %.6f %.6f host %.6f\n" % (
        " ".join(ranges), base_x + MOUNT_X_M * math.cos(yaw), base_y + MOUNT_X_M * math.sin(yaw), yaw, base_x, base_y,
        yaw, stamp, stamp - FIRST_STAMP_S)


LINES = [laser_line(pose) for pose in true_poses()]


def tum(poses):
    return "".join("%.9f %.9f %.9f 0 0 0 %.9f %.9f\n" % (t, x, y, math.sin(yaw / 2), math.cos(yaw / 2))
                   for t, x, y, yaw in poses)


class ProgramTest(unittest.TestCase):
    """Runs programs on files in a folder of its own."""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)

    def path(self, name):
        return os.path.join(self._folder.name, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return self.path(name)

    def read(self, *names):
        with open(os.path.join(self._folder.name, *names), "rb") as file:
            return file.read()

    def run_program(self, name, *arguments, timeout_s=60):
        """The finished process, with its output and errors as text."""
        return subprocess.run([os.path.join(PROGRAMS, name), *map(str, arguments)], capture_output=True, text=True,
                              timeout=timeout_s, check=False)
