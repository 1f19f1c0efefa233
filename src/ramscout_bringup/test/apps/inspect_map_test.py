#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""inspect_map states what a saved map holds, and refuses with one line what cannot be started with."""
import os
import struct
import subprocess
import tempfile
import unittest

import rosunit

PROGRAM = os.path.join(os.environ.get("RAMSCOUT_PROGRAMS", ""), "inspect_map")


def world_file(content):
    checksum = 0xcbf29ce484222325
    for byte in content:
        checksum = (checksum ^ byte) * 0x100000001b3 % 2**64
    return b"RAMWORLD" + struct.pack("<IQQ", 2, len(content), checksum) + content


class InspectMap(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.save("empty", world_file(bytes(7 * 8)))

    def tearDown(self):
        self.folder.cleanup()

    def save(self, name, content):
        os.mkdir(os.path.join(self.folder.name, name))
        with open(os.path.join(self.folder.name, name, "map.world"), "wb") as file:
            file.write(content)

    def run_on(self, *arguments):
        return subprocess.run((PROGRAM, "--folder", self.folder.name) + arguments, capture_output=True, text=True)

    def test_it_states_what_a_map_holds(self):
        result = self.run_on("empty")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("0 landmarks, 0 scans, 0 poses", result.stdout)

    def test_it_lets_a_new_map_begin(self):
        self.assertEqual(self.run_on("--mode", "new", "").returncode, 0)

    def test_it_refuses_with_one_line(self):
        self.save("damaged", world_file(bytes(7 * 8))[:-1] + b"x")
        for arguments, reason in ((("--mode", "new", "empty"), "leave out map:=empty"),
                                  (("--mode", "localise", ""), "map:=NAME"),
                                  (("--mode", "localise", "empty"), "no landmarks"),
                                  (("--mode", "other", "empty"), "mode must be"),
                                  (("damaged",), "damaged/map.world: it is damaged"),
                                  (("missing",), "No such file"),
                                  (("../empty",), "a file name must be")):
            result = self.run_on(*arguments)
            self.assertEqual(result.returncode, 1, arguments)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertIn(reason, result.stderr)


if __name__ == "__main__":
    rosunit.unitrun("ramscout_bringup", "inspect_map_test", InspectMap)
