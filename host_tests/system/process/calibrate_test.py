#!/usr/bin/env python3
"""zerorate calibrate turns as a process: recordings, and a node on a socket.

usage: calibrate_test.py ZERORATE [unittest arguments]
"""

import json
import math
import os
import pathlib
import pty
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import termios
import time
import tomllib
import unittest
import zlib

ZERORATE = sys.argv.pop(1)
PAGE = pathlib.Path(__file__).resolve().parents[3] / "docs/reference/calibrate-turns-json.md"
LIMIT_S = 60.0
CONFIGURATION = """schema = "zerorate.daemon/1"
[real_time]
lock_memory = false
[gyro]
chip = "simulated"
time_factor = 20
[model]
file = "{model}"
"""


def keys_of(value, path=""):
    """Paths of all keys, those of a list's elements together."""
    if isinstance(value, list):
        return set().union(*(keys_of(element, path) for element in value))
    if not isinstance(value, dict):
        return set()
    return {f"{path}.{key}" for key in value}.union(*(keys_of(one, f"{path}.{key}") for key, one in value.items()))


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
        self.assertAlmostEqual(written["scale_factor"]["error_percent"][2], 0.6, delta=0.03)
        self.assertEqual(written["scale_factor"]["error_percent"][:2], [0, 0])
        # The stop at the mark by 2 deg, and a drift of 0.2 %.
        self.assertAlmostEqual(written["scale_factor"]["sigma_percent"], math.hypot(0.068, 0.2), delta=0.003)
        checked = subprocess.run([ZERORATE, "model", "check", self.folder / "mine.toml"], capture_output=True, text=True,
                                 timeout=LIMIT_S, check=False)
        self.assertEqual((checked.returncode, checked.stderr), (0, ""))

    def test_with_the_written_model_finds_nothing_more(self):
        self.assertEqual(self.run_on(10.06, "--model", "lsm6dso", "--model-out", "mine.toml").returncode, 0)
        done = self.run_on(10.06, "--model", "mine.toml", "--model-out", "again.toml", "--summary", "turns.json")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("takes +0.6", done.stdout)
        figures = json.loads((self.folder / "turns.json").read_text(encoding="utf-8"))
        self.assertAlmostEqual(figures["scale_factor"]["percent"], 0.0, delta=0.001)
        first, second = (tomllib.loads((self.folder / name).read_text(encoding="utf-8"))["scale_factor"]["error_percent"]
                         for name in ("mine.toml", "again.toml"))
        self.assertAlmostEqual(first[2], second[2], delta=0.001)

    def test_summary_has_the_keys_of_its_page(self):
        self.run_on(10.06, "--model", "lsm6dso", "--summary", "turns.json")
        figures = json.loads((self.folder / "turns.json").read_text(encoding="utf-8"))
        page = PAGE.read_text(encoding="utf-8")
        shown = json.loads(re.search(r"^```json\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)[1])
        self.assertEqual(keys_of(figures), keys_of(shown))
        explained = set(re.findall(r"`(\w+)`", page))
        self.assertLessEqual({key.rpartition(".")[2] for key in keys_of(figures)}, explained)

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

    def test_follows_a_pico_on_its_serial_line(self):
        line, device = pty.openpty()
        os.set_blocking(line, False)
        try:
            with subprocess.Popen([ZERORATE, "calibrate", "turns", "--serial", os.ttyname(device), "--summary", "-"],
                                  stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  text=True) as process:
                deadline = time.monotonic() + LIMIT_S
                while termios.tcgetattr(device)[3] & termios.ICANON and time.monotonic() < deadline:
                    time.sleep(0.01)  # until it reads raw bytes
                for one in frames(9.95):
                    blocks = (one + b"\0").split(b"\0")[:-1]  # stuffed, the plain way
                    left = b"".join(bytes([len(block) + 1]) + block for block in blocks) + b"\0"
                    while left and process.poll() is None and time.monotonic() < deadline:
                        try:
                            left = left[os.write(line, left):]
                        except BlockingIOError:
                            time.sleep(0.001)  # it reads more slowly
                out, errors = process.communicate(timeout=LIMIT_S)
        finally:
            os.close(line)
            os.close(device)
        self.assertEqual((process.returncode, errors), (0, ""))
        figures = json.loads(out)
        self.assertAlmostEqual(figures["scale_factor"]["percent"], -0.5, delta=0.001)
        self.assertIsNone(figures["taken_off_percent"])
        self.assertIn("the model of the node is not known here", figures["notes"][0])

    def test_reads_the_chip_of_a_configuration(self):
        # The simulated vehicle rests and drives bends, but never turns around.
        self.assertEqual(self.run_on(10.06, "--model", "lsm6dso", "--model-out", "mine.toml").returncode, 0)
        model = (self.folder / "mine.toml").read_text(encoding="utf-8")
        (self.folder / "mine.toml").write_text(re.sub(r"error_percent = .*", "error_percent = [1.5, 0, 0]", model),
                                               encoding="utf-8")
        file = self.folder / "zerorated.toml"
        file.write_text(CONFIGURATION.format(model=self.folder / "mine.toml"), encoding="utf-8")
        with subprocess.Popen([ZERORATE, "calibrate", "turns", "--config", file, "--summary", "turns.json"],
                              cwd=self.folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as process:
            time.sleep(6.0)  # two minutes by its clock
            process.send_signal(signal.SIGINT)
            out, errors = process.communicate(timeout=LIMIT_S)
        self.assertEqual((process.returncode, out), (3, ""))
        self.assertIn("no turn was seen; turn it at least once around after it stood still", errors)
        figures = json.loads((self.folder / "turns.json").read_text(encoding="utf-8"))
        self.assertAlmostEqual(figures["taken_off_percent"], 1.5)
        self.assertLess(figures["tolerance_percent"], 0.3, "that of the model of the configuration")


if __name__ == "__main__":
    unittest.main()
