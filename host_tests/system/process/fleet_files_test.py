#!/usr/bin/env python3
"""Recordings of another format in `fleet run` and `accept`, and the exit code of a run with --alarm.

usage: fleet_files_test.py ZERORATE [unittest arguments]
"""

import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

ZERORATE = sys.argv.pop(1)
PASS, FAIL, BAD_DATA = 0, 1, 3
FORMAT = ("--columns", "t=stamp,gx=wx,gy=wy,gz=wz", "--units", "time=ms,rate=radps")
LIMITS = """schema = "zerorate.limits/1"
[angle_random_walk_dps_per_sqrt_hz]
lo = 0.0
hi = 1.0
"""


def zerorate(*arguments):
    return subprocess.run([ZERORATE, *map(str, arguments)], capture_output=True, text=True, timeout=300, check=False)


class ForeignFiles(unittest.TestCase):
    """A recording as zerorate names its columns, and the same one with other names and units."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        self.addCleanup(folder.cleanup)
        self.plain, self.fleet = pathlib.Path(folder.name) / "plain.csv", pathlib.Path(folder.name) / "fleet"
        self.limits, self.database = pathlib.Path(folder.name) / "limits.toml", pathlib.Path(folder.name) / "fleet.sqlite"
        self.fleet.mkdir()
        self.foreign = self.fleet / "one.csv"
        self.limits.write_text(LIMITS, encoding="utf-8")
        noise = random.Random(1)
        rows = [(50 * k, [noise.gauss(0.1, 0.02) for _ in range(3)]) for k in range(2000)]
        self.write(self.plain, "t_s,gx_dps,gy_dps,gz_dps", [(ms / 1000, *rates) for ms, rates in rows])
        self.write(self.foreign, "stamp,wx,wy,wz", [(ms, *map(math.radians, rates)) for ms, rates in rows])

    @staticmethod
    def write(path, header, rows):
        path.write_text("\n".join([header, *(",".join(f"{x:.9g}" for x in row) for row in rows)]) + "\n", encoding="utf-8")

    def test_are_accepted_as_those_of_its_own(self):
        figures = []
        for recording in ((self.plain,), (self.foreign, *FORMAT)):
            run = zerorate("accept", *recording, "--limits", self.limits, "--json", "-")
            self.assertEqual(run.returncode, PASS, run.stderr)
            figures.append(json.loads(run.stdout)["figures"])
        self.assertEqual(len(figures[0]), 3)
        for one, other in zip(*figures):
            self.assertAlmostEqual(other["value"] / one["value"], 1.0, delta=1e-3)  # likelihoods of single precision

    def test_without_options_are_refused_with_advice(self):
        run = zerorate("accept", self.foreign, "--limits", self.limits)
        self.assertEqual(run.returncode, BAD_DATA)
        self.assertIn("--columns", run.stderr)

    def test_are_those_of_a_fleet_whose_alarm_names_what_is_broken(self):
        (self.fleet / "two.csv").write_text("stamp,wx,wy,wz\nnonsense\n", encoding="utf-8")
        for alarm, code in (((), PASS), (("--alarm",), FAIL)):
            run = zerorate("fleet", "run", self.fleet, "--db", self.database, *FORMAT, *alarm)
            self.assertEqual(run.returncode, code, run.stderr)
            self.assertIn("two.csv", run.stdout)
            self.assertNotIn("one.csv", run.stdout)


if __name__ == "__main__":
    unittest.main()
