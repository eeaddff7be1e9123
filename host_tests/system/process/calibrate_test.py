#!/usr/bin/env python3
"""zerorate calibrate turns as a process: recordings, and a node on a socket.

usage: calibrate_test.py ZERORATE [unittest arguments]
"""

import json
import math
import pathlib
import random
import socket
import struct
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest
import zlib

ZERORATE = sys.argv.pop(1)
LIMIT_S = 60.0


def recording(rounds, seed=1):
    """Ten turns there and back at 25 Hz between rests of 15 s, measured as so many rounds."""
    noise, lines = random.Random(seed), ["t_s,gx_dps,gy_dps,gz_dps"]
    rates = [0.0] * 375
    for sense in (1, -1):
        rates += [sense * rounds * 36.0 / 2.0 * math.sin(math.pi * k / 50) ** 2 for k in range(1000)] + [0.0] * 375
    for k, rate in enumerate(rates):
        x, y, z = (noise.gauss(0.0, 0.013) for _ in range(3))
        lines.append(f"{k * 0.04:.2f},{x - 0.2:.5f},{y + 0.1:.5f},{z + rate + 0.3:.5f}")
    return "\n".join(lines) + "\n"


def frame(number, is_still, turn_rad, turn_s):
    """By docs/reference/rate-frame.md, 20 a second."""
    axis = struct.pack("<4f", 0.0, 0.0, 0.0, 3e-5)
    turns = struct.pack("<6fq", 0.0, 0.5, 0.0, 0.5, turn_rad, 0.5, int(turn_s * 1e9))
    body = (struct.pack("<2sBBIqBBH", b"ZR", 3, 3, number, 50_000_000 * number, 2 if is_still else 0, 1, 0) + 3 * axis +
            struct.pack("<fI", 25.0, 7) + turns)
    return body + struct.pack("<I", zlib.crc32(body))


def frames(rounds):
    number = 0
    for turns, length_s in ((0.0, 12.0), (rounds, 30.0), (0.0, 12.0), (-rounds, 30.0), (0.0, 12.0)):
        if turns != 0.0:
            last = turns
        for k in range(1, int(length_s * 20) + 1):
            number += 1
            share = k / (length_s * 20) if turns else 1.0
            moved = turns or number > 300
            yield frame(number, not turns, 2 * math.pi * last * share if moved else 0.0, 30.0 * share if moved else 0.0)


class Calibrate(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        self.folder = pathlib.Path(self._folder.name)

    def tearDown(self):
        self._folder.cleanup()

    def run_on(self, rounds, *arguments):
        (self.folder / "turns.csv").write_text(recording(rounds), encoding="utf-8")
        return subprocess.run([ZERORATE, "calibrate", "turns", "turns.csv", *arguments], cwd=self.folder,
                              capture_output=True, text=True, timeout=LIMIT_S, check=False)

    def test_finds_the_scale_factor_of_a_recording_and_writes_a_model(self):
        done = self.run_on(10.06, "--model", "lsm6dso", "--model-out", "mine.toml", "--summary", "turns.json")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("scale factor error of axis z: +0.6", done.stdout)
        figures = json.loads((self.folder / "turns.json").read_text(encoding="utf-8"))
        self.assertAlmostEqual(figures["scale_factor"]["percent"], 0.6, delta=0.03)
        written = tomllib.loads((self.folder / "mine.toml").read_text(encoding="utf-8"))
        self.assertAlmostEqual(written["scale_factor"]["sigma_percent"], 0.604, delta=0.03)
        checked = subprocess.run([ZERORATE, "model", "check", self.folder / "mine.toml"], capture_output=True, text=True,
                                 timeout=LIMIT_S, check=False)
        self.assertEqual((checked.returncode, checked.stderr), (0, ""))

    def test_refuses_a_wrong_count_and_writes_no_model(self):
        done = self.run_on(9.02, "--model", "lsm6dso", "--model-out", "mine.toml")
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertIn("9.02 turns are nearer to 9 than to 10", done.stderr)
        self.assertFalse((self.folder / "mine.toml").exists())

    def test_ends_with_a_finding_where_the_tolerance_is_contradicted(self):
        done = self.run_on(10.3)
        self.assertEqual((done.returncode, done.stderr), (1, ""))
        self.assertIn("contradicts the tolerance of 1 %", done.stdout)

    def test_wants_the_model_that_it_is_to_write_into(self):
        done = self.run_on(10.0, "--model-out", "mine.toml")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--model-out: give --model, too", done.stderr)

    def test_follows_a_node_that_runs_and_ends_by_itself(self):
        path = self.folder / "rate.sock"
        with subprocess.Popen([ZERORATE, "calibrate", "turns", "--unix", path, "--summary", "-"],
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            deadline = time.monotonic() + LIMIT_S
            while not path.exists() and time.monotonic() < deadline:
                time.sleep(0.01)
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
                sender.settimeout(LIMIT_S)
                for datagram in frames(10.05):
                    try:
                        sender.sendto(datagram, str(path))
                    except (FileNotFoundError, ConnectionRefusedError):
                        break  # it is done
            out, errors = process.communicate(timeout=LIMIT_S)
        self.assertEqual((process.returncode, errors), (0, ""))
        self.assertAlmostEqual(json.loads(out)["scale_factor"]["percent"], 0.5, delta=0.001)
        self.assertFalse(path.exists())


if __name__ == "__main__":
    unittest.main()
