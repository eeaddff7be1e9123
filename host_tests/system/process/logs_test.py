#!/usr/bin/env python3
"""Logs of other programs: the commands of docs/reference/recording-format.md, typed as they stand there, read files that are
made like those of each program. The rates of every one are the same; so are those of what is written.

usage: logs_test.py REPOSITORY ZERORATE [unittest arguments]
"""

import csv
import gzip
import math
import pathlib
import random
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

REPOSITORY = pathlib.Path(sys.argv.pop(1))
ZERORATE = sys.argv.pop(1)
PAGE = REPOSITORY / "docs/reference/recording-format.md"
RANDOM = random.Random(44)
ROWS = 6000
PERIOD_US = 10_000
EPOCH_S = 1_700_000_000
RATES_DPS = [[bias + RANDOM.gauss(0.0, 2.0) for bias in (1.3, -2.2, 0.7)] for _ in range(ROWS)]
RATES_RADPS = [[math.radians(rate) for rate in rates] for rates in RATES_DPS]


def text(numbers):
    return [f"{number:.9f}" for number in numbers]


def echo(k):
    stamp = EPOCH_S * 10**9 + k * PERIOD_US * 1000
    return [str(stamp // 10**9), str(stamp % 10**9), *["0.0"] * 5, *text(RATES_RADPS[k])]


def whole(rates):
    return [str(round(rate)) for rate in rates]


def table(header, row, before=()):
    return "\n".join([*before, header, *(",".join(row(k)) for k in range(ROWS))]) + "\n"


FILES = {
    "imu.csv": "\n".join(",".join(echo(k)) for k in range(ROWS)) + "\n",
    "explorer.csv": table('"loopIteration","time","gyroADC[0]","gyroADC[1]","gyroADC[2]"',
                          lambda k: [str(8 * k), str(PERIOD_US * k), *whole(RATES_DPS[k])],
                          ['"Product","flight data recorder"', '"looptime","125"']),
    "recorder.csv": table("time,gyro[0],gyro[1],gyro[2]", lambda k: [str(PERIOD_US * k), *text(RATES_DPS[k])],
                          ["a", "b,2", "c", "d"]),
    "imus.csv": table("TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ",
                      lambda k: [str(PERIOD_US * (k // 2)), str(k % 2),
                                 *(text(RATES_RADPS[k // 2]) if k % 2 == 0 else ["9", "9", "9"]), "0", "0", "-9.8"]),
    "flight_sensor_gyro_0.csv": table("timestamp,timestamp_sample,device_id,x,y,z,temperature,error_count",
                                      lambda k: [str(PERIOD_US * k), str(PERIOD_US * k), "7", *text(RATES_RADPS[k]), "31", "0"]),
    "run.csv": table("stamp,wx,wy,wz", lambda k: [str((EPOCH_S * 10**6 + PERIOD_US * k) * 1000), *text(RATES_RADPS[k])]),
}


def make_kitti(folder):
    (folder / "oxts/data").mkdir(parents=True)
    stamps = []
    for k in range(ROWS // 20):
        seconds = k * PERIOD_US / 1e6
        stamps.append(f"2011-09-26 13:{int(seconds // 60):02d}:{seconds % 60:012.9f}")
        numbers = ["0"] * 11 + ["0", "0", "9.8"] + ["0"] * 3 + text(RATES_RADPS[k]) + ["0"] * 10
        (folder / f"oxts/data/{k:010d}.txt").write_text(" ".join(numbers) + "\n", encoding="ascii")
    (folder / "oxts/timestamps.txt").write_text("\n".join(stamps) + "\n", encoding="ascii")


def commands():
    """The commands of the section that are zerorate's and that bring no bag."""
    section = PAGE.read_text(encoding="utf-8").partition("### Logs of other programs")[2].partition("\n## ")[0]
    code = re.sub(r"\\\n\s*", "", section)
    return [line.strip() for line in code.splitlines() if line.startswith("    zerorate ") and "run_db3" not in line]


class CommandsOfThePage(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name, content in FILES.items():
            (self.folder / name).write_text(content, encoding="utf-8")
        make_kitti(self.folder / "2011_09_26_drive_0001_sync")

    def run_zerorate(self, *arguments):
        run = subprocess.run([ZERORATE, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=120, check=False)
        self.assertIn(run.returncode, (0, 1), run.stderr)
        return run.stdout

    def rates_dps(self, name):
        with gzip.open(self.folder / name, "rt", encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                yield [float(row[f"g{axis}_dps"]) if f"g{axis}_dps" in row else math.degrees(float(row[f"g{axis}_radps"]))
                       for axis in "xyz"]

    def test_read_the_rates_that_were_measured(self):
        typed = [shlex.split(command)[1:] for command in commands()]
        self.assertEqual(len([words for words in typed if words[0] == "convert"]), 6)
        for words in typed:
            output = self.run_zerorate(*words)
            if words[0] != "convert":
                continue
            with self.subTest(words[1], output=output):
                read = list(self.rates_dps(words[-1]))
                rows = {"imus.csv": ROWS // 2, "2011_09_26_drive_0001_sync": ROWS // 20}.get(words[1], ROWS)
                self.assertEqual(len(read), rows)
                for found, measured in zip(read, RATES_DPS):
                    for axis in range(3):
                        self.assertAlmostEqual(found[axis], measured[axis], delta=1e-5)

    def test_accept_whole_degrees_of_a_flight_recorder(self):
        refused = subprocess.run([ZERORATE, "characterize", "explorer.csv"], cwd=self.folder, capture_output=True, text=True,
                                 timeout=120, check=False)
        self.assertEqual(refused.returncode, 3)
        self.assertIn("--accept counts", refused.stderr)
        output = self.run_zerorate("characterize", "explorer.csv", "--accept", "counts")
        self.assertIn("read as a recording of Blackbox", output)
        # Rounding to 1 deg/s adds its 12th to the variance of 4: N is 1 % larger than 2 deg/s over the root of 100 Hz.
        found = [float(value) for value in re.findall(r"angle random walk N\s+([0-9.]+)", output)]
        self.assertEqual(len(found), 3)
        for value in found:
            self.assertAlmostEqual(value, 0.2 * math.sqrt(1 + 1 / 48), delta=4 * 0.2 / math.sqrt(2 * ROWS))


if __name__ == "__main__":
    unittest.main()
