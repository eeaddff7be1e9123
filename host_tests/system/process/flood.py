"""Datagrams as fast as they can be sent, on loopback."""

import contextlib
import subprocess
import sys

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


@contextlib.contextmanager
def flood_of(frame, port):
    """A flood from two processes, for ten seconds at most."""
    senders = [subprocess.Popen([sys.executable, "-c", SENDER, str(port), frame.hex()]) for _ in range(2)]
    try:
        yield
    finally:
        for sender in senders:
            sender.kill()
            sender.wait()
