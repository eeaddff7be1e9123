#!/usr/bin/env python3
"""zerorate and bags of ROS 2 in MCAP, whose bytes are written here (mcap.dev/spec).

usage: mcap_test.py ZERORATE [unittest arguments]
"""

import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

ZERORATE = sys.argv.pop(1)
BAD_DATA = 3
MAGIC = b"\x89MCAP0\r\n"
SCHEMA, CHANNEL, MESSAGE, CHUNK, DATA_END, FOOTER = 3, 4, 5, 6, 15, 2
TYPES = {1: "sensor_msgs/msg/Imu", 2: "nav_msgs/msg/Odometry", 3: "geometry_msgs/msg/TwistWithCovarianceStamped"}


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def record(op, content):
    return struct.pack("<BQ", op, len(content)) + content


def channels(*topics):
    """Schemas, and a channel for each (topic, type)."""
    schemas = b"".join(record(SCHEMA, struct.pack("<H", key) + text(name) + text("ros2msg") + text("")) for key, name
                       in TYPES.items())
    return schemas + b"".join(record(CHANNEL, struct.pack("<HH", 10 + index, schema) + text(topic) + text("cdr") + text(""))
                              for index, (topic, schema) in enumerate(topics))


def message(channel, time_ns, data):
    return record(MESSAGE, struct.pack("<HIQQ", channel, 0, time_ns, time_ns) + data)


def header(time_ns, frame):
    """The encapsulation of CDR and a header whose text ends on a multiple of eight bytes."""
    frame = frame.ljust(11, "_").encode() + b"\0"
    return b"\0\1\0\0" + struct.pack("<iII", *divmod(time_ns, 10**9), len(frame)) + frame


def imu(time_ns, rates):
    return header(time_ns, "imu") + struct.pack("<37d", *[0.0] * 13, *rates, *[0.0] * 9, 0.0, 0.0, 9.8, *[0.0] * 9)


def odometry(time_ns, speed, turn):
    child = b"base_link__\0"
    return (header(time_ns, "odom") + struct.pack("<I", len(child)) + child +
            struct.pack("<43d6d36d", *[0.0] * 43, speed, 0.0, 0.0, 0.0, 0.0, turn, *[0.0] * 36))


def compressed(packing, records):
    if not packing:
        return records
    command = {"lz4": ["lz4", "-c"], "zstd": ["zstd", "-c"]}[packing]
    return subprocess.run(command, input=records, capture_output=True, check=True).stdout


def chunk(records, packing=""):
    data = compressed(packing, records)
    return record(CHUNK, struct.pack("<QQQI", 0, 0, len(records), zlib.crc32(records)) + text(packing) +
                  struct.pack("<Q", len(data)) + data)


def bag(*records):
    return (MAGIC + record(1, text("ros2") + text("test")) + b"".join(records) + record(DATA_END, bytes(4)) +
            record(FOOTER, bytes(20)) + MAGIC)


class Mcap(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def convert(self, path, *options):
        output = self.folder / "rows.csv"
        run = subprocess.run([ZERORATE, "convert", path, "-o", output, *options], capture_output=True, text=True,
                             timeout=60, check=False)
        return run, output.read_text(encoding="utf-8").splitlines() if run.returncode == 0 else []

    def rows(self, data, *options, name="run.mcap"):
        path = self.folder / name
        path.write_bytes(data)
        run, lines = self.convert(path, *options)
        self.assertEqual(run.returncode, 0, run.stderr)
        return [line.split(",") for line in lines[1:]]

    def refusal(self, data, *options):
        path = self.folder / "bad.mcap"
        path.write_bytes(data)
        run, _ = self.convert(path, *options)
        self.assertEqual(run.returncode, BAD_DATA, run.stderr)
        return run.stderr

    def drive(self, packing=""):
        """Four chunks with rates of 10 Hz, and a robot that turns on the spot in the second half."""
        parts = [channels(("/imu", 1), ("/odom", 2))]
        for quarter in range(4):
            records = b""
            for k in range(25 * quarter, 25 * (quarter + 1)):
                time_ns = 1_000_000_000 + k * 100_000_000
                turn = 0.5 if k >= 50 else 0.0
                records += message(10, time_ns, imu(time_ns, (0.25, -0.5, turn)))
                records += message(11, time_ns, odometry(time_ns, 0.0, turn))
            parts.append(chunk(records, packing))
        return bag(*parts)

    def test_gives_rates_and_rest(self):
        rows = self.rows(self.drive())
        self.assertEqual(len(rows), 100)
        self.assertEqual(rows[0][:4], ["1", "0.25", "-0.5", "0"])
        self.assertEqual(rows[99][:4], ["10.9", "0.25", "-0.5", "0.5"])
        still = [row[-1] for row in rows]
        self.assertEqual(still[:48] + still[50:], ["1"] * 48 + ["0"] * 50)

    def test_may_be_compressed(self):
        expected = self.rows(self.drive())
        for packing in ("lz4", "zstd"):
            if not shutil.which(packing):
                self.skipTest(f"no program {packing}")
            self.assertEqual(self.rows(self.drive(packing)), expected, packing)

    def test_may_be_a_folder_without_chunks(self):
        for name, time_ns in (("run_10.mcap", 10**9), ("run_2.mcap", 2 * 10**9)):
            (self.folder / name).write_bytes(bag(channels(("/imu", 1)), message(10, time_ns, imu(time_ns, (1.0, 0.0, 0.0)))))
        run, lines = self.convert(self.folder)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual([line.split(",")[0] for line in lines[1:]], ["1", "2"])

    def test_that_is_damaged_or_packed_otherwise_is_refused(self):
        whole = self.drive()
        self.assertIn("a bag that ends early", self.refusal(whole[:len(whole) // 2]))
        self.assertIn("mcap recover", self.refusal(whole[:len(whole) // 2]))
        at = whole.index(struct.pack("<3d", 0.25, -0.5, 0.5))
        self.assertIn("a damaged record behind byte", self.refusal(whole[:at] + b"\1" + whole[at + 1:]))
        other = bag(channels(("/imu", 1)), record(CHUNK, struct.pack("<QQQI", 0, 0, 4, 0) + text("brotli") +
                                                  struct.pack("<Q", 4) + b"1234"))
        self.assertIn('a chunk that is compressed by "brotli"', self.refusal(other))
        self.assertIn("--compression none", self.refusal(other))

    def test_whose_bias_was_taken_out_is_told(self):
        data = bag(channels(("/robot/imu/data", 1), ("/robot/imu/bias", 3)), message(10, 10**9, imu(10**9, (0.0, 0.0, 0.0))),
                   message(11, 10**9, header(10**9, "imu") + bytes(8 * 42)))
        self.assertIn("/robot/imu/data beside /robot/imu/bias: rates whose bias was already taken out", self.refusal(data))
        self.assertEqual(len(self.rows(data, "--topic", "/robot/imu/data")), 1)


if __name__ == "__main__":
    unittest.main()
