#!/usr/bin/env python3
"""zerorated on its simulated chip, and programs that read it.

usage: without_hardware_test.py ZERORATED [unittest arguments]

ZERORATE_CONSUMER_S: how long the example of a consumer runs, 5 unless set.
"""

import json
import math
import os
import subprocess
import sys
import time
import unittest

import zerorated_test
from zerorated_test import LIMIT_S, REPOSITORY


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


if __name__ == "__main__":
    unittest.main()
