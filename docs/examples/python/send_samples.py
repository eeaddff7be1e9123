#!/usr/bin/env python3
"""Sends the samples of a gyroscope to zerorated, for a chip that has no driver there. Needs Python 3 alone.

usage: send_samples.py [--address 127.0.0.1] [--port 24681] [--rate 100] [--seconds 0]

read_chip() is yours: here it gives noise about a bias. docs/how-to/bring-your-own-samples.md describes the datagram.
"""

import argparse
import itertools
import math
import random
import socket
import time


def read_chip():
    """Rates in rad/s, temperature in deg C, specific force in m/s2: replace it by the library of your chip."""
    bias = [math.radians(0.4), math.radians(-0.2), math.radians(0.1)]
    return [random.gauss(mean, math.radians(0.03)) for mean in bias], 25.0, [0.0, 0.0, 9.81]


def main():
    parser = argparse.ArgumentParser(description="sends samples of a gyroscope to zerorated")
    parser.add_argument("--address", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=24681)
    parser.add_argument("--rate", type=float, default=100.0, help="samples a second")
    parser.add_argument("--seconds", type=float, default=0.0, help="end after so long; 0: never")
    options = parser.parse_args()
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    begin = due = time.monotonic()
    for sequence in itertools.count():
        stamp_ns = time.monotonic_ns()  # as close to the measurement as you can
        rates, temperature, force = read_chip()
        numbers = [sequence, stamp_ns, *rates, temperature, *force]
        sender.sendto(" ".join(map(str, numbers)).encode(), (options.address, options.port))
        due += 1.0 / options.rate
        if options.seconds and due - begin > options.seconds:
            break
        time.sleep(max(0.0, due - time.monotonic()))


if __name__ == "__main__":
    main()
