#!/usr/bin/env python3
"""What a newcomer types first: commands that there are not, help, the demonstration, a drive.

usage: command_line_test.py ZERORATE [unittest arguments]
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ZERORATE = sys.argv.pop(1)


def run(*arguments, folder=None):
    return subprocess.run([ZERORATE, *arguments], cwd=folder, capture_output=True, text=True, timeout=240, check=False)


def axes_of(text):
    """The axes of the table of scores, in its order."""
    table = text[text.index("ratio to CM [95 %]"):].split("\n\n")[0]
    return re.findall(r"^([xyz]) +kalman", table, re.MULTILINE)


class FirstWord(unittest.TestCase):
    def test_that_is_no_command_is_named_with_the_nearest_one(self):
        done = run("replya", "x.csv")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(done.stderr, 'zerorate: no command is called "replya"; did you mean "replay"? '
                                      "('zerorate --help' lists them)\n")

    def test_that_is_far_from_every_command_gets_no_suggestion(self):
        self.assertEqual(run("recording.csv.gz").stderr,
                         "zerorate: no command is called \"recording.csv.gz\" ('zerorate --help' lists them)\n")

    def test_help_is_the_option_help(self):
        self.assertEqual(run("help").stdout, run("--help").stdout)
        self.assertIn("--through", run("help", "demo").stdout)
        self.assertEqual(run("help", "dmeo").returncode, 2)


class Demonstration(unittest.TestCase):
    def test_help_names_the_model_that_runs(self):
        self.assertRegex(run("demo", "--help").stdout, r"--model TEXT=lsm6dso \(with RECORDING adis16405\)")

    def test_shows_the_vertical_axis_and_each_ratio_with_its_interval(self):
        with tempfile.TemporaryDirectory(prefix="zerorate-") as folder:
            done = run("demo", "--hours", "0.5", "--directory", folder)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertEqual(axes_of(done.stdout), ["z"])
            self.assertRegex(done.stdout, r"(?m)^z +kalman +\d+ +[\d.]+ +[\d.]+ \[[\d.]+, [\d.]+\] ")
            self.assertNotIn("no --model was given", done.stdout)
            axes = json.loads((pathlib.Path(folder) / "replay.json").read_text(encoding="utf-8"))["axes"]
            self.assertEqual(list(axes), ["x", "y", "z"])
            page = (pathlib.Path(folder) / "report.html").read_text(encoding="utf-8")
            self.assertIn("Bias of axis z", page)
            self.assertIn("; --axis all shows the others too\n", run("replay", "drive.csv.gz", folder=folder).stdout)


class RecordingAtRest(unittest.TestCase):
    def test_shows_every_axis_the_vertical_one_first(self):
        with tempfile.TemporaryDirectory(prefix="zerorate-") as folder:
            run("simulate", "--rest", "1800", "-o", "rest.csv.gz", folder=folder)
            replay = ("replay", "rest.csv.gz", "--schedule", "still=30,drive=60")
            self.assertEqual(axes_of(run(*replay, folder=folder).stdout), ["z", "x", "y"])
            self.assertEqual(axes_of(run(*replay, "--axis", "x", folder=folder).stdout), ["x"])


if __name__ == "__main__":
    unittest.main()
