#!/usr/bin/python3
"""run_bag on logs of a known drive: exit codes, files, options, and the way that it finds."""
import gzip
import html.parser
import json
import lzma
import math
import os
import shutil

import rosunit
from synthetic_log import CONFIG, FIRST_STAMP_S, LINES, PERIOD_S, STEPS, ProgramTest, true_poses

FILES = {"map.pgm", "map.yaml", "map.png", "trajectory.tum", "trajectory_online.tum", "trajectory_filter.tum",
         "pose_graph.g2o", "map.world", "landmarks.yaml", "summary.json", "report.html",
         "timing.json"}


class Page(html.parser.HTMLParser):
    """A parsed page: the elements that are still open at its end, and the content of the one with the data."""

    def __init__(self, text):
        super().__init__()
        self.open = []
        self.data = ""
        self._is_data = False
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self._is_data = ("id", "data") in attrs
        if tag not in {"meta", "link"}:
            self.open.append(tag)

    def handle_endtag(self, tag):
        self._is_data = False
        if self.open.pop() != tag:
            raise ValueError("</%s> closes another element" % tag)

    def handle_data(self, data):
        if self._is_data:
            self.data += data


def poses_of(content):
    return [tuple(map(float, line.split())) for line in content.decode().splitlines()]


def largest_error(poses):
    """Greatest distance from the truth [m], both seen from their first pose."""
    truth = {round(t, 6): (x, y, yaw) for t, x, y, yaw in true_poses()}
    x0, y0, yaw0 = truth[round(poses[0][0], 6)]
    worst = 0.0
    for t, x, y, *_ in poses:
        tx, ty, _yaw = truth[round(t, 6)]
        ahead = math.cos(yaw0) * (tx - x0) + math.sin(yaw0) * (ty - y0)
        left = -math.sin(yaw0) * (tx - x0) + math.cos(yaw0) * (ty - y0)
        worst = max(worst, math.hypot(x - ahead, y - left))
    return worst


class RunBagTest(ProgramTest):

    def run_bag(self, log, *options, output="out"):
        return self.run_program("run_bag", log, "--output", self.path(output), "--config", CONFIG, *options)

    def mapped(self, *options, lines=None):
        """Trajectory and summary of a run that must succeed."""
        log = self.write("drive.clf", "".join(LINES if lines is None else lines))
        finished = self.run_bag(log, *options)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        return poses_of(self.read("out", "trajectory.tum")), json.loads(self.read("out", "summary.json"))

    def test_a_log_leaves_the_files_of_a_run_and_the_right_trajectory(self):
        poses, summary = self.mapped()
        self.assertEqual(set(os.listdir(self.path("out"))), FILES)
        self.assertEqual([pose[0] for pose in poses], [round(pose[0], 6) for pose in true_poses()])
        self.assertLess(largest_error(poses), 0.05)
        self.assertEqual(summary["motion_from"], "odometry and scans")
        self.assertEqual(summary["poses"], STEPS)
        self.assertAlmostEqual(summary["duration_s"], PERIOD_S * (STEPS - 1), places=6)
        self.assertIn("scans: %d" % STEPS, summary["notes"])
        self.assertIn("laser on the base: x 0.1 m", " ".join(summary["notes"]))
        self.assertIn("181 beams are assumed over 180 deg", " ".join(summary["notes"]))

    def test_a_robot_can_continue_the_map_and_localise_in_it(self):
        self.mapped()
        for mode in ("continue", "localise"):
            inspected = self.run_program("inspect_map", "--mode", mode, "--folder", self.path(""), "out")
            self.assertEqual(inspected.returncode, 0, inspected.stderr)

    def test_timing_states_the_length_of_the_recording(self):
        self.mapped("--duration", "2")
        timing = json.loads(self.read("out", "timing.json"))
        self.assertAlmostEqual(timing["recorded_s"], 2.0, places=6)
        self.assertGreater(timing["cpu_s"], 0.0)
        self.assertAlmostEqual(timing["times_real_time"], timing["recorded_s"] / timing["cpu_s"], places=6)

    def test_two_runs_and_packed_logs_give_the_same_bytes(self):
        text = "".join(LINES[:30]).encode()
        logs = [self.write("plain.clf", text), self.write("again.clf", text),
                self.write("packed.clf.gz", gzip.compress(text)), self.write("packed.clf.xz", lzma.compress(text))]
        for number, log in enumerate(logs):
            finished = self.run_bag(log, output=str(number))
            self.assertEqual(finished.returncode, 0, finished.stderr)
        for name in FILES - {"timing.json"}:
            for number in range(1, len(logs)):
                expected = self.read("0", name)
                if name == "report.html":  # states the name of its recording
                    expected = expected.replace(b"plain.clf", os.path.basename(logs[number]).encode())
                self.assertEqual(expected, self.read(str(number), name), (name, logs[number]))

    def test_the_report_is_one_sound_page_with_the_data_of_the_run(self):
        config = self.path("config")
        shutil.copytree(CONFIG, config)
        self.write("config/fast_slam.yaml", "particle_amount: 11\n")
        log = self.write("<b>drive&amp;.clf", "".join(LINES))
        finished = self.run_program("run_bag", log, "--output", self.path("out"), "--config", config)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        text = self.read("out", "report.html").decode()
        page = Page(text)
        data = json.loads(page.data)
        self.assertEqual(page.open, [])
        self.assertNotIn("http:", text)
        self.assertNotIn("https:", text)
        self.assertLess(len(text), 3000000)
        self.assertEqual(dict(data["about"])["recording"], "<b>drive&amp;.clf")
        self.assertEqual(data["summary"], json.loads(self.read("out", "summary.json")))
        self.assertEqual({path["name"] for path in data["paths"]}, {"odometry", "online", "final"})
        self.assertIn("scan points on known walls", {chart["name"] for chart in data["charts"]})
        self.assertEqual([(p["key"], p["value"]) for p in data["parameters"]], [("particle_amount", "11")])
        self.assertIn("%d of %d scans were used." % (STEPS, STEPS), {f["text"] for f in data["findings"]})

    def test_start_and_duration_choose_a_piece_of_the_drive(self):
        poses, summary = self.mapped("--start", "4", "--duration", "3")
        self.assertAlmostEqual(poses[0][0], FIRST_STAMP_S + 4.0, places=6)
        self.assertAlmostEqual(poses[-1][0], FIRST_STAMP_S + 7.0, places=6)
        self.assertAlmostEqual(summary["duration_s"], 3.0, places=6)

    def test_a_lower_rate_thins_the_scans_out(self):
        poses, _ = self.mapped("--max-rate", "2.5")
        steps = [round(after[0] - before[0], 6) for before, after in zip(poses, poses[1:])]
        self.assertTrue(all(step >= 0.4 - 1e-6 for step in steps), steps)
        self.assertEqual(len(poses), STEPS // 2)

    def test_a_mount_that_is_given_replaces_the_one_of_the_log(self):
        _, summary = self.mapped("--mount", "0.3,-0.1,0.5", "--duration", "2")
        self.assertIn("laser on the base: x 0.3 m, y -0.1 m, yaw 0.5 rad", summary["notes"])

    def test_a_field_of_view_that_is_given_is_not_an_assumption(self):
        _, summary = self.mapped("--fov", "180", "--duration", "2")
        self.assertNotIn("assumed", " ".join(summary["notes"]))

    def test_the_same_field_of_view_gives_the_same_trajectory(self):
        assumed, _ = self.mapped("--duration", "2")
        given, _ = self.mapped("--duration", "2", "--fov", "180")
        self.assertEqual(assumed, given)

    def test_a_wrong_field_of_view_spoils_the_trajectory(self):
        right, _ = self.mapped("--duration", "6")
        wrong, _ = self.mapped("--duration", "6", "--fov", "100")
        self.assertLess(largest_error(right), 0.03)
        self.assertGreater(largest_error(wrong), 2.0 * largest_error(right))

    def test_a_clock_that_was_set_back_needs_the_choice_of_a_drive(self):
        log = self.write("two.clf", "".join(LINES[30:60] + LINES[:20]))
        finished = self.run_bag(log)
        self.assertEqual(finished.returncode, 1)
        self.assertIn("--part", finished.stderr)
        for part, first, count in ((1, 30, 30), (2, 0, 20)):
            finished = self.run_bag(log, "--part", part)
            self.assertEqual(finished.returncode, 0, finished.stderr)
            poses = poses_of(self.read("out", "trajectory.tum"))
            self.assertEqual(len(poses), count)
            self.assertAlmostEqual(poses[0][0], FIRST_STAMP_S + PERIOD_S * first, places=6)
        self.assertEqual(self.run_bag(log, "--part", "3").returncode, 1)

    def test_wheels_only_makes_no_pose_graph(self):
        _, summary = self.mapped("--wheels-only")
        self.assertEqual(summary["motion_from"], "odometry alone")
        self.assertNotIn("pose_graph.g2o", os.listdir(self.path("out")))

    def test_without_smoothing_the_final_trajectory_is_the_estimators(self):
        self.mapped("--no-smoothing")
        self.assertEqual(self.read("out", "trajectory.tum"), self.read("out", "trajectory_filter.tum"))

    def test_wheels_that_stand_still_are_not_taken_for_odometry(self):
        lines = []
        for line in LINES:
            words = line.split()
            words[183:189] = ["0.1", "0", "0", "0", "0", "0"]
            lines.append(" ".join(words) + "\n")
        poses, summary = self.mapped(lines=lines)
        self.assertEqual(summary["motion_from"], "scans alone: there is no odometry")
        self.assertLess(largest_error(poses), 0.05)

    def test_fewer_than_half_of_the_scans_is_a_failure_that_leaves_its_files(self):
        damaged = ["FLASER 181 1.0 x\n"] * 40
        finished = self.run_bag(self.write("damaged.clf", "".join(damaged + LINES[:20])))
        self.assertEqual(finished.returncode, 1)
        self.assertIn("run_bag: only 20 of 60 scans could be used", finished.stderr)
        self.assertIn("left out 40 laser lines", self.read("out", "summary.json").decode())

    def test_a_file_that_is_no_log_is_refused_by_its_name(self):
        log = self.write("notes.clf", "PARAM robot_length 0.5\n")
        finished = self.run_bag(log)
        self.assertEqual(finished.returncode, 1)
        self.assertIn("run_bag: %s has no readable FLASER" % log, finished.stderr)
        self.assertFalse(os.path.exists(self.path("out")))

    def test_options_out_of_range_are_refused_by_their_name(self):
        log = self.write("drive.clf", "".join(LINES[:3]))
        for option, value in (("--fov", "0.5"), ("--start", "-1"), ("--duration", "0"), ("--max-rate", "-2"),
                              ("--mount", "1,2"), ("--sweep-direction", "sideways"), ("--config", "/nowhere")):
            finished = self.run_bag(log, option, value)
            self.assertNotEqual(finished.returncode, 0, option)
            self.assertIn(option, finished.stderr, option)
        self.assertNotEqual(self.run_bag(self.path("none.clf")).returncode, 0)

    def test_a_start_behind_the_end_of_the_drive_is_refused(self):
        log = self.write("drive.clf", "".join(LINES[:10]))
        finished = self.run_bag(log, "--start", "1000")
        self.assertEqual(finished.returncode, 1)
        self.assertTrue(finished.stderr.startswith("run_bag: "), finished.stderr)

    def test_an_unknown_estimator_and_a_wrong_parameter_are_named(self):
        log = self.write("drive.clf", "".join(LINES[:3]))
        finished = self.run_bag(log, "--estimator", "guess")
        self.assertEqual(finished.returncode, 1)
        self.assertIn("guess", finished.stderr)
        config = self.path("config")
        shutil.copytree(CONFIG, config)
        self.write("config/fast_slam.yaml", "particle_amuont: 5\n")
        finished = self.run_program("run_bag", log, "--output", self.path("out"), "--config", config)
        self.assertEqual(finished.returncode, 1)
        self.assertIn("unknown parameter 'particle_amuont'", finished.stderr)

    def test_the_output_folder_is_made_with_those_above_it(self):
        log = self.write("drive.clf", "".join(LINES[:5]))
        finished = self.run_bag(log, output="a/b/c")
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertTrue(os.path.isfile(self.path("a/b/c/map.pgm")))

    def test_the_bag_of_a_log_gives_the_trajectory_of_the_log(self):
        poses, _ = self.mapped()
        finished = self.run_program("log_to_bag", self.path("drive.clf"), self.path("drive.bag"))
        self.assertEqual(finished.returncode, 0, finished.stderr)
        finished = self.run_bag(self.path("drive.bag"), output="from_bag")
        self.assertEqual(finished.returncode, 0, finished.stderr)
        from_bag = poses_of(self.read("from_bag", "trajectory.tum"))
        self.assertEqual([pose[0] for pose in poses], [pose[0] for pose in from_bag])
        for ours, theirs in zip(poses, from_bag):  # angles are single precision in messages
            self.assertLess(math.dist(ours[1:3], theirs[1:3]), 0.005)

    def test_an_output_that_cannot_be_written_is_reported_before_the_work(self):
        finished = self.run_program("run_bag", self.write("drive.clf", "".join(LINES)), "--output", "/proc/out",
                                    "--config", CONFIG)
        self.assertEqual(finished.returncode, 1)
        self.assertIn("/proc/out", finished.stderr)
        self.assertNotIn("100%", finished.stdout)


if __name__ == "__main__":
    rosunit.unitrun("ramscout_bringup", "run_bag_test", RunBagTest)
