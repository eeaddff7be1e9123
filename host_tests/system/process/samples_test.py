#!/usr/bin/env python3
"""zerorated with samples that another program sends: the example of docs/how-to/bring-your-own-samples.md as it stands there.

usage: samples_test.py ZERORATED [unittest arguments]
"""

import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import textwrap
import time
import unittest

from message_inputs_test import free_port
from zerorated_test import LIMIT_S, REPOSITORY, ZERORATED

PAGE = (REPOSITORY / "docs/how-to/bring-your-own-samples.md").read_text(encoding="utf-8")
EXAMPLES = REPOSITORY / "docs/examples/python"


class OwnSamples(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.ports = {"24681": str(free_port()), "24680": str(free_port())}

    def start(self, *command):
        process = subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate, timeout=LIMIT_S)
        self.addCleanup(process.terminate)
        return process

    def configure(self, more=""):
        block = re.search(r"The configuration, `own.toml`:\n\n((?:    .*\n)+)", PAGE)[1]
        text = textwrap.dedent(block) + more
        for port, free in self.ports.items():
            text = text.replace(port, free)
        (self.folder / "own.toml").write_text(text, encoding="utf-8")
        return self.folder / "own.toml"

    def run_node(self, more=""):
        node = self.start(ZERORATED, "--config", self.configure(more))
        time.sleep(0.5)
        return node

    def end(self, node):
        node.terminate()
        return node.communicate(timeout=LIMIT_S)[1]

    def receive(self, count):
        """Lines of the example that receives."""
        received = subprocess.run([sys.executable, EXAMPLES / "receive_rate.py", "--port", self.ports["24680"], "--count",
                                   str(count)], capture_output=True, text=True, timeout=60, check=True)
        return [line.split() for line in received.stdout.splitlines()]

    def test_are_corrected_as_the_page_shows(self):
        for command in ("zerorated --config own.toml", "docs/examples/python/send_samples.py --port 24681",
                        "docs/examples/python/receive_rate.py"):
            self.assertIn(f"    {command}\n", PAGE)
        node = self.run_node()
        self.start(sys.executable, EXAMPLES / "send_samples.py", "--port", self.ports["24681"])
        lines = self.receive(1200)
        self.assertEqual(lines[-1][9], "calibrated")
        for axis in range(3):  # mean of the last second: noise of 0.03 deg/s, ten deviations of the mean
            self.assertLess(abs(sum(float(line[3 + axis]) for line in lines[-100:]) / 100), 0.03)
        errors = self.end(node)
        self.assertIn(f"gyro: udp:127.0.0.1:{self.ports['24681']} started, 100 Hz", errors)

    def test_that_are_lost_or_wrong_are_told(self):
        metrics = self.folder / "metrics"
        node = self.run_node(f'[metrics]\nfile = "{metrics}"\n')
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            def send(text):
                sender.sendto(text.encode(), ("127.0.0.1", int(self.ports["24681"])))
            for sequence in range(200):
                if sequence != 50:
                    send(f"{sequence} {time.monotonic_ns()} 0.001 {sequence % 7 * 1e-4} 0")
                if sequence == 60:
                    send(f"60 {time.monotonic_ns()} 0.001 0.001 0 25 1")
                if sequence == 70:
                    send(f"71 {time.time_ns()} 0.001 0.001 0")
                time.sleep(0.01)
        time.sleep(2.5)
        counted = dict(re.findall(r"^zerorate_gyro_samples_(\w+)_total (\d+)$", metrics.read_text(encoding="utf-8"),
                                  re.MULTILINE))
        self.assertEqual(counted, {"lost": "1", "late": "0", "doubled": "0", "unreadable": "1", "foreign": "1"})
        errors = self.end(node)
        for text in ("samples are lost on the way", "messages come that are no samples", "not of CLOCK_MONOTONIC",
                     "no sample for a second (does its sender run?)"):
            self.assertIn(text, errors)


if __name__ == "__main__":
    unittest.main()
