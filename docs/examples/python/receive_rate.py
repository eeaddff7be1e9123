#!/usr/bin/env python3
"""Receives the corrected rate of a zerorate node by UDP and prints a line for each message. Needs Python 3 alone.

usage: receive_rate.py [--address 127.0.0.1] [--port 24680] [--count MESSAGES]

A line holds: number, time in s, motion, corrected rate of x, y and z in deg/s, its standard deviation in deg/s, flags.
docs/reference/rate-frame.md describes the bytes.
"""

import argparse
import math
import socket
import struct
import zlib

MOTION = ("moving", "settling", "still")
# Bits of the health, from the lowest.
HEALTH = ("calibrated", "sample_refused", "time_refused", "saturated", "model_inconsistent", "odometer_fault",
          "sensor_fault", "measurement_rejected", "temperature_missing", "odometer_disagreement", "odometer_dead_band", "sample_rate_off",
          "reference_disagreement", "acceleration_missing")
# Bits of byte 3, and blocks at the end of the frame with their numbers of values.
(HAS_TEMPERATURE, HAS_PULSES, HAS_UP, HAS_ACCELERATION, HAS_VIBRATION, HAS_EXPLAINED,
 HAS_SLOPE) = (1 << bit for bit in range(7))
BLOCKS = {HAS_UP: 5, HAS_ACCELERATION: 3, HAS_VIBRATION: 1, HAS_EXPLAINED: 9, HAS_SLOPE: 1}
CALIBRATED, NO_RATE = 0x001, 0x002 | 0x004 | 0x040  # sample_refused, time_refused, sensor_fault


def decode(datagram):
    """The message as a dictionary, rates in deg/s; None for anything that is not a whole rate frame."""
    if datagram[:2] != b"ZR":
        return None  # such as the learnt frame, once a second
    if datagram[2] != 5:
        raise ValueError(f"rate frame of version {datagram[2]}; this program reads version 5")
    contents = datagram[3]
    at, size = {}, 116
    for bit, values in BLOCKS.items():
        at[bit] = size
        size += 4 * values if contents & bit else 0
    if len(datagram) != size + 4 or struct.unpack_from("<I", datagram, size)[0] != zlib.crc32(datagram[:size]):
        return None

    def block(bit):
        """Values of a block; None where the frame lacks it."""
        return list(struct.unpack_from(f"<{BLOCKS[bit]}f", datagram, at[bit])) if contents & bit else None

    vertical, vibration, explained = block(HAS_UP), block(HAS_VIBRATION), block(HAS_EXPLAINED)
    slope = block(HAS_SLOPE)
    number, time_ns, motion, health = struct.unpack_from("<IqBH", datagram, 4)
    temperature_c, pulses = struct.unpack_from("<fI", datagram, 68)
    turns = [struct.unpack_from("<2f", datagram, 76 + 8 * axis) for axis in range(3)]
    heading = struct.unpack_from("<2f", datagram, 108)
    axes = [struct.unpack_from("<4f", datagram, 20 + 16 * axis) for axis in range(3)]
    return {
        "sequence": number,
        "time_ns": time_ns,
        "time_s": time_ns * 1e-9,
        "motion": MOTION[motion],
        "health": health,
        "calibrated": bool(health & CALIBRATED),
        # A fault is told in messages without a rate: those must not be taken for standstill.
        "rate_dps": None if health & NO_RATE else [math.degrees(axis[1]) for axis in axes],
        "measured_dps": [math.degrees(axis[0]) for axis in axes],
        "bias_dps": [math.degrees(axis[2]) for axis in axes],
        "sigma_dps": [math.degrees(axis[3]) for axis in axes],
        # Angle since the vehicle drove off, and its standard deviation: infinite where it is not known.
        "turn_deg": [math.degrees(turn[0]) for turn in turns],
        "turn_sigma_deg": [math.degrees(turn[1]) for turn in turns],
        "turn_s": struct.unpack_from("<q", datagram, 100)[0] * 1e-9,
        # Counter-clockwise from the references of the node; infinite deviation before the first one.
        "heading_deg": math.degrees(heading[0]),
        "heading_sigma_deg": math.degrees(heading[1]),
        "temperature_c": temperature_c if contents & HAS_TEMPERATURE else None,
        "odometer_pulses": pulses if contents & HAS_PULSES else None,
        # Unit vector that points up, in the axes of the sensor; None where it is not known.
        "up": vertical[:3] if vertical else None,
        # Angle about that vector since the vehicle drove off, counter-clockwise from above.
        "vertical_turn_deg": math.degrees(vertical[3]) if vertical else None,
        "vertical_turn_sigma_deg": math.degrees(vertical[4]) if vertical else None,
        # Angle between the vertical and its mean over the stops before.
        "slope_deg": math.degrees(slope[0]) if slope else None,
        # Specific force, and the root mean square of its changes within a tenth of a second.
        "acceleration_mps2": block(HAS_ACCELERATION),
        "vibration_mps2": vibration[0] if vibration else None,
        # Of each axis what temperature, acceleration and vibration explain of its bias.
        "explained_dps": [[math.degrees(share) for share in explained[3 * axis:3 * axis + 3]] for axis in range(3)]
                         if explained else None,
    }


def decode_learnt(datagram):
    """Angle random walk of x, y and z that the node has learnt of its sensor; None for any other frame."""
    if len(datagram) != 84 or datagram[:3] != b"ZL\x01" or struct.unpack_from("<I", datagram, 80)[0] != zlib.crc32(datagram[:80]):
        return None
    figures = [struct.unpack_from("<6f", datagram, 8 + 24 * axis) for axis in range(3)]
    return {"stops": struct.unpack_from("<f", datagram, 4)[0],
            "angle_random_walk_dps_per_sqrt_hz": [math.degrees(axis[4]) for axis in figures]}


def messages(address, port):
    """Messages as they come; tells how many were lost between two of them."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind((address, port))
        expected = None
        while True:
            message = decode(receiver.recv(256))
            if message is None:
                continue
            lost = 0 if expected is None else (message["sequence"] - expected) % 2**32
            expected = (message["sequence"] + 1) % 2**32
            yield message, lost


def main():
    parser = argparse.ArgumentParser(description="prints the corrected rate of a zerorate node")
    parser.add_argument("--address", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=24680)
    parser.add_argument("--count", type=int, default=0, help="end after so many messages; 0: never")
    options = parser.parse_args()
    for index, (message, lost) in enumerate(messages(options.address, options.port), start=1):
        rate = message["rate_dps"]
        fields = [message["sequence"], f'{message["time_s"]:.6f}', message["motion"]]
        fields += ["none"] * 3 if rate is None else [f"{value:.9g}" for value in rate]
        fields += [f"{value:.9g}" for value in message["sigma_dps"]]
        fields += ["calibrated" if message["calibrated"] else "uncalibrated", f"lost={lost}"]
        print(*fields, flush=True)
        if index == options.count:
            break


if __name__ == "__main__":
    main()
