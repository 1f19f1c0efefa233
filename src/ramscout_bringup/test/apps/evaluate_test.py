#!/usr/bin/python3
"""evaluate and evaluate_map on trajectories and maps whose errors are known."""
import gzip
import json
import math

import rosunit
from synthetic_log import ProgramTest, true_poses, tum


def moved(poses, x_m, y_m, turn_rad):
    """The poses seen from another frame."""
    c, s = math.cos(turn_rad), math.sin(turn_rad)
    return [(t, x_m + c * x - s * y, y_m + s * x + c * y, yaw + turn_rad) for t, x, y, yaw in poses]


def straight(count=61, scale=1.0):
    """1 m/s along x, a pose per half second."""
    return [(10.0 + 0.5 * i, scale * 0.5 * i, 0.0, 0.0) for i in range(count)]


def pgm(rows):
    """Of characters: '#' occupied, '.' free, '?' unknown; the first row is the upper one."""
    shades = {"#": 0, ".": 254, "?": 205}
    header = "P5\n%d %d\n255\n" % (len(rows[0]), len(rows))
    return header.encode() + bytes(shades[cell] for row in rows for cell in row)


def room_rows():
    return ["#" * 60] + ["#" + "." * 58 + "#"] * 38 + ["#" * 60]


class EvaluateTest(ProgramTest):

    def evaluate(self, *arguments):
        """The table by the names of its rows, and what was printed."""
        finished = self.run_program("evaluate", *arguments, "--json", self.path("table.json"))
        self.assertEqual(finished.returncode, 0, finished.stderr)
        return {row["name"]: row for row in json.loads(self.read("table.json"))}, finished.stdout

    def refusal_of(self, program, *arguments):
        finished = self.run_program(program, *arguments)
        self.assertNotEqual(finished.returncode, 0)
        return finished.stderr

    def map(self, name, rows, **changes):
        self.write(name + ".pgm", pgm(rows))
        fields = {"image": name + ".pgm", "resolution": 0.05, "origin": "[0.0, 0.0, 0.0]", "negate": 0,
                  "occupied_thresh": 0.65, "free_thresh": 0.196, **changes}
        return self.write(name + ".yaml", "".join("%s: %s\n" % field for field in fields.items()))

    def figures(self, *arguments):
        finished = self.run_program("evaluate_map", *arguments, "--json", self.path("figures.json"))
        self.assertEqual(finished.returncode, 0, finished.stderr)
        return json.loads(self.read("figures.json"))

    def test_a_trajectory_has_no_error_against_itself_in_another_frame(self):
        estimate = self.write("estimate.tum", tum(true_poses()))
        truth = self.write("truth.tum", tum(moved(true_poses(), 5.0, -3.0, 2.0)))
        table, _ = self.evaluate(estimate, "--ground-truth", truth)
        for row in table.values():
            self.assertLess(row["max"], 1e-5, row["name"])
        self.assertEqual(table["absolute, aligned (ATE): position"]["count"], len(true_poses()))

    def test_a_scale_error_is_its_share_of_each_piece(self):
        estimate = self.write("estimate.tum", tum(straight(scale=1.02)))
        truth = self.write("truth.tum", tum(straight()))
        table, _ = self.evaluate(estimate, "--ground-truth", truth)
        self.assertAlmostEqual(table["relative (RPE) over 1 m: position"]["mean"], 0.02, places=6)
        self.assertAlmostEqual(table["relative (RPE) over 5 m: position"]["max"], 0.10, places=6)
        self.assertAlmostEqual(table["relative (RPE) over 10 s: position"]["rms"], 0.20, places=6)
        # Aligned at the middle of 30 m, the ends are 1 % of the length away.
        self.assertAlmostEqual(table["absolute, aligned (ATE): position"]["max"], 0.3, places=6)
        self.assertAlmostEqual(table["absolute, aligned (ATE): position"]["median"], 0.16, delta=0.011)

    def test_yaw_errors_are_in_degrees(self):
        turned = [(t, x, y, math.radians(3.0 if i % 2 else -3.0)) for i, (t, x, y, _) in enumerate(straight())]
        table, _ = self.evaluate(self.write("estimate.tum", tum(turned)), "--ground-truth",
                                 self.write("truth.tum", tum(straight())))
        row = table["absolute, aligned (ATE): yaw"]
        self.assertEqual(row["unit"], "deg")
        self.assertAlmostEqual(row["rms"], 3.0, places=4)

    def test_packed_files_give_the_same_table(self):
        truth = tum(straight()).encode()
        estimate = self.write("estimate.tum", tum(straight(scale=1.01)))
        plain, _ = self.evaluate(estimate, "--ground-truth", self.write("truth.tum", truth))
        packed, _ = self.evaluate(estimate, "--ground-truth", self.write("truth.tum.gz", gzip.compress(truth)))
        self.assertEqual(plain, packed)

    def test_poses_without_truth_are_counted(self):
        _, printed = self.evaluate(self.write("estimate.tum", tum(straight(61))), "--ground-truth",
                                   self.write("truth.tum", tum(straight(41))))
        self.assertIn("20 of 61 poses left out", printed)

    def test_relations_give_their_errors_by_hand(self):
        relations = self.write("pairs.relations", "# by hand\n10.0 12.0 2.03 0.04 0 0 0 0.1\n10.0 40.5 30.5 0 0 0 0 0\n")
        table, printed = self.evaluate(self.write("estimate.tum", tum(straight(62))), "--relations", relations)
        self.assertAlmostEqual(table["all pairs: translation"]["max"], 0.05, places=6)
        self.assertAlmostEqual(table["all pairs: rotation"]["max"], math.degrees(0.1), places=6)
        self.assertEqual(table["all pairs: translation"]["count"], 2)
        self.assertEqual(table["pairs > 30 s apart: translation"]["count"], 1)
        self.assertLess(table["pairs > 30 s apart: translation"]["max"], 1e-6)
        self.assertIn("2 relations; farthest pose used 0.000 s away; 0 stamps", printed)

    def test_odometry_bridges_stamps_far_from_any_pose(self):
        estimate = self.write("estimate.tum", tum(straight(11)))
        relations = self.write("pairs.relations", "10.0 18.0 8 0 0 0 0 0\n")
        alone, _ = self.evaluate(estimate, "--relations", relations)
        self.assertAlmostEqual(alone["all pairs: translation"]["max"], 3.0, places=6)
        odometry = self.write("odometry.tum", tum(moved(straight(), 2.0, 7.0, 1.0)))
        bridged, printed = self.evaluate(estimate, "--relations", relations, "--odometry", odometry)
        self.assertLess(bridged["all pairs: translation"]["max"], 1e-5)
        self.assertIn("1 stamps more than 0.1 s from any pose, 1 of them bridged by odometry", printed)

    def test_one_reference_is_needed_and_not_two(self):
        estimate = self.write("estimate.tum", tum(straight()))
        relations = self.write("pairs.relations", "10.0 12.0 2 0 0 0 0 0\n")
        for arguments in ((), ("--ground-truth", estimate, "--relations", relations)):
            self.assertIn("wanted one of --ground-truth and --relations", self.refusal_of("evaluate", estimate, *arguments))

    def test_unusable_trajectories_are_named_with_their_line(self):
        good = self.write("good.tum", tum(straight()))
        bad = self.write("bad.tum", tum(straight(2)) + "12.0 1 2\n")
        self.assertIn("%s:3: wanted 'stamp x y z" % bad, self.refusal_of("evaluate", bad, "--ground-truth", good))
        empty = self.write("empty.tum", "# nothing\n")
        self.assertIn("%s has no pose" % empty, self.refusal_of("evaluate", good, "--ground-truth", empty))
        elsewhen = self.write("elsewhen.tum", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n")
        self.assertIn("have 0 stamps in common", self.refusal_of("evaluate", good, "--ground-truth", elsewhen))
        steep = self.write("steep.tum", "1 0 0 0 0.5 0 0 0.866\n2 1 0 0 0.5 0 0 0.866\n")
        self.assertIn("does not lie in the x-y plane", self.refusal_of("evaluate", steep, "--ground-truth", good))
        self.assertNotEqual(self.refusal_of("evaluate", self.path("none.tum"), "--ground-truth", good), "")

    def test_a_map_agrees_with_itself(self):
        room = self.map("room", room_rows())
        figures = self.figures(room, "--true-map", room)
        self.assertEqual(figures["occupied cells"], 2 * 60 + 2 * 38)
        self.assertEqual(figures["doubled walls"], 0.0)
        for name in ("occupied IoU", "free IoU", "coverage"):
            self.assertEqual(figures[name], 1.0, name)
        self.assertEqual(figures["wall distance, max [m]"], 0.0)

    def test_without_a_true_map_only_doubled_walls_are_stated(self):
        rows = room_rows()
        rows[4] = "#" + "#" * 58 + "#"  # four cells from the upper wall
        figures = self.figures(self.map("room", rows))
        self.assertNotIn("occupied IoU", figures)
        # Both walls but for the four cells beside each corner, where two directions meet.
        self.assertAlmostEqual(figures["doubled walls across free space"], 2 * 50 / (196.0 + 58.0), places=9)

    def test_trajectories_align_maps_of_different_frames(self):
        estimate = self.map("room", room_rows(), origin="[-7.0, 3.0, 0.0]")
        truth = self.map("truth", room_rows())
        apart = self.figures(estimate, "--true-map", truth)
        self.assertLess(apart["occupied IoU"], 0.1)
        poses = [(float(i), -6.0 + 0.1 * i, 4.0 + 0.02 * i * i, 0.0) for i in range(8)]
        aligned = self.figures(estimate, "--true-map", truth, "--trajectory", self.write("estimate.tum", tum(poses)),
                               "--ground-truth", self.write("truth.tum", tum(moved(poses, 7.0, -3.0, 0.0))))
        self.assertEqual(aligned["occupied IoU"], 1.0)
        self.assertLess(aligned["wall distance, max [m]"], 0.051)

    def test_a_map_alone_or_a_half_alignment_is_refused(self):
        room = self.map("room", room_rows())
        poses = self.write("poses.tum", tum(straight()))
        self.assertIn("--ground-truth", self.refusal_of("evaluate_map", room, "--true-map", room, "--trajectory", poses))
        self.assertIn("--trajectory", self.refusal_of("evaluate_map", room, "--true-map", room, "--ground-truth", poses))
        self.assertIn("--true-map", self.refusal_of("evaluate_map", room, "--trajectory", poses, "--ground-truth", poses))

    def test_damaged_maps_are_refused_by_their_name(self):
        room = self.map("room", room_rows())
        self.write("room.pgm", pgm(room_rows())[:-10])
        self.assertIn("room.pgm", self.refusal_of("evaluate_map", room))
        lost = self.map("lost", room_rows(), image="none.pgm")
        self.assertIn("none.pgm", self.refusal_of("evaluate_map", lost))
        unknown = self.map("unknown", ["?" * 10] * 10)
        good = self.map("good", room_rows())
        self.assertTrue(self.refusal_of("evaluate_map", good, "--true-map", unknown).startswith("evaluate_map: "))


if __name__ == "__main__":
    rosunit.unitrun("ramscout_bringup", "evaluate_test", EvaluateTest)
