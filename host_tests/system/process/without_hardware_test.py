#!/usr/bin/env python3
"""zerorated on its simulated chip, and programs that read it.

usage: without_hardware_test.py ZERORATED [unittest arguments]

ZERORATE_CONSUMER_S: how long the example of a consumer runs, 5 unless set.
"""

import json
import math
import os
import pwd
import re
import select
import shutil
import signal
import subprocess
import sys
import time
import unittest

import zerorated_test
from zerorated_test import LIMIT_S, REPOSITORY


class Simulated(zerorated_test.Node):
    def simulate(self, more="", of_gyro=""):
        text = self.file.read_text()
        gyro, rest = text.index("[gyro]"), text.index("[state]")
        self.file.write_text(text[:gyro] + '[gyro]\nchip = "simulated"\n' + of_gyro + text[rest:] + more)

    def consume(self, command, count):
        """Lines of a consumer of so many messages, and the messages by number as the JSON lines have them."""
        lines = self.folder / "rate.jsonl"
        self.simulate(f'[[sink]]\ntype = "json"\nfile = "{lines}"\n', "acceleration = true\n")
        self.receiver.close()
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as consumer:
            time.sleep(0.5)
            self.start()
            received = [line.split() for line in consumer.communicate(timeout=count / 104 + LIMIT_S)[0].splitlines()]
        self.stop()
        self.assertEqual(len(received), count)
        return received, {line["sequence"]: line for line in map(json.loads, lines.read_text().splitlines())}


class SeveralNodes(Simulated):
    """Two nodes in one process, which write their lines into one file."""

    def setUp(self):
        super().setUp()
        self.lines = self.folder / "rates.jsonl"
        self.simulate(f'[[sink]]\ntype = "json"\nfile = "{self.lines}"\n')
        rear = self.folder / "rear.toml"
        rear.write_text(self.file.read_text().replace("state", "rear").replace("[rear]", "[state]")
                        .replace("metrics.sock", "rear.sock"))
        self.further_files = [rear]
        self.file.write_text('name = "front"\n' + self.file.read_text())

    def wait_for_both(self):
        self.lines.write_text("")
        end = time.monotonic() + LIMIT_S
        while {'"node":"front"', '"node":"rear"'} - set(re.findall(r'"node":"\w+"', self.lines.read_text())):
            self.assertLess(time.monotonic(), end, "a node is silent")
            time.sleep(0.05)

    def test_tell_their_lines_metrics_logs_and_states_apart(self):
        self.start()
        self.wait_for_both()
        self.assertEqual(self.notification(), "WATCHDOG=1")  # a second has passed: there are metrics
        for node, file in (("front", "metrics.sock"), ("rear", "rear.sock")):
            self.assertIn(f'zerorate_bias_dps{{node="{node}",axis="x"}}', self.metrics(file))
        errors = self.stop()
        self.assertIn("zerorated: front: simulated, 104 Hz", errors)
        self.assertIn("zerorated: rear: gyro: simulated started", errors)
        for node in ("front", "rear"):
            numbers = [line["sequence"] for line in map(json.loads, self.lines.read_text().splitlines())
                       if line["node"] == node]
            self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))))
            self.assertTrue(list(self.folder.glob({"front": "state.[01]", "rear": "rear.[01]"}[node])), node)

    def test_go_on_together_as_before_if_one_new_configuration_is_wrong(self):
        self.start()
        self.wait_for_both()
        self.further_files[0].write_text("nonsense\n")
        self.process.send_signal(signal.SIGHUP)
        self.assertIn("READY=1", iter(self.notification, ""))
        self.wait_for_both()
        self.assertIn("not reloaded: ", self.stop())

    def test_need_names_of_their_own(self):
        self.further_files[0].write_text('name = "front"\n' + self.further_files[0].read_text())
        run = subprocess.run([zerorated_test.ZERORATED, "--check-config", "--config", self.file, "--config",
                              self.further_files[0]], capture_output=True, text=True, timeout=LIMIT_S, check=False)
        self.assertEqual(run.returncode, 3)
        self.assertIn('give two nodes one name, "front"', run.stderr)


class WithoutHardware(Simulated):
    @unittest.skipUnless(shutil.which("cc"), "no C compiler named cc")
    def test_gives_a_consumer_in_c_the_message_that_its_json_says(self):
        program = self.folder / "receive_rate"
        subprocess.run(["cc", "-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-o", program,
                        REPOSITORY / "docs/examples/c/receive_rate.c"], check=True)
        received, said = self.consume([program, str(self.receiver.getsockname()[1]), "300"], 300)
        for number, seconds, motion, *rates, temperature, pulses, calibrated, lost in received:
            message = said[int(number)]
            self.assertEqual((motion, lost), (message["motion"], "lost=0"))
            self.assertAlmostEqual(float(seconds), message["time_ns"] * 1e-9, delta=1e-6)
            self.assertEqual(calibrated == "calibrated", message["calibrated"])
            self.assertEqual(int(pulses), message["odometer_pulses"])
            if rates[0] == "none":
                self.assertEqual(message["rate_dps"], [None] * 3)
                continue
            self.assertAlmostEqual(float(temperature), message["temperature_c"], delta=1e-5)
            for rate, expected in zip(rates, message["rate_dps"], strict=True):
                self.assertAlmostEqual(float(rate), expected, delta=1e-6 * max(1.0, abs(expected)))
        self.assertGreater(sum(fields[3] != "none" for fields in received), 270)

    def test_gives_a_consumer_the_rate_that_its_json_says(self):
        count = int(float(os.environ.get("ZERORATE_CONSUMER_S", "5")) * 104)
        port = str(self.receiver.getsockname()[1])
        received, said = self.consume([sys.executable, REPOSITORY / "docs/examples/python/receive_rate.py", "--port",
                                       port, "--count", str(count)], count)
        self.assertEqual({fields[-1] for fields in received}, {"lost=0"})
        for number, _, motion, x, y, z, *_ in received:
            message = said[int(number)]
            self.assertEqual(motion, message["motion"])
            if x == "none":
                self.assertEqual(message["rate_dps"], [None] * 3)
                continue
            for rate, expected in zip((x, y, z), message["rate_dps"], strict=True):
                self.assertAlmostEqual(float(rate), expected, delta=1e-6 * max(1.0, abs(expected)))
        self.assertGreater(sum(fields[3] != "none" for fields in received), 0.9 * count)
        forces = [message["acceleration_mps2"] for message in said.values() if message["acceleration_mps2"]]
        self.assertGreater(len(forces), 0.9 * count)
        for force, expected in zip(forces[-1], (0.0, 0.0, 9.80665), strict=True):
            self.assertAlmostEqual(force, expected, delta=0.06)  # six deviations of 1 mg

    def test_gives_the_heading_of_several_drives(self):
        # Each minute rests 20 s and then swings four times from 0 to 100 / pi deg and back.
        self.simulate("", "time_factor = 10\n")
        port = self.receiver.getsockname()[1]
        self.receiver.close()
        example = subprocess.Popen([sys.executable, "-B", REPOSITORY / "docs/examples/python/heading.py", str(port)],
                                   stdout=subprocess.PIPE, text=True)
        time.sleep(0.5)
        self.start()
        time.sleep(130 / 10)
        self.stop()
        example.terminate()
        lines = [tuple(map(float, line.split())) for line in example.communicate(timeout=LIMIT_S)[0].splitlines()]
        known = [(heading, sigma) for heading, sigma in lines if math.isfinite(sigma)]
        self.assertGreater(len(known), 1000)
        if min(sigma for _, sigma in known) > 3.0:
            self.skipTest("the machine is too busy: gaps in the samples widen the interval")
        for wanted, found in ((0.0, min(known)), (100 / math.pi, max(known))):
            self.assertLess(abs(found[0] - wanted), 4 * found[1] + 0.2, "a sample of 10 deg/s is 0.1 deg")

    def test_refuses_a_configuration_or_model_that_exhausts_its_stack(self):
        self.simulate()
        configuration = self.file.read_text()
        deep = self.folder / "deep.toml"
        deep.write_text(f"[a{'.a' * 200_000}]\n")
        for text in (deep.read_text(), configuration + f'[model]\nfile = "{deep}"\n'):
            self.file.write_text(text)
            run = subprocess.run([zerorated_test.ZERORATED, "--config", self.file, "--check-config"], capture_output=True,
                                 text=True, timeout=LIMIT_S, check=False)
            self.assertEqual(run.returncode, 3, run.stderr)
            self.assertIn("more than 32768 bytes", run.stderr)

    def test_runs_without_hardware_on_the_simulated_chip(self):
        self.simulate()
        self.start()
        message = self.message()
        while not message["health"] & 0x01:  # the vehicle stands for its first twenty seconds
            message = self.message()
        measured, corrected, bias, sigma = message["x"]
        self.assertEqual(message["motion"], 2)
        self.assertFalse(message["health"] & 0x60, "sensor_fault, odometer_fault")
        self.assertAlmostEqual(math.degrees(bias), 0.35, delta=0.1)
        self.assertLess(math.degrees(sigma), 0.1)
        self.assertAlmostEqual(corrected, measured - bias, delta=1e-6)
        self.assertIn("zerorated: simulated, 104 Hz, 250 deg/s, model lsm6dso, simulated odometer", self.stop())

    @unittest.skipUnless(os.geteuid() == 0, "limits of locked memory are tried as another user, from root")
    @unittest.skipIf(zerorated_test.is_sanitized(), "the address sanitizer locks no memory")
    def test_runs_under_every_limit_of_locked_memory(self):
        self.simulate()
        text = self.file.read_text().replace("lock_memory = false", "lock_memory = true")
        user = pwd.getpwnam("nobody")
        for limit_kib in range(6800, 8000, 50):
            self.file.write_text(text)
            for path in (self.folder, self.file, self.folder / "notify"):
                os.chown(path, user.pw_uid, user.pw_gid)
            while select.select([self.receiver], [], [], 0)[0]:
                self.receiver.recv(256)  # of the process before
            with subprocess.Popen(["prlimit", f"--memlock={limit_kib * 1024}", "setpriv", "--reuid=nobody",
                                   "--clear-groups", zerorated_test.ZERORATED, "--config", self.file],
                                  stderr=subprocess.PIPE, text=True) as process:
                self.message()
                process.terminate()
                errors = process.communicate(timeout=LIMIT_S)[1]
            self.assertEqual(process.returncode, 0, f"{limit_kib} KiB: {errors}")


if __name__ == "__main__":
    unittest.main()
