#!/usr/bin/python3
"""bag_check and log_to_bag on logs of a known drive."""
import math
import os
import re
import resource
import subprocess

import rosbag
import rosunit
from synthetic_log import FIRST_STAMP_S, LINES, MOUNT_X_M, PERIOD_S, PROGRAMS, STEPS, ProgramTest, true_poses


def yaw_of(rotation):
    return 2.0 * math.atan2(rotation.z, rotation.w)


class BagCheckTest(ProgramTest):

    def review(self, lines, *options):
        finished = self.run_program("bag_check", self.write("drive.clf", "".join(lines)), *options)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        return finished.stdout

    def to_bag(self, lines=LINES):
        finished = self.run_program("log_to_bag", self.write("drive.clf", "".join(lines)), self.path("drive.bag"))
        self.assertEqual(finished.returncode, 0, finished.stderr)
        return self.path("drive.bag")

    def test_states_scans_length_and_readings_of_a_good_log(self):
        report = self.review(LINES)
        self.assertIn("%d usable scans over %.1f s; longest gap 0.20 s" % (STEPS, PERIOD_S * (STEPS - 1)), report)
        self.assertIn("readings: 100.0 % hits, 0.0 % nothing came back, 0.0 % no information", report)
        length_m = sum(math.dist(a[1:3], b[1:3]) for a, b in zip(true_poses(), true_poses()[1:]))
        self.assertIn("odometry: %.1f m, turns of" % (1.05 * length_m), report)

    def test_states_how_far_the_robot_turned(self):
        turn_rad = sum(abs(math.remainder(b[3] - a[3], 2.0 * math.pi)) for a, b in zip(true_poses(), true_poses()[1:]))
        stated_deg = float(re.search(r"turns of (\d+) deg", self.review(LINES))[1])
        self.assertAlmostEqual(stated_deg, math.degrees(turn_rad), delta=0.6)

    def test_names_the_longest_gap_and_its_place(self):
        report = self.review(LINES[:20] + LINES[35:])
        self.assertIn("longest gap 3.20 s, 3.8 s after the first scan", report)

    def test_counts_readings_that_are_no_hits(self):
        words = LINES[0].split()
        words[2:20] = ["0.0"] * 18  # too close to be measured: 18 of 181
        report = self.review([" ".join(words) + "\n"] + LINES[1:2])
        self.assertIn("%.1f %% no information" % (100.0 * 18 / 362), report)

    def test_the_options_of_run_bag_choose_the_piece(self):
        self.assertIn("11 usable scans over 2.0 s", self.review(LINES, "--start", "1", "--duration", "2"))
        self.assertIn("30 usable scans", self.review(LINES, "--max-rate", "2.5"))

    def test_fewer_than_half_usable_scans_fail(self):
        log = self.write("damaged.clf", "FLASER 181 1.0 x\n" * 3 + "".join(LINES[:2]))
        finished = self.run_program("bag_check", log)
        self.assertEqual(finished.returncode, 1)
        self.assertIn("bag_check: fewer than half of the scans are usable", finished.stderr)
        self.assertIn("2 usable scans", finished.stdout)
        half = self.write("half.clf", "FLASER 181 1.0 x\n" * 2 + "".join(LINES[:2]))
        self.assertEqual(self.run_program("bag_check", half).returncode, 0)

    def test_what_is_no_recording_fails_by_its_name(self):
        for name, content in (("empty.clf", ""), ("text.log", "hello\n"), ("broken.bag", "#ROSBAG V2.0\n"),
                              ("broken.mcap", b"\x89MCAP0\r\n"), ("broken.db3", "SQLite format 3\0")):
            finished = self.run_program("bag_check", self.write(name, content))
            self.assertEqual(finished.returncode, 1, name)
            self.assertTrue(finished.stderr.startswith("bag_check: "), finished.stderr)
            self.assertIn(name, finished.stderr)

    def test_a_mount_and_a_field_of_view_are_taken_as_given(self):
        report = self.review(LINES[:5], "--mount", "0.3,-0.1,0.5", "--fov", "90")
        self.assertIn("laser on the base: x 0.3 m, y -0.1 m, yaw 0.5 rad", report)
        self.assertNotIn("assumed", report)

    def test_a_clock_that_was_set_back_needs_the_choice_of_a_drive(self):
        log = self.write("two.clf", "".join(LINES[30:60] + LINES[:20]))
        finished = self.run_program("bag_check", log)
        self.assertEqual(finished.returncode, 1)
        self.assertIn("read one of them with --part 1 to 2", finished.stderr)
        for part, count in ((1, 30), (2, 20)):
            finished = self.run_program("bag_check", log, "--part", part)
            self.assertEqual(finished.returncode, 0, finished.stderr)
            self.assertIn("%d usable scans" % count, finished.stdout)

    def test_a_start_behind_the_end_of_the_drive_fails(self):
        finished = self.run_program("bag_check", self.write("drive.clf", "".join(LINES)), "--start", "1000")
        self.assertEqual(finished.returncode, 1)
        self.assertIn("no scan between --start and --start + --duration", finished.stderr)

    def test_options_out_of_range_are_refused_by_their_name(self):
        log = self.write("drive.clf", "".join(LINES[:3]))
        for option, value in (("--fov", "0.5"), ("--start", "-1"), ("--duration", "0"), ("--max-rate", "0"),
                              ("--mount", "1,2"), ("--sweep-direction", "sideways")):
            finished = self.run_program("bag_check", log, option, value)
            self.assertNotEqual(finished.returncode, 0, option)
            self.assertIn(option, finished.stderr)

    def test_options_of_the_other_kind_of_recording_are_refused(self):
        log = self.write("plain.clf", "".join(LINES))
        for option, value in (("--scan-topic", "scan"), ("--odom-topic", "odom"), ("--base-frame", "base"),
                              ("--scan-clock-offset", "1")):
            finished = self.run_program("bag_check", log, option, value)
            self.assertEqual(finished.returncode, 1, option)
            self.assertIn("this is a CARMEN log", finished.stderr)
        finished = self.run_program("bag_check", self.to_bag(), "--fov", "180")
        self.assertEqual(finished.returncode, 1)
        self.assertIn("--fov is for CARMEN logs", finished.stderr)

    def test_a_bag_has_what_its_log_has(self):
        bag = self.run_program("bag_check", self.to_bag())
        self.assertEqual(bag.returncode, 0, bag.stderr)
        self.assertIn("%d usable scans over %.1f s" % (STEPS, PERIOD_S * (STEPS - 1)), bag.stdout)
        figures = [line for line in self.review(LINES).splitlines() if line.startswith(("readings:", "odometry:"))]
        for line in figures:
            if "m, turns" in line or "%" in line:
                self.assertIn(line, bag.stdout)

    def test_the_bag_has_each_message_of_the_drive_at_its_stamp(self):
        with rosbag.Bag(self.to_bag()) as bag:
            messages = [(topic, message, stamp.to_sec()) for topic, message, stamp in bag.read_messages()]
        scans = [message for topic, message, _ in messages if topic == "/scan"]
        odometry = [message for topic, message, _ in messages if topic == "/odom"]
        self.assertEqual(len(scans), STEPS)
        self.assertEqual(len(odometry), STEPS)
        for i, pose in enumerate(true_poses()):
            self.assertAlmostEqual(scans[i].header.stamp.to_sec(), FIRST_STAMP_S + PERIOD_S * i, places=6)
            self.assertAlmostEqual(odometry[i].pose.pose.position.x, 1.05 * pose[1], places=5)
            self.assertAlmostEqual(math.remainder(yaw_of(odometry[i].pose.pose.orientation) - pose[3], 2 * math.pi), 0.0,
                                   places=5)
        self.assertEqual(scans[0].header.frame_id, "laser")
        self.assertAlmostEqual(scans[0].angle_min, -math.pi / 2, places=6)
        self.assertAlmostEqual(scans[0].angle_increment, math.pi / 180, places=8)
        written = [float(word) for word in LINES[7].split()[2:183]]
        for ours, theirs in zip(written, scans[7].ranges):
            self.assertAlmostEqual(ours, theirs, places=5)

    def test_the_mount_is_repeated_so_that_playing_may_begin_anywhere(self):
        with rosbag.Bag(self.to_bag()) as bag:
            mounts = [(message.transforms[0], stamp.to_sec()) for _, message, stamp in bag.read_messages(["/tf_static"])]
        stamps = [stamp for _, stamp in mounts]
        self.assertEqual(len(stamps), 2)  # of 11.8 s
        self.assertGreater(stamps[1] - stamps[0], 10.0)
        for transform, _ in mounts:
            self.assertEqual((transform.header.frame_id, transform.child_frame_id), ("base_link", "laser"))
            self.assertAlmostEqual(transform.transform.translation.x, MOUNT_X_M, places=5)

    def test_a_log_that_cannot_be_read_leaves_no_bag(self):
        finished = self.run_program("log_to_bag", self.write("text.clf", "hello\n"), self.path("text.bag"))
        self.assertEqual(finished.returncode, 1)
        self.assertIn("log_to_bag: ", finished.stderr)
        self.assertEqual(sorted(os.listdir(os.path.dirname(self.path("text.bag")))), ["text.clf"])

    def test_an_older_bag_is_replaced_and_nothing_unfinished_stays(self):
        self.write("drive.bag", "an older one")
        self.to_bag(LINES[:3])
        self.assertTrue(self.read("drive.bag").startswith(b"#ROSBAG V2.0"))
        self.assertFalse(os.path.exists(self.path("drive.bag.active")))

    def test_a_damaged_chunk_in_the_middle_costs_its_messages_only_and_the_bag_is_named(self):
        damaged = self.path("damaged.bag")
        with rosbag.Bag(self.to_bag()) as bag, rosbag.Bag(damaged, "w", compression="bz2", chunk_threshold=3000) as copy:
            for topic, message, stamp in bag.read_messages():
                copy.write(topic, message, stamp)
        with rosbag.Bag(damaged) as bag:
            chunks = [chunk.pos for chunk in bag._chunks]
        self.assertGreater(len(chunks), 5)
        with open(damaged, "r+b") as file:
            file.seek(chunks[len(chunks) // 2] + 200)
            file.write(b"\xff" * 300)
        finished = self.run_program("bag_check", damaged)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertRegex(finished.stdout, r"left out \d+ messages: the bag .*damaged.bag is damaged")
        self.assertGreater(int(re.search(r"(\d+) usable scans", finished.stdout)[1]), STEPS // 2)

    def test_log_to_bag_on_a_full_disk_fails_with_the_reason_and_leaves_nothing(self):
        log = self.write("drive.clf", "".join(LINES))
        finished = subprocess.run(
            [os.path.join(PROGRAMS, "log_to_bag"), log, self.path("full.bag")], capture_output=True, text=True, timeout=60,
            check=False, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000)))
        self.assertEqual(finished.returncode, 1, finished.stderr)
        self.assertIn("full.bag was not written", finished.stderr)
        self.assertEqual([name for name in os.listdir(self.path("")) if name.startswith("full.bag")], [])


if __name__ == "__main__":
    rosunit.unitrun("ramscout_bringup", "bag_check_test", BagCheckTest)
