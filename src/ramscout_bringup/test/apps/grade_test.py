#!/usr/bin/python3
"""grade on a short way through the office, with limits that are kept and one that is not."""
import json
import pathlib
import xml.etree.ElementTree

import rosunit
from synthetic_log import ProgramTest

CONFIG = pathlib.Path(__file__).resolve().parents[4] / "config"


class GradeTest(ProgramTest):

    def grade(self, limits, fault="{kind: wheel_slip, start_s: 2, amount: 0.1}"):
        """Six metres of the office's corridor with a fault."""
        self.write("tour.yaml", "waypoints: [[1, 6], [7, 6]]\n")
        self.write("world.yaml", (CONFIG / "worlds/office.yaml").read_bytes())
        self.write("short.yaml", "world: world.yaml\ntour: tour.yaml\nfaults: [%s]\nlimits: {%s}\n" % (fault, limits))
        return self.run_program("grade", self.path("short.yaml"), "3", "--config", str(CONFIG), "--output",
                                self.path("out"))

    def test_limits_that_are_kept_end_well_and_leave_the_reports(self):
        finished = self.grade("ate_m: 0.1, tour_driven: 1, map_iou: 0.5, yaw_rms_rad: 0.02, times_lost: 0")
        self.assertEqual(finished.returncode, 0, finished.stderr)
        report = json.loads(self.read("out/short.json"))
        self.assertEqual([run["seed"] for run in report["runs"]], [3])
        self.assertEqual(report["runs"][0]["broken"], [])
        self.assertGreater(report["runs"][0]["figures"]["ate_m"], 0.0)
        self.assertTrue(pathlib.Path(self.path("out/short_3/map.png")).exists())

    def test_a_broken_limit_is_named_and_ends_with_an_error(self):
        finished = self.grade("ate_m: 0.000001, tour_driven: 1")
        self.assertEqual(finished.returncode, 1)
        self.assertIn("short, seed 3: ate_m is", finished.stderr)
        suite = xml.etree.ElementTree.fromstring(self.read("out/short.xml"))
        self.assertEqual(suite.get("failures"), "1")
        self.assertEqual(len(suite.findall("testcase/failure")), 1)

    def test_the_system_keeps_the_limits_of_a_shipped_scenario(self):
        finished = self.run_program("grade", str(CONFIG / "scenarios/slip.yaml"), "--config", str(CONFIG), "--output",
                                    self.path("out"), timeout_s=200)
        self.assertEqual(finished.returncode, 0, finished.stderr)

    def test_a_fault_that_is_impossible_is_named(self):
        finished = self.grade("ate_m: 1", "{kind: door, start_s: 1, target: nowhere}")
        self.assertEqual(finished.returncode, 1)
        self.assertIn("nowhere", finished.stderr)


if __name__ == "__main__":
    rosunit.unitrun("ramscout_bringup", "grade_test", GradeTest)
