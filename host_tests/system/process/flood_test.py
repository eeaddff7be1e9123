#!/usr/bin/env python3
"""zerorate record and monitor under datagrams that come faster than they can be taken, on loopback.

usage: flood_test.py ZERORATE [unittest arguments]
"""

import contextlib
import pathlib
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

ZERORATE = sys.argv.pop(1)
LIMIT_S = 20.0

SENDER = """import socket, sys, time
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
sender.connect(("127.0.0.1", int(sys.argv[1])))
frame, end = bytes.fromhex(sys.argv[2]), time.monotonic() + 10.0
while time.monotonic() < end:
    for _ in range(100):
        try:
            sender.send(frame)
        except ConnectionRefusedError:
            pass
"""


def rate_frame():
    """By docs/reference/rate-frame.md."""
    axis = struct.pack("<4f", 0.03, 0.01, 0.02, 1e-5)
    body = struct.pack("<2sBBIqBBH", b"ZR", 3, 3, 1, 10**9, 2, 1, 0) + 3 * axis + struct.pack("<fI6fq", 25.0, 7, *3 * (0.5, 0.01), 10**9)
    return body + struct.pack("<I", zlib.crc32(body))


@contextlib.contextmanager
def flood(port):
    """A flood from two processes, for ten seconds at most."""
    senders = [subprocess.Popen([sys.executable, "-c", SENDER, str(port), rate_frame().hex()]) for _ in range(2)]
    try:
        yield
    finally:
        for sender in senders:
            sender.kill()
            sender.wait()


def resident_kb(process):
    status = pathlib.Path(f"/proc/{process}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1])


class Flooded(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]

    def flooded(self, command, *arguments):
        """Output of a command that is flooded for four seconds and then ended by SIGTERM."""
        process = subprocess.Popen([ZERORATE, command, "--udp", f"127.0.0.1:{self.port}", *map(str, arguments)], text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(process.kill)
        with flood(self.port):
            time.sleep(2.0)
            before = resident_kb(process.pid)
            time.sleep(2.0)
            grown = resident_kb(process.pid) - before
            process.send_signal(signal.SIGTERM)
            out, _ = process.communicate(timeout=LIMIT_S)
        self.assertLess(grown, 4096, "kilobytes in two seconds")
        return out

    def test_a_recorder_ends_and_says_what_it_has(self):
        self.assertIn("messages lost", self.flooded("record", "-o", self.folder / "rest.csv.gz"))

    def test_a_monitor_shows_what_comes_and_ends(self):
        self.assertGreater(len(self.flooded("monitor", "--interval", 0.1).splitlines()), 5)


if __name__ == "__main__":
    unittest.main()
