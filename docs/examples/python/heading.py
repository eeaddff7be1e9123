#!/usr/bin/env python3
"""Heading of a vehicle: the turns of its drives, one after the other, as a zerorate node sends them by UDP.

usage: heading.py [PORT]

A line for each message: heading in deg, counter-clockwise from the first departure, and an upper bound of its standard
deviation. The bound adds those of the drives, because an error of the scale factor is the same in all of them.
"""

import sys

from receive_rate import messages

VERTICAL = 2  # z points up
ended_deg = ended_sigma_deg = turn_deg = sigma_deg = turn_s = 0.0
for message, _ in messages("127.0.0.1", int(sys.argv[1]) if len(sys.argv) > 1 else 24680):
    if message["turn_s"] < turn_s:  # the next drive has begun, and its turn with it
        ended_deg, ended_sigma_deg = ended_deg + turn_deg, ended_sigma_deg + sigma_deg
    turn_s, turn_deg = message["turn_s"], message["turn_deg"][VERTICAL]
    sigma_deg = message["turn_sigma_deg"][VERTICAL]  # infinite before the first departure, and behind full scale
    print(f"{ended_deg + turn_deg:.3f} {ended_sigma_deg + sigma_deg:.3f}", flush=True)
