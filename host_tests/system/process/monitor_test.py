#!/usr/bin/env python3
"""zerorate monitor and probe as processes: on datagrams, pipes and pseudo-terminals.

usage: monitor_test.py ZERORATE [unittest arguments]
"""

import json
import math
import os
import pathlib
import pty
import select
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
LIMIT_S = 20.0
CALIBRATED, SENSOR_FAULT = 0x01, 0x40


def sealed(body):
    return body + struct.pack("<I", zlib.crc32(body))


def rate_frame(sequence, rate_rad_s=0.01, health=CALIBRATED):
    """By docs/reference/rate-frame.md."""
    axis = struct.pack("<4f", rate_rad_s + 0.02, rate_rad_s, 0.02, 1e-5)
    return sealed(struct.pack("<2sBBIqBBH", b"ZR", 3, 3, sequence, 10**9 * sequence, 2, health, 0) + 3 * axis +
                  struct.pack("<fI6fq", 25.0, 7, *3 * (0.5, 0.01), 10**9))


def status_frame(samples):
    return sealed(struct.pack("<2sBB11I4B", b"ZS", 1, 0, samples, *range(1, 11), 0, 0, 0, 0))


def learnt_frame(stops, instability_dph=(10.0, 30.0, 20.0)):
    dps = math.pi / 180
    axes = [struct.pack("<6f", 0.6, 0.08, b * dps / 3600, dps / 3600, 0.005 * dps, 1e-4 * dps) for b in instability_dph]
    return sealed(struct.pack("<2sBBf", b"ZL", 1, 0, stops) + b"".join(axes))


def stuffed(frame):
    """Consistent overhead byte stuffing of less than 254 bytes, the plain way."""
    out = b""
    for block in (frame + b"\0").split(b"\0")[:-1]:
        out += bytes([len(block) + 1]) + block
    return out + b"\0"


class Monitor(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        self.folder = pathlib.Path(self._folder.name)
        self.process = None

    def tearDown(self):
        if self.process and self.process.poll() is None:
            self.process.kill()
            self.process.communicate()
        self._folder.cleanup()

    def start(self, *arguments, stdout=subprocess.PIPE):
        self.process = subprocess.Popen([ZERORATE, "monitor", *map(str, arguments)], stdin=subprocess.DEVNULL,
                                        stdout=stdout, stderr=subprocess.PIPE, text=stdout == subprocess.PIPE)

    def end(self, code=0):
        out, errors = self.process.communicate(timeout=LIMIT_S)
        self.assertEqual((self.process.returncode, errors or ""), (code, ""))
        return out

    def send_until_it_ends(self, send):
        """Messages with rising numbers: nobody can know when the receiver is ready."""
        deadline, number = time.monotonic() + LIMIT_S, 0
        while self.process.poll() is None and time.monotonic() < deadline:
            send(number)
            number += 1
            time.sleep(0.01)

    def test_shows_datagrams_of_udp_a_line_each_interval(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.start("--udp", f"127.0.0.1:{port}", "--count", 40, "--interval", 0.1)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            self.send_until_it_ends(lambda number: sender.sendto(rate_frame(number), ("127.0.0.1", port)))
        lines = self.end().splitlines()
        self.assertIn("rate x, y, z deg/s", lines[0])
        self.assertGreaterEqual(len(lines), 3)
        self.assertNotIn("\033", "".join(lines))
        for line in lines[1:]:
            self.assertRegex(line, r"^ +\d+\.000 still  ( +\+0\.57296){3}( +\+1\.14592){3}( +4\.04){3}  fine$")

    def test_receives_on_a_unix_socket_which_it_removes(self):
        path = self.folder / "rate.sock"
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as deserted:
            deserted.bind(str(path))  # as a receiver leaves it that was killed
        self.start("--unix", path, "--count", 5)

        def send(number):
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
                try:
                    sender.sendto(rate_frame(number), str(path))
                except (FileNotFoundError, ConnectionRefusedError):
                    pass  # it does not listen yet, or no longer
        self.send_until_it_ends(send)
        self.assertIn("fine", self.end())
        self.assertFalse(path.exists())

    def watch_learnt(self, *arguments, stops=7.5):
        """Runs a monitor for fifty messages of a node that has learnt."""
        path = self.folder / "rate.sock"
        self.start("--unix", path, "--count", 50, *arguments)

        def send(number):
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
                try:
                    for frame in (learnt_frame(stops), rate_frame(number)):
                        sender.sendto(frame, str(path))
                except (FileNotFoundError, ConnectionRefusedError):
                    pass
        self.send_until_it_ends(send)

    def test_shows_what_the_node_has_learnt_and_writes_it_as_a_model(self):
        model = self.folder / "mine.toml"
        self.watch_learnt("--model-out", model)
        out = self.end()
        self.assertRegex(out, r"\nlearnt from 7\.5 stops.*\n.*\n"
                              r"x +0\.600 \+- 0\.080 +10\.0 \+- 1\.0 +0\.00500 \+- 0\.00010\n")
        self.assertIn(f"{model}: the model of axis z, the one with the median slow noise\n", out)
        written = tomllib.loads(model.read_text())
        self.assertEqual(written["schema"], "zerorate.model/2")
        self.assertAlmostEqual(written["flicker"]["bias_instability_dph"], 20.0, places=4)
        self.assertAlmostEqual(written["flicker"]["order"], 0.6, places=6)
        self.assertAlmostEqual(written["white"]["angle_random_walk_dps_per_sqrt_hz"], 0.005, places=8)
        checked = subprocess.run([ZERORATE, "model", "check", model], capture_output=True, text=True, timeout=LIMIT_S,
                                 check=False)
        self.assertEqual((checked.returncode, checked.stderr), (0, ""))

    def test_writes_the_model_into_a_fifo_that_stays_one(self):
        fifo = self.folder / "fifo"
        os.mkfifo(fifo)
        reader = os.open(fifo, os.O_RDONLY | os.O_NONBLOCK)
        self.watch_learnt("--model-out", fifo)
        self.end()
        self.assertIn(b"zerorate.model/2", os.read(reader, 65536))
        os.close(reader)
        self.assertTrue(fifo.is_fifo())

    def test_writes_no_model_while_nothing_is_learnt(self):
        model = self.folder / "mine.toml"
        model.write_text("precious")
        self.watch_learnt("--model-out", model, stops=0.0)
        errors = self.process.communicate(timeout=LIMIT_S)[1]
        self.assertEqual(self.process.returncode, 3)
        self.assertIn(f"{model}: not written: the node has sent no learnt model", errors)
        self.assertEqual(model.read_text(), "precious")

    def refusal(self, *arguments):
        path = self.folder / "rate.sock"
        run = subprocess.run([ZERORATE, "monitor", "--unix", path, *map(str, arguments)], capture_output=True, text=True,
                             timeout=LIMIT_S, check=False)
        self.assertFalse(path.exists())
        return run.returncode, run.stderr

    def test_lets_other_machines_see_its_page_only_where_that_is_meant(self):
        code, errors = self.refusal("--http", "192.0.2.1:0")
        self.assertEqual(code, 2)
        self.assertIn("192.0.2.1", errors)
        self.assertIn("Add --http-remote", errors)
        code, errors = self.refusal("--http", "192.0.2.1:0", "--http-remote")  # an address that no machine has
        self.assertEqual((code, errors), (3, "zerorate: no page at 192.0.2.1, port 0 (port 0 takes one that is free): "
                                             "Cannot assign requested address\n"))

    def test_says_that_the_port_of_its_page_is_taken(self):
        with socket.socket() as other:
            other.bind(("127.0.0.1", 0))
            other.listen()
            port = other.getsockname()[1]
            code, errors = self.refusal("--http", port)
        self.assertEqual((code, errors), (3, f"zerorate: no page at 127.0.0.1, port {port} (port 0 takes one that is "
                                             "free): Address already in use\n"))

    def test_serves_its_page_on_either_loopback(self):
        for address, own in (("[::1]:0", r"http://\[::1\]:\d+/"), ("localhost:0", r"http://localhost:\d+/"),
                             ("0", r"http://127\.0\.0\.1:\d+/")):
            monitor = subprocess.Popen([ZERORATE, "monitor", "--unix", self.folder / "rate.sock", "--http", address],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            self.addCleanup(monitor.stderr.close)
            said = monitor.stderr.readline()
            monitor.terminate()
            monitor.wait(timeout=LIMIT_S)
            if "::" in address and "Cannot assign" in said:
                continue  # a machine without IPv6
            self.assertRegex(said, f"^live page: {own}\n$")

    def test_does_not_take_the_socket_of_another_receiver(self):
        path = self.folder / "rate.sock"
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as other:
            other.bind(str(path))
            self.start("--unix", path)
            errors = self.process.communicate(timeout=LIMIT_S)[1]
        self.assertEqual(self.process.returncode, 3)
        self.assertIn("Address already in use", errors)

    def test_names_a_second_sink_where_its_port_is_taken(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
            other.bind(("127.0.0.1", 0))
            self.start("--udp", f"127.0.0.1:{other.getsockname()[1]}")
            errors = self.process.communicate(timeout=LIMIT_S)[1]
        self.assertEqual(self.process.returncode, 3)
        self.assertIn("a second [[sink]] of zerorated with a port of its own serves both): Address already in use", errors)

    def test_does_not_take_the_name_of_anything_but_a_socket(self):
        file = self.folder / "recording.csv"
        file.write_text("t_s,rate_dps\n")
        fifo = self.folder / "fifo"
        os.mkfifo(fifo)
        for path in (file, fifo, self.folder):
            self.start("--unix", path)
            errors = self.process.communicate(timeout=LIMIT_S)[1]
            self.assertEqual(self.process.returncode, 3)
            self.assertIn(f"{path}: File exists", errors)
        self.assertEqual(file.read_text(), "t_s,rate_dps\n")
        self.assertTrue(fifo.is_fifo())

    def test_reads_a_serial_line_and_counts_what_is_damaged(self):
        line, device = pty.openpty()
        try:
            self.start("--serial", os.ttyname(device), "--count", 20)
            deadline = time.monotonic() + LIMIT_S
            while termios.tcgetattr(device)[3] & termios.ICANON and time.monotonic() < deadline:
                time.sleep(0.01)
            os.write(line, stuffed(rate_frame(0))[30:])  # it joins in the middle
            for number in range(10):
                os.write(line, stuffed(rate_frame(number)) + b"\x05spoilt\0")
            os.write(line, stuffed(status_frame(77)))
            for number in range(12, 22):
                os.write(line, stuffed(rate_frame(number, health=SENSOR_FAULT)))
            out = self.end().splitlines()
        finally:
            os.close(line)
            os.close(device)
        self.assertRegex(out[-1], r"^ +21\.000 still  ( +-){9}  not calibrated, sensor_fault$")

    def test_paints_over_itself_on_a_terminal_and_ends_with_the_file(self):
        terminal, screen = pty.openpty()
        line = {"sequence": 0, "time_ns": 10**9, "motion": "still", "rate_dps": [0.25, None, -1],
                "measured_dps": [0, 0, 0], "bias_dps": [1, 2, 3], "sigma_dps": [0.001, None, 1], "calm_percent": 93,
                "calibrated": True}
        line |= {flag: False for flag in ("sample_refused", "time_refused", "saturated", "model_inconsistent",
                                          "odometer_fault", "sensor_fault", "measurement_rejected",
                                          "temperature_missing", "odometer_disagreement", "odometer_dead_band")}
        pipe_end, pipe = os.pipe()
        self.process = subprocess.Popen([ZERORATE, "monitor", "--json", "-", "--interval", "0.05"], stdin=pipe_end,
                                        stdout=screen, stderr=subprocess.PIPE)
        os.close(pipe_end)
        os.close(screen)
        for number in range(10):
            os.write(pipe, (json.dumps(line | {"sequence": 2 * number}) + "\n").encode())
            time.sleep(0.05)
        os.write(pipe, b"no json\n")
        os.close(pipe)
        shown = b""
        while select.select([terminal], [], [], LIMIT_S)[0]:
            try:
                shown += os.read(terminal, 65536)
            except OSError:  # the other end was closed
                break
        os.close(terminal)
        self.end()
        text = shown.decode()
        self.assertIn("\033[", text)
        last = text.split("\033[J")[-1].splitlines()
        self.assertEqual(last[0], "standard input: 10 messages, 9 lost, 1 damaged")
        self.assertEqual(last[1], "still: fine")
        self.assertEqual(last[2], "newest stop: 93 % calm")
        self.assertRegex(last[4], r"^x +\+0\.25000 +\+1\.00000 +7\.06 +-$")
        self.assertRegex(last[5], r"^y .* \+2\.00000 +- +-$")

    def test_ends_at_sigterm_and_says_by_its_code_that_nothing_came(self):
        self.start("--unix", self.folder / "rate.sock")
        deadline = time.monotonic() + LIMIT_S
        while not (self.folder / "rate.sock").exists() and time.monotonic() < deadline:
            time.sleep(0.01)
        self.process.send_signal(signal.SIGTERM)
        self.end(code=1)
        self.assertFalse((self.folder / "rate.sock").exists())

    def test_refuses_what_it_cannot_receive_from(self):
        for arguments, code, words in [(["--udp", "nowhere"], 2, "does not end in a port"),
                                       (["--udp", "host:1"], 2, "is not a numeric address"),
                                       (["--serial", "no-line"], 3, "no-line"),
                                       (["--serial", "no-line", "--baud", "31"], 2, "31 baud"),
                                       (["--json", "no-file"], 3, "no-file"),
                                       (["--json", "a", "--unix", "b"], 2, "excludes")]:
            run = subprocess.run([ZERORATE, "monitor", *arguments], capture_output=True, text=True, timeout=LIMIT_S,
                                 check=False)
            self.assertEqual(run.returncode, code, run.stderr)
            self.assertIn(words, run.stderr)


class Probe(unittest.TestCase):
    def test_says_that_a_device_is_not_there(self):
        run = subprocess.run([ZERORATE, "probe", "--json", "--spi", "no-spidev", "--i2c", "no-i2c"],
                             capture_output=True, text=True, timeout=LIMIT_S, check=False)
        self.assertEqual(run.returncode, 1)
        buses = json.loads(run.stdout)["buses"]
        self.assertEqual([(bus["device"], bus["bus"]) for bus in buses], [("no-spidev", "spi"), ("no-i2c", "i2c")])
        by_spi = [attempt["chip"] for attempt in buses[0]["attempts"]]
        by_i2c = [(attempt["chip"], attempt["address"]) for attempt in buses[1]["attempts"]]
        self.assertLess({"adxrs453", "lsm6dso", "mpu6500"}, set(by_spi))
        # Each chip once by SPI; by I2C at both of its addresses, but for those that have SPI only.
        self.assertEqual(len(by_spi), len(set(by_spi)))
        self.assertEqual(len(by_i2c), len(set(by_i2c)))
        self.assertCountEqual([chip for chip, _ in by_i2c], 2 * [chip for chip in by_spi if not chip.startswith("ad")])
        self.assertEqual({attempt["answer"] for bus in buses for attempt in bus["attempts"]}, {"not present"})

    def test_gives_one_line_with_the_reason_for_a_device_that_cannot_be_used(self):
        run = subprocess.run([ZERORATE, "probe", "--spi", "no-spidev", "--i2c", "no-i2c"], capture_output=True,
                             text=True, timeout=LIMIT_S, check=False)
        self.assertEqual([line.split(maxsplit=1) for line in run.stdout.splitlines()],
                         [["no-spidev", "No such file or directory"], ["no-i2c", "No such file or directory"]])


class Silence(unittest.TestCase):
    def test_is_told_once_where_no_message_comes(self):
        with subprocess.Popen([ZERORATE, "monitor", "--udp", "127.0.0.1:24681"], stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True) as process:
            time.sleep(5)
            process.terminate()
            errors = process.communicate(timeout=LIMIT_S)[1]
        self.assertEqual(errors.count("does zerorated run, and has it a sink there?"), 1, errors)


if __name__ == "__main__":
    unittest.main()
