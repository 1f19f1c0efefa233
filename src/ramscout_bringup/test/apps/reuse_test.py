#!/usr/bin/python3
"""The matrix of reuse: its cells differ in three keys, and a diagonal of them keeps its limits."""
import pathlib
import subprocess
import sys

import rosunit
import yaml
from synthetic_log import PROGRAMS, ProgramTest

ROOT = pathlib.Path(__file__).resolve().parents[4]
sys.path.insert(0, str(ROOT / "scripts"))
import reuse  # noqa: E402  (found by the path above)

DIAGONAL = ("car-rplidar-ekf_slam", "omni-sick_lms-ukf_localiser", "ramscout-depth_camera-fast_slam")


class ReuseTest(ProgramTest):

    def setUp(self):
        super().setUp()
        self.matrix = yaml.safe_load((ROOT / "config/reuse.yaml").read_text())

    def run_cells(self, *cells):
        return subprocess.run([str(ROOT / "scripts/reuse.py"), *cells, "--grade", PROGRAMS + "/grade", "--output",
                               self.path("out")], capture_output=True, text=True, timeout=400, check=False)

    def test_the_matrix_has_36_cells_that_differ_in_robot_lidar_and_estimator_alone(self):
        cells = reuse.cells(self.matrix)
        self.assertEqual(len(set(cells)), 36)
        rest = []
        for cell in cells:
            scenario = reuse.scenario_of(self.matrix, ROOT / "config", cell)
            self.assertEqual(tuple(scenario.pop(key) for key in ("robot", "lidar", "estimator")), cell)
            self.assertIn("online_ate_m", scenario.pop("limits"))
            self.assertEqual(scenario.pop("map_by", None), "fast_slam" if cell[2] == "ukf_localiser" else None)
            rest.append(scenario)
        self.assertTrue(all(scenario == rest[0] for scenario in rest))

    def test_a_diagonal_of_cells_keeps_its_limits(self):
        finished = self.run_cells(*DIAGONAL)
        self.assertEqual(finished.returncode, 0, finished.stdout + finished.stderr)
        table = self.read("out/reuse.md").decode()
        self.assertEqual(table.count("| kept |"), len(DIAGONAL), table)

    def test_a_cell_that_is_not_in_the_matrix_is_refused_with_those_that_are(self):
        finished = self.run_cells("tank-rplidar-ekf_slam")
        self.assertEqual(finished.returncode, 1)
        self.assertIn("car-rplidar-ekf_slam", finished.stderr)


if __name__ == "__main__":
    rosunit.unitrun("ramscout_bringup", "reuse_test", ReuseTest)
