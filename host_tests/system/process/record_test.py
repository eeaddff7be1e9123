#!/usr/bin/env python3
"""zerorate record as a process, and the way from a chip to a model as its page tells it, on the simulated chip.

usage: record_test.py ZERORATE ZERORATED [unittest arguments]
"""

import gzip
import json
import os
import pathlib
import pty
import re
import resource
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import termios
import time
import unittest

ZERORATE, ZERORATED = sys.argv.pop(1), sys.argv.pop(1)
REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
HOW_TO = REPOSITORY / "docs/how-to/from-chip-to-model.md"
LIMIT_S = 60.0
RATE_HZ = 104
PERIOD_S = 0.0096  # of the LSM6DSO at nominally 104 Hz

CONFIGURATION = """schema = "zerorate.daemon/1"
[real_time]
lock_memory = false
[gyro]
chip = "simulated"
time_factor = {factor}
drives = {drives}
"""


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def rows_of(path):
    """Names and rows of a recording; the first line is its comment."""
    text = (gzip.open(path, "rt") if path.suffix == ".gz" else open(path)).read()
    comment, header, *lines = text.splitlines()
    assert comment.startswith("# zerorate record, from "), comment
    return header.split(","), [[float(field) for field in line.split(",")] for line in lines]


class Folder(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        self.folder = pathlib.Path(self._folder.name)
        self.recording = self.folder / "rest.csv.gz"
        self.processes = []

    def tearDown(self):
        for process in self.processes:
            if process.poll() is None:
                process.kill()
            process.communicate()
        self._folder.cleanup()

    def start_node(self, sinks, factor=1, drives=True):
        """zerorated on the simulated chip."""
        file = self.folder / "zerorated.toml"
        file.write_text(CONFIGURATION.format(factor=factor, drives=str(drives).lower()) + sinks)
        node = subprocess.Popen([ZERORATED, "--config", file], stderr=subprocess.PIPE, text=True)
        self.processes.append(node)
        return node

    def record(self, *arguments, **keywords):
        return subprocess.Popen([ZERORATE, "record", "-o", self.recording, *map(str, arguments)], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, **keywords)

    def end(self, process, code=0):
        out, errors = process.communicate(timeout=LIMIT_S)
        self.assertEqual(process.returncode, code, out + errors)
        return out, errors

    def check_simulated(self, least_rows, path=None):
        header, rows = rows_of(path or self.recording)
        self.assertEqual(header, ["t_s", "gx_dps", "gy_dps", "gz_dps", "temp_c", "odometer_pulses"])
        self.assertGreaterEqual(len(rows), least_rows)
        for before, after in zip(rows, rows[1:]):
            self.assertAlmostEqual(after[0] - before[0], PERIOD_S, delta=2e-6)
        self.assertAlmostEqual(sum(row[1] for row in rows) / len(rows), 0.35, delta=0.1)
        self.assertTrue(all(25.0 <= row[4] <= 29.5 for row in rows), rows[0])
        return rows


class Recording(Folder):
    def test_of_datagrams_is_what_the_node_says_in_json(self):
        port, lines = free_port(), self.folder / "rate.jsonl"
        recorder = self.record("--udp", port, "--duration", "4s", "--summary", self.folder / "summary.json")
        time.sleep(0.5)
        self.start_node(f'[[sink]]\ntype = "udp"\naddress = "127.0.0.1"\nport = {port}\n'
                        f'[[sink]]\ntype = "json"\nfile = "{lines}"\n')
        out, errors = self.end(recorder)
        self.assertNotIn("\r", errors, "no progress where the error stream is no terminal")
        rows = self.check_simulated(4 * RATE_HZ)
        self.assertRegex(out, r"rest\.csv\.gz: 4\.0 s in \d+ rows; 0 messages lost, 0 without a rate, 0 pauses\n")
        said = [message for message in map(json.loads, lines.read_text().splitlines())
                if message["rate_dps"][0] is not None]
        self.assertLess(abs(rows[0][0] - time.time()), LIMIT_S, "seconds since 1970")
        for row, message in zip(rows, said):
            self.assertAlmostEqual(row[0] - rows[0][0], (message["time_ns"] - said[0]["time_ns"]) * 1e-9, delta=2e-6)
            for value, expected in zip(row[1:4], message["measured_dps"]):
                self.assertAlmostEqual(value, expected, delta=1e-6)
            self.assertAlmostEqual(row[4], message["temperature_c"], delta=1e-5)
            self.assertEqual(row[5], message["odometer_pulses"])
        summary = json.loads((self.folder / "summary.json").read_text())
        self.assertEqual((summary["schema"], summary["rows"], summary["lost"]), ("zerorate.record/1", len(rows), 0))

    def test_of_a_unix_socket(self):
        path = self.folder / "rate.sock"
        recorder = self.record("--unix", path, "--duration", "2s")
        time.sleep(0.5)
        self.start_node(f'[[sink]]\ntype = "unix"\npath = "{path}"\n')
        out, errors = recorder.communicate(timeout=LIMIT_S)
        # Linux queues ten datagrams on a Unix socket, 0.1 s of samples: a busy machine loses some, and they are counted.
        lost = int(re.search(r"(\d+) messages lost", out)[1])
        self.assertEqual(recorder.returncode, 1 if lost else 0, out + errors)
        times = [row[0] for row in rows_of(self.recording)[1]]
        steps = [(after - before) / PERIOD_S for before, after in zip(times, times[1:])]
        self.assertEqual(sum(round(step) - 1 for step in steps), lost)
        self.assertTrue(all(abs(step - round(step)) < 2e-6 / PERIOD_S for step in steps), steps)
        self.assertGreaterEqual(len(times) + lost, 2 * RATE_HZ)
        self.assertFalse(path.exists())

    def test_of_json_lines(self):
        lines = self.folder / "rate.jsonl"
        node = self.start_node(f'[[sink]]\ntype = "json"\nfile = "{lines}"\n', factor=20)
        time.sleep(1.5)
        node.terminate()
        node.communicate(timeout=LIMIT_S)
        self.end(self.record("--json", lines))
        self.check_simulated(10 * RATE_HZ)

    def test_of_a_serial_line(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as frames:
            frames.bind(("127.0.0.1", 0))
            frames.settimeout(LIMIT_S)
            line, device = pty.openpty()
            try:
                recorder = self.record("--serial", os.ttyname(device), "--duration", "2s")
                deadline = time.monotonic() + LIMIT_S
                while termios.tcgetattr(device)[3] & termios.ICANON and time.monotonic() < deadline:
                    time.sleep(0.01)  # until it reads raw bytes
                self.start_node('[[sink]]\ntype = "udp"\naddress = "127.0.0.1"\n'
                                f'port = {frames.getsockname()[1]}\n')
                while recorder.poll() is None:
                    frame = frames.recv(256)
                    if frame.startswith(b"ZR"):
                        blocks = (frame + b"\0").split(b"\0")[:-1]  # stuffed, the plain way
                        os.write(line, b"".join(bytes([len(block) + 1]) + block for block in blocks) + b"\0")
                self.end(recorder, code=0)
            finally:
                os.close(line)
                os.close(device)
        self.check_simulated(2 * RATE_HZ)

    def test_of_the_chip_itself(self):
        self.end(self.record("--chip", "simulated", "--duration", "2s"))
        self.check_simulated(2 * RATE_HZ)

    def test_of_the_chip_of_a_configuration_that_no_node_reads(self):
        file = self.folder / "zerorated.toml"
        state = f'[state]\nfile = "{self.folder}/state"\n'
        file.write_text(CONFIGURATION.format(factor=20, drives="true") + state)
        self.end(self.record("--config", file, "--duration", "100s"))
        rows = self.check_simulated(100 * RATE_HZ)
        self.assertGreater(rows[-1][5], 300, "it drove, ten pulses a second")
        self.start_node(state)
        time.sleep(1.0)
        self.recording = self.folder / "other.csv"
        _, errors = self.end(self.record("--config", file, "--duration", "2s"), code=3)
        self.assertIn("state", errors)
        self.assertFalse(self.recording.exists())

    def test_goes_on_after_being_killed(self):
        # Killed between two parts, and once more within what becomes the third.
        first = self.record("--chip", "simulated")
        time.sleep(14)
        first.kill()
        first.communicate()
        kept = len(rows_of(self.recording)[1])
        self.assertGreaterEqual(kept, 9 * RATE_HZ)
        with self.recording.open("ab") as file:
            file.write(b"\x1f\x8b\x08\x00torn")
        out, errors = self.end(self.record("--chip", "simulated", "--duration", "15s", "--resume"))
        self.assertIn("cut off 8 bytes of an unfinished part", errors)
        header, rows = rows_of(self.recording)
        self.assertGreaterEqual(len(rows), 15 * RATE_HZ)
        self.assertLess(len(rows), 17 * RATE_HZ)
        self.assertIn(": 15.0 s in ", out)
        self.assertGreater(rows[kept][0] - rows[kept - 1][0], 1.0, "the pause")
        self.assertEqual(rows[kept][5], rows[kept - 1][5] + 1, "it may have moved meanwhile")
        self.assertEqual(rows, sorted(rows))

    def test_ends_at_sigint_with_all_that_came(self):
        recorder = self.record("--chip", "simulated")
        time.sleep(4)
        recorder.send_signal(signal.SIGINT)
        self.end(recorder)
        self.check_simulated(2 * RATE_HZ)

    def test_tells_a_full_disk_and_keeps_what_is_there(self):
        self.end(self.record("--chip", "simulated", "--duration", "2s"))
        kept = self.recording.read_bytes()
        recorder = self.record("--chip", "simulated", "--duration", "4s", "--resume", preexec_fn=lambda: (
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN),
            resource.setrlimit(resource.RLIMIT_FSIZE, (len(kept) + 100, len(kept) + 100))))
        _, errors = self.end(recorder, code=3)
        self.assertIn("cannot write the file (File too large)", errors)
        self.assertEqual(self.recording.read_bytes(), kept)

    def test_shows_how_far_it_is_on_a_terminal(self):
        terminal, screen = pty.openpty()
        recorder = subprocess.Popen([ZERORATE, "record", "-o", self.recording, "--chip", "simulated", "--duration",
                                     "3s"], stdout=subprocess.DEVNULL, stderr=screen)
        os.close(screen)
        shown = b""
        try:
            while chunk := os.read(terminal, 65536):
                shown += chunk
        except OSError:  # the other end was closed
            pass
        os.close(terminal)
        self.assertEqual(recorder.wait(timeout=LIMIT_S), 0)
        self.assertRegex(shown.decode(), r"recording \[#+\.+\] +\d+ %")

    def test_says_what_was_lost(self):
        lines = self.folder / "rate.jsonl"
        node = self.start_node(f'[[sink]]\ntype = "json"\nfile = "{lines}"\n', factor=20)
        time.sleep(1.0)
        node.terminate()
        node.communicate(timeout=LIMIT_S)
        kept = lines.read_text().splitlines(keepends=True)
        with subprocess.Popen(["sh", "-c", "cat; sleep 1.5"], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as slow:
            recorder = self.record("--json", "-", stdin=slow.stdout)
            slow.stdin.write("".join(kept[:400] + kept[407:]).encode() + b"no message\n")
            slow.stdin.close()
            out, errors = self.end(recorder, code=1)
        self.assertIn("7 messages lost", out)
        self.assertIn("zerorate: 7 messages lost, 7 in all\n", errors)
        self.assertIn("zerorate: 1 damaged frames or lines, 1 in all\n", errors)

    def test_refuses_what_it_cannot_do(self):
        self.recording.write_text("mine")
        for arguments, code, words in [
                (["--chip", "simulated", "--duration", "3s"], 3, "--resume"),
                (["--chip", "simulated", "--duration", "3s", "--resume"], 3, "no whole part of a recording"),
                (["--chip", "icm4268", "--i2c", "no-i2c"], 3, 'did you mean "icm42688"'),
                (["--chip", "lsm6dso", "--i2c", "no-i2c"], 3, "rate_hz"),
                (["--chip", "lsm6dso", "--udp", "4"], 2, "excludes"),
                (["--i2c", "no-i2c"], 2, "--chip"),
                (["--hours", "1", "--duration", "3s"], 2, "excludes"),
                (["--duration", "3days"], 2, "--duration"),
                (["--duration", "-3s"], 2, "--duration"),
                (["--serial", "no-line"], 3, "no-line")]:
            _, errors = self.end(self.record(*arguments), code)
            self.assertIn(words, errors)
            self.assertEqual(self.recording.read_text(), "mine")

    def test_says_that_the_chip_is_not_there(self):
        recorder = self.record("--chip", "lsm6dso", "--i2c", self.folder / "no-i2c", "--rate", 104, "--full-scale", 250)
        time.sleep(3)
        recorder.terminate()
        _, errors = self.end(recorder, code=1)
        self.assertIn("no-i2c: No such file or directory (is the bus enabled, and its name right? zerorate probe)", errors)
        self.assertIn("messages without a rate", errors)
        self.assertFalse(self.recording.exists())


class HowTo(Folder):
    """Every command of the page in its order, as one after the other would type them."""

    def setUp(self):
        super().setUp()
        self.board = self.folder / "board"
        self.pc = self.folder / "pc"
        self.etc = self.board / "etc"
        for folder in (self.etc, self.pc):
            folder.mkdir(parents=True)
        self.port = str(free_port())
        self.node = None

    def commands(self):
        """Place and words of each; and pieces of configuration, with None for a place."""
        text, piece = HOW_TO.read_text(), []
        for line in text.splitlines():
            command = re.fullmatch(r"    ([$>]) (.+)", line)
            if piece and not line.startswith("    ") or command:
                if piece:
                    yield None, "\n".join(piece) + "\n"
                piece = []
            if command:
                yield command[1], shlex.split(command[2])
            elif line.startswith("    "):
                piece.append(line.removeprefix("    "))
        if piece:
            yield None, "\n".join(piece) + "\n"

    def configure(self, more=""):
        """The configuration of the page's last section, for a port that is free."""
        *_, (_, configuration) = [piece for piece in self.commands() if piece[0] is None]
        file = self.etc / "zerorated.toml"
        file.write_text(configuration.replace("24680", self.port).replace("[gyro]", "[real_time]\nlock_memory = false\n"
                                                                          "[gyro]") + more.replace("/etc/zerorate",
                                                                                                    str(self.etc)))

    def run_program(self, place, words):
        """The program under test in the place of an installed one, on less data than the page asks for."""
        stand_ins = {"zerorate": [ZERORATE], "zerorated": [ZERORATED, "--config", str(self.etc / "zerorated.toml")]}
        words = stand_ins[words[0]] + words[1:]
        text = " ".join(words)
        if " monitor " in text or " record " in text:
            words += ["--udp", self.port]
        if " probe" in text:
            words += ["--spi", str(self.folder / "no-spidev")]
        for long, short in (("3", "0.1"), ("30min", "60s")):
            if long in words and words[words.index(long) - 1] in ("--hours", "--duration"):
                words[words.index(long)] = short
        codes = {"characterize": (0, 1), "diagnose": (0, 1), "probe": (1,)}  # a finding is no failure
        run = subprocess.run(words, cwd=self.board if place == "$" else self.pc, capture_output=True, text=True,
                             timeout=10 * LIMIT_S, check=False)
        self.assertIn(run.returncode, codes.get(words[1], (0,)), f"{text}\n{run.stdout}{run.stderr}")
        return run.stdout

    def copy(self, source, target):
        """scp between the two folders."""
        here = {True: self.board, False: self.pc}
        source_folder, target_folder = here[source.startswith("pi:")], here[target.startswith("pi:")]
        name = pathlib.Path(source.removeprefix("pi:")).name
        shutil.copy(source_folder / name, target_folder / name)

    def obey(self, place, words):
        """One command of the page; what only an installed system has is played."""
        if words[0] == "sudo":
            words = words[1:]
        if words[:2] == ["apt-get", "install"]:
            return ""  # host_tests/emulated/linux/clean_root.sh installs the package
        if words[0] == "scp":
            return self.copy(*words[1:])
        if words[0] == "install":
            shutil.copy(self.board / words[-2], self.etc / pathlib.Path(words[-1]).name)
            return ""
        if words == ["systemctl", "enable", "--now", "zerorated"]:
            self.node = subprocess.Popen([ZERORATED, "--config", self.etc / "zerorated.toml"], stderr=subprocess.PIPE,
                                         text=True)
            self.processes.append(self.node)
            return ""
        if words == ["systemctl", "reload", "zerorated"]:
            self.node.send_signal(signal.SIGHUP)
            time.sleep(1.0)
            return ""
        self.assertIn(words[0], ("zerorate", "zerorated"), "a command that the test does not know")
        return self.run_program(place, words)

    def test_leads_from_the_chip_to_a_node_with_its_model(self):
        self.configure()
        said = {}
        for place, words in self.commands():
            if place is None:
                if words.startswith("[model]"):
                    self.configure(words)
                continue
            said[" ".join(words[:3])] = self.obey(place, words)
        self.assertEqual(said["zerorated --check-config"], f"{self.etc}/zerorated.toml: valid\n")
        self.assertIn("the one with the median slow noise", said["zerorate characterize rest.csv.gz"])
        self.assertIn("kalman", said["zerorate replay rest.csv.gz"])
        self.assertRegex(said["zerorate monitor --count"], r" fine\n")
        for name in ("rest.csv.gz", "rest.html", "mine.toml", "why.html", "extended-z.toml", "drive.csv.gz"):
            self.assertTrue((self.pc / name).exists(), name)
        self.check_simulated(360 * RATE_HZ, self.pc / "rest.csv.gz")
        self.node.terminate()
        errors = self.node.communicate(timeout=LIMIT_S)[1]
        self.assertIn(f"model {self.etc}/mine.toml", errors)
        self.assertEqual(self.node.returncode, 0, errors)


if __name__ == "__main__":
    unittest.main()
