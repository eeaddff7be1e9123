#!/usr/bin/env python3
"""zerorate as a process: wrong usage and data that cannot be used end with codes of their own.

usage: exit_codes_test.py ZERORATE [unittest arguments]
"""

import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

ZERORATE = sys.argv.pop(1)
WRONG_USAGE, BAD_DATA = 2, 3
NOISE = random.Random(1)


def noisy(_):
    return NOISE.gauss(0.0, 0.1)


class ExitCode(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.recording = pathlib.Path(folder.name) / "rest.csv"

    def record(self, rows, rate, columns="t_s,rate_dps", further=""):
        lines = [columns] + [f"{0.1 * k:.1f},{rate(k)}{further}" for k in range(rows)]
        self.recording.write_text("\n".join(lines) + "\n", encoding="utf-8")

    def assert_ends(self, code, command, *options):
        run = subprocess.run([ZERORATE, command, self.recording, *options], capture_output=True, text=True,
                             timeout=60, check=False)
        self.assertEqual(run.returncode, code, run.stderr)
        self.assertTrue(run.stderr.startswith("zerorate: "), run.stderr)

    def test_of_a_recording_that_is_too_short_is_bad_data(self):
        self.record(100, noisy)
        self.assert_ends(BAD_DATA, "diagnose")
        self.record(20, noisy)
        self.assert_ends(BAD_DATA, "characterize")

    def test_of_a_recording_whose_stamps_tell_no_rate_is_bad_data(self):
        for stamps in ([0.0], [0.0] * 20, [0.0, 1e9]):
            lines = [f"{time:.1f},{noisy(0)}" for time in stamps]
            self.recording.write_text("\n".join(["t_s,rate_dps", *lines]) + "\n", encoding="utf-8")
            self.assert_ends(BAD_DATA, "replay", "--schedule", "still=5,drive=5,seed=1")
        self.assert_ends(BAD_DATA, "replay", "--schedule", "still=5,drive=5,seed=1", "--filter-rate", "1")

    def test_of_a_constant_recording_is_bad_data(self):
        self.record(2000, lambda _: 0.25)
        self.assert_ends(BAD_DATA, "diagnose")
        self.assert_ends(BAD_DATA, "characterize")

    def test_of_a_recording_that_is_never_at_rest_is_bad_data(self):
        self.record(2000, noisy, "t_s,rate_dps,still", ",0")
        self.assert_ends(BAD_DATA, "diagnose")
        self.assert_ends(BAD_DATA, "characterize")

    def test_of_an_option_that_contradicts_the_recording_is_wrong_usage(self):
        self.record(2000, noisy)
        self.assert_ends(WRONG_USAGE, "diagnose", "--axis", "z")
        self.assert_ends(WRONG_USAGE, "characterize", "--order", "2")


if __name__ == "__main__":
    unittest.main()
