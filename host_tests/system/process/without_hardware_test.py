#!/usr/bin/env python3
"""zerorated on its simulated chip, and programs that read it.

usage: without_hardware_test.py ZERORATED [unittest arguments]

ZERORATE_CONSUMER_S: how long the example of a consumer runs, 5 unless set.
"""

import json
import math
import os
import pwd
import select
import socket
import subprocess
import sys
import time
import unittest

import zerorated_test
from zerorated_test import LIMIT_S, REPOSITORY


TRAITS = "dead_band_mps = 0.1\nlatency_s = 0.05\n"


class WithoutHardware(zerorated_test.Node):
    def simulate(self, more=""):
        text = self.file.read_text()
        gyro, rest = text.index("[gyro]"), text.index("[state]")
        self.file.write_text(text[:gyro] + '[gyro]\nchip = "simulated"\n' + text[rest:] + more)

    def test_gives_a_consumer_the_rate_that_its_json_says(self):
        port = self.receiver.getsockname()[1]
        lines = self.folder / "rate.jsonl"
        self.simulate(f'[[sink]]\ntype = "json"\nfile = "{lines}"\n')
        self.receiver.close()
        count = int(float(os.environ.get("ZERORATE_CONSUMER_S", "5")) * 104)
        with subprocess.Popen([sys.executable, REPOSITORY / "docs/examples/python/receive_rate.py", "--port", str(port),
                               "--count", str(count)], stdout=subprocess.PIPE, text=True) as consumer:
            time.sleep(0.5)
            self.start()
            received = [line.split() for line in consumer.communicate(timeout=count / 104 + LIMIT_S)[0].splitlines()]
        self.stop()
        said = {message["sequence"]: message for message in map(json.loads, lines.read_text().splitlines())}
        self.assertEqual(len(received), count)
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
        for limit_kib in range(6800, 7500, 50):
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

    def wait_for(self, is_reached, say, words):
        """Says the speed ten times a second until a message is as it should be."""
        for _ in range(200):
            if words is not None:
                say(words.encode())
            end = time.monotonic() + 0.1
            while time.monotonic() < end:
                message = self.message()
                if is_reached(message):
                    return message
        self.fail("not reached")

    def drive_by_messages(self, say):
        """Stands, moves, falls silent and stands again, by what is said of the speed."""
        self.start()
        self.assertTrue(self.message()["health"] & 0x20, "nobody has said anything: odometer_fault")
        self.wait_for(lambda message: message["health"] & 0x01 and message["motion"] == 2, say, "0.05")
        self.wait_for(lambda message: message["motion"] == 0, say, "-0.5")
        self.wait_for(lambda message: message["motion"] == 2, say, "still")
        silent_since = time.monotonic()
        self.wait_for(lambda message: message["health"] & 0x20 and message["motion"] == 0, say, None)
        self.assertGreater(time.monotonic() - silent_since, 0.8)
        self.wait_for(lambda message: not message["health"] & 0x20, say, "still")
        return self.stop()

    def test_takes_the_speed_from_udp(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.simulate(f'[odometer]\ntype = "udp"\naddress = "127.0.0.1"\nport = {port}\n' + TRAITS)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            errors = self.drive_by_messages(lambda words: sender.sendto(words, ("127.0.0.1", port)))
        self.assertIn(f"odometer udp:127.0.0.1:{port}: Connection timed out (no message with a speed comes", errors)

    def test_takes_the_speed_from_a_unix_socket(self):
        path = self.folder / "speed"
        self.simulate(f'[odometer]\ntype = "unix"\npath = "{path}"\n' + TRAITS)
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
            self.drive_by_messages(lambda words: sender.sendto(words, str(path)))
        self.assertFalse(path.exists())

    def test_says_that_the_can_interface_of_the_speed_is_not_there(self):
        self.simulate('[odometer]\ntype = "can"\ninterface = "no-can"\nid = 0x1A0\nstart_bit = 0\nlength = 8\n'
                      'byte_order = "little"\nscale_mps = 0.1\n' + TRAITS)
        self.start()
        message = self.wait_for(lambda message: message["health"] & 0x20, None, None)
        self.assertEqual(message["motion"], 0)
        for _ in range(200):
            self.message()
        self.assertRegex(self.stop(), r"odometer can:no-can id 0x1a0: .+; the vehicle counts as moving")


if __name__ == "__main__":
    unittest.main()
