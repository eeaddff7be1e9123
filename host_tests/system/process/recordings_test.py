#!/usr/bin/env python3
"""zerorate as a process and what it reads: wrong usage and data that cannot be used end with codes of their own; bags of
ROS 1, written by its own library, give what CSV with the same data gives.

usage: recordings_test.py ZERORATE [unittest arguments]
"""

import csv
import json
import math
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import unittest

try:
    import genpy
    import rosbag
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import Imu
except ImportError:
    rosbag = None

ZERORATE = sys.argv.pop(1)
WRONG_USAGE, BAD_DATA = 2, 3
NOISE = random.Random(1)


def noisy(_):
    return NOISE.gauss(0.0, 0.1)


class ExitCode(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.recording = pathlib.Path(folder.name) / "rest.csv"

    def record(self, rows, rate, columns="t_s,rate_dps", further=""):
        lines = [columns] + [f"{0.1 * k:.1f},{rate(k)}{further}" for k in range(rows)]
        self.recording.write_text("\n".join(lines) + "\n", encoding="utf-8")

    def assert_ends(self, code, command, *options):
        run = subprocess.run([ZERORATE, command, self.recording, *options], capture_output=True, text=True,
                             timeout=60, check=False)
        self.assertEqual(run.returncode, code, run.stderr)
        self.assertTrue(run.stderr.startswith("zerorate: "), run.stderr)

    def test_of_a_recording_that_is_too_short_is_bad_data(self):
        self.record(100, noisy)
        self.assert_ends(BAD_DATA, "diagnose")
        self.record(20, noisy)
        self.assert_ends(BAD_DATA, "characterize")

    def test_of_a_recording_whose_stamps_tell_no_rate_is_bad_data(self):
        for stamps in ([0.0], [0.0] * 20, [0.0, 1e9]):
            lines = [f"{time:.1f},{noisy(0)}" for time in stamps]
            self.recording.write_text("\n".join(["t_s,rate_dps", *lines]) + "\n", encoding="utf-8")
            self.assert_ends(BAD_DATA, "replay", "--schedule", "still=5,drive=5,seed=1")
        self.assert_ends(BAD_DATA, "replay", "--schedule", "still=5,drive=5,seed=1", "--filter-rate", "1")

    def test_of_a_constant_recording_is_bad_data(self):
        self.record(2000, lambda _: 0.25)
        self.assert_ends(BAD_DATA, "diagnose")
        self.assert_ends(BAD_DATA, "characterize")

    def test_of_a_recording_that_is_never_at_rest_is_bad_data(self):
        self.record(2000, noisy, "t_s,rate_dps,still", ",0")
        self.assert_ends(BAD_DATA, "diagnose")
        self.assert_ends(BAD_DATA, "characterize")

    def test_of_a_rest_that_is_short_because_of_motion_says_so(self):
        lines = [f"{0.1 * k:.1f},{noisy(k)},{int(k < 50)}" for k in range(2000)]
        self.recording.write_text("\n".join(["t_s,rate_dps,still", *lines]) + "\n", encoding="utf-8")
        run = subprocess.run([ZERORATE, "characterize", self.recording], capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(run.returncode, BAD_DATA, run.stderr)
        self.assertRegex(run.stderr, r"19\d\d of 2000 rows were left out because the vehicle moved; .*--still-from gyro")

    def test_of_a_count_that_chatters_at_rest_names_the_odometer(self):
        lines = [f"{0.1 * k:.1f},{noisy(k)},{k // 4}" for k in range(4000)]
        self.recording.write_text("\n".join(["t_s,rate_dps,odometer_pulses", *lines]) + "\n", encoding="utf-8")
        for command in ("characterize", "diagnose", "replay"):
            run = subprocess.run([ZERORATE, command, self.recording], capture_output=True, text=True, timeout=60, check=False)
            self.assertIn(run.returncode, (1, BAD_DATA), run.stderr)
            self.assertRegex(run.stderr, "an encoder that chatters does, --still-from gyro", command)
        run = subprocess.run([ZERORATE, "characterize", self.recording, "--still-from", "gyro", "--json", "-"],
                             capture_output=True, text=True, timeout=60, check=False)
        walk = json.loads(run.stdout)["axes"]["rate"]["angle_random_walk_dps_per_sqrt_hz"]["value"]
        self.assertAlmostEqual(walk, 0.1 * math.sqrt(0.1), delta=0.1 * 0.1 * math.sqrt(0.1))

    def run_on_the_recording(self, command, *options):
        return subprocess.run([ZERORATE, command, self.recording, *options], capture_output=True, text=True, timeout=60, check=True)

    def test_of_angles_without_a_row_loses_the_rate_behind_it_alone(self):
        lines = ["t_s,angle"] + [f"{0.1 * k:.1f},0.05" for k in range(50) if k != 20]
        self.recording.write_text("\n".join(lines) + "\n", encoding="utf-8")
        output = self.recording.with_name("rates.csv")
        self.run_on_the_recording("convert", "--columns", "t=t_s,rate=angle", "--units", "time=s,rate=deg/sample", "-o", output)
        rates = [float(line.split(",")[1]) for line in output.read_text(encoding="utf-8").splitlines()[1:]]
        self.assertEqual([k for k, rate in enumerate(rates) if math.isnan(rate)], [20])
        self.assertEqual({round(math.degrees(rate), 4) for rate in rates if not math.isnan(rate)}, {0.5})

    def test_of_a_schedule_over_rates_without_their_bias_names_the_doubt(self):
        axes = []
        for seed in range(3):
            noise = random.Random(seed)
            raw = [noise.gauss(0.0, 0.05) for _ in range(36_000)]
            levels = [sum(raw[max(0, k - 200):k]) / 200 for k in range(0, len(raw), 200)]
            axes.append([rate - levels[k // 200] for k, rate in enumerate(raw)])
        rows = [f"{0.1 * k:.1f}," + ",".join(f"{rate:.5f}" for rate in rates) for k, rates in enumerate(zip(*axes))]
        self.recording.write_text("\n".join(["t_s,gx_dps,gy_dps,gz_dps", *rows]) + "\n", encoding="utf-8")
        replay = ("replay", "--schedule", "still=60,drive=120,seed=1", "--axis", "z")
        self.assertIn("a bias already taken out upstream?", self.run_on_the_recording(*replay).stdout)
        self.assertNotIn("upstream", self.run_on_the_recording(*replay, "--accept", "bias").stdout)

    def test_of_an_option_that_contradicts_the_recording_is_wrong_usage(self):
        self.record(2000, noisy)
        self.assert_ends(WRONG_USAGE, "diagnose", "--axis", "z")
        self.assert_ends(WRONG_USAGE, "characterize", "--order", "2")


class Accelerations(unittest.TestCase):
    """A recording with accelerations beside the same one without them."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        noise = random.Random(5)
        rows = [",".join([f"{0.1 * k:.1f}"] + [f"{noise.gauss(0.2, 0.1):.5f}" for _ in range(3)]) for k in range(1500)]
        self.write("plain.csv", "", rows)
        self.write("accelerated.csv", ",ax_g,ay_g,az_g",
                   [row + (",,," if k % 50 == 7 else ",0.5,0,-0.875") for k, row in enumerate(rows)])

    def write(self, name, columns, rows):
        (self.folder / name).write_text("\n".join(["t_s,gx_dps,gy_dps,gz_dps" + columns, *rows]) + "\n", encoding="utf-8")

    def run_zerorate(self, command, name, *options):
        run = subprocess.run([ZERORATE, command, self.folder / name, *options], capture_output=True, text=True, timeout=60,
                             check=False)
        self.assertIn(run.returncode, (0, 1), run.stderr)
        return run.stdout

    def test_pass_through_the_node_and_change_nothing_that_its_model_does_not_follow(self):
        schedule = ("--schedule", "still=20,drive=30,seed=1")
        corrected = []
        for name in ("plain", "accelerated"):
            out = self.folder / f"{name}.out.csv"
            self.run_zerorate("replay", f"{name}.csv", *schedule, "--out", out)
            with out.open(encoding="utf-8", newline="") as file:
                corrected.append([{key: value for key, value in row.items() if not key.startswith("up_")}
                                  for row in csv.DictReader(file)])
        self.assertEqual(*corrected)
        self.assertGreater(len(corrected[0]), 1400)
        self.assertIn("acceleration is empty, nan or infinite in 30 rows, first in line 9",
                      self.run_zerorate("replay", "accelerated.csv", *schedule))

    def test_are_converted_to_si(self):
        output = self.folder / "si.csv"
        self.run_zerorate("convert", "accelerated.csv", "-o", output)
        header, first = output.read_text(encoding="utf-8").splitlines()[:2]
        self.assertEqual(header, "t_s,gx_dps,gy_dps,gz_dps,ax_mps2,ay_mps2,az_mps2")
        along = [float(number) for number in first.split(",")[4:]]
        for found, expected in zip(along, (0.5 * 9.80665, 0.0, -0.875 * 9.80665)):
            self.assertAlmostEqual(found, expected, delta=1e-6)

    def test_whose_size_is_not_that_of_gravity_are_doubted(self):
        text = (self.folder / "accelerated.csv").read_text(encoding="utf-8").replace("_g", "_mps2")
        (self.folder / "wrong.csv").write_text(text, encoding="utf-8")
        self.assertIn("acceleration of 1.008 m/s2 in the mean, where gravity is 9.8 m/s2 (g taken for m/s2?)",
                      self.run_zerorate("convert", "wrong.csv", "-o", self.folder / "si.csv"))


def imu(stamp, rates=(0.0, 0.0, 0.0), covariance=0.0):
    message = Imu()
    message.header.stamp = stamp
    message.header.frame_id = "imu_link"
    message.angular_velocity.x, message.angular_velocity.y, message.angular_velocity.z = rates
    message.angular_velocity_covariance[0] = covariance
    message.linear_acceleration_covariance[0] = -1.0
    return message


def odometry(stamp, speed_mps, turn_radps=0.0):
    message = Odometry()
    message.header.stamp = stamp
    message.header.frame_id = "odom"
    message.child_frame_id = "base_link"
    message.twist.twist.linear.x = speed_mps
    message.twist.twist.angular.z = turn_radps
    return message


def at(tenths):
    return genpy.Time(1_700_000_000 + tenths // 10, tenths % 10 * 100_000_000)


class BagOfRos1(unittest.TestCase):
    ROWS = 1200

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.bag = self.folder / "run.bag"

    def write(self, messages, path=None, **options):
        """Messages with their topics and, where it is another than their stamp, their time of recording."""
        with rosbag.Bag(path or self.bag, "w", chunk_threshold=20_000, **options) as bag:
            for topic, message, *recorded in messages:
                bag.write(topic, message, *(recorded or [message.header.stamp]))

    def compressed_bags(self):
        """The bytes of a bag in each compression."""
        for compression in ("bz2", "lz4"):
            self.write([("/imu", imu(at(k))) for k in range(300)], compression=compression)
            yield bytearray(self.bag.read_bytes())

    def run_zerorate(self, command, *arguments):
        return subprocess.run([ZERORATE, *command.split(), *map(str, arguments)], capture_output=True, text=True,
                              timeout=300, check=False)

    def rows(self, *options, path=None):
        """The lines that convert makes of a bag."""
        output = self.folder / "rows.csv"
        run = self.run_zerorate("convert", path or self.bag, *options, "-o", output)
        self.assertEqual(run.returncode, 0, run.stderr)
        return output.read_text(encoding="utf-8").splitlines()

    def assert_refused(self, *texts, options=(), command="convert"):
        output = ["-o", self.folder / "refused.csv"] if command == "convert" else []
        run = self.run_zerorate(command, self.bag, *options, *output)
        self.assertEqual(run.returncode, BAD_DATA, run.stderr)
        for text in (f"zerorate: {self.bag}", *texts):
            self.assertIn(text, run.stderr)

    def write_with_csv(self, is_moving, **options):
        """The same rates as bag and as CSV; speeds, at a rate of their own, stand in a CSV of the odometer."""
        noise = random.Random(7)
        messages, lines, speeds = [], ["t_s,gx_radps,gy_radps,gz_radps"], ["t_s,speed_mps"]
        for k in range(self.ROWS):
            rates = [noise.gauss(0.0, 1e-3) for _ in range(3)]
            messages.append(("/imu", imu(at(k), rates)))
            lines.append(f"{1_700_000_000 + k // 10}.{k % 10}," + ",".join(map(repr, rates)))
            if is_moving and k % 2 == 0:
                speed = 3.0 if k % 600 > 400 else 0.0
                messages.append(("/odom", odometry(at(k), speed)))
                speeds.append(f"{1_700_000_000 + k // 10}.{k % 10},{speed}")
        self.write(messages, **options)
        (self.folder / "run.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        (self.folder / "wheels.csv").write_text("\n".join(speeds) + "\n", encoding="utf-8")

    def assert_same(self, command, *arguments, of_csv=()):
        of_bag = self.run_zerorate(command, self.bag, *arguments)
        of_csv = self.run_zerorate(command, self.folder / "run.csv", *of_csv, *arguments)
        self.assertIn(of_bag.returncode, (0, 1), of_bag.stderr)
        self.assertEqual(of_bag.returncode, of_csv.returncode)
        self.assertEqual(of_bag.stdout.replace("run.bag", "run.csv"), of_csv.stdout)
        return of_bag.stdout

    def test_gives_every_command_what_csv_gives(self):
        self.write_with_csv(is_moving=False)
        schedule = "still=20,drive=30,seed=1"
        for command in ("characterize", "diagnose --axis x", f"replay --schedule {schedule}"):
            self.assertTrue(json.loads(self.assert_same(command, "--json", "-")), command)
        run = self.run_zerorate("demo", self.bag, "--schedule", schedule, "--directory", self.folder / "demo")
        self.assertEqual(run.returncode, 0, run.stderr)
        fleet = self.folder / "fleet"
        fleet.mkdir()
        self.bag.rename(fleet / "S1.bag")
        run = self.run_zerorate("fleet run", fleet, "--db", self.folder / "fleet.sqlite", "--json", "-")
        self.assertEqual(run.returncode, 0, run.stderr)

    def test_tells_rest_as_the_same_speed_in_a_file_does(self):
        self.write_with_csv(is_moving=True)
        wheels = ("--odometer-file", self.folder / "wheels.csv")
        for command in ("characterize", "replay"):
            self.assert_same(command, "--json", "-", of_csv=wheels)
        self.assertEqual(self.rows(), self.rows(*wheels, path=self.folder / "run.csv"))
        self.assertEqual({line.rsplit(",", 1)[1] for line in self.rows()[1:]}, {"0", "1"})

    def test_that_turns_on_the_spot_moves(self):
        """The speed forwards is 0 all the time; the turn of 30 deg/s in the second half shall not become bias."""
        messages = []
        for k in range(self.ROWS):
            turn = math.radians(30.0) if k % 600 > 400 else 0.0
            messages.append(("/imu", imu(at(k), (0.01, 0.0, turn))))
            messages.append(("/odom", odometry(at(k), 0.0, turn)))
        self.write(messages)
        still = [(line.split(",")[3], line.rsplit(",", 1)[1]) for line in self.rows()[1:]]
        self.assertEqual({rate for rate, is_still in still if is_still == "1"}, {"0"})
        self.assertEqual({is_still for rate, is_still in still if rate != "0"}, {"0"})

    def test_may_be_compressed(self):
        self.write_with_csv(is_moving=True)
        expected = self.rows()
        for compression in ("bz2", "lz4"):
            self.write_with_csv(is_moving=True, compression=compression)
            self.assertEqual(self.rows(), expected, compression)

    def test_marks_rates_that_their_sender_does_not_know(self):
        self.write([("/imu", imu(at(0), (0.5, 0, 0))), ("/imu", imu(at(1), (0.5, 0, 0), covariance=-1.0))])
        self.assertEqual([line.split(",")[1] for line in self.rows()[1:]], ["0.5", "nan"])

    def test_without_a_stamp_has_the_time_of_recording(self):
        self.write([("/imu", imu(genpy.Time(0, 0)), at(3)), ("/imu", imu(at(5)), at(4))])
        self.assertEqual([line.split(",")[0] for line in self.rows()[1:]], ["1700000000.3", "1700000000.5"])

    def test_with_several_gyros_wants_a_topic(self):
        self.write([("/front", imu(at(0), (1, 0, 0))), ("/rear", imu(at(0), (2, 0, 0)))])
        self.assert_refused("2 topics with messages of sensor_msgs/Imu", "/front, /rear", "--topic")
        self.assert_refused('no topic "/side"', options=["--topic", "/side"])
        self.assertIn(",2,", self.rows("--topic", "/rear")[1])

    def test_needs_no_columns(self):
        self.write([("/imu", imu(at(0)))])
        self.assert_refused("Leave out --columns", options=["--columns", "gx=x"])

    def test_without_a_gyro_is_refused(self):
        self.write([("/odom", odometry(at(0), 1.0))])
        self.assert_refused("no topic with messages of sensor_msgs/Imu", "rosbag info")
        with rosbag.Bag(self.bag, "w"):
            pass
        self.assert_refused("no topic with messages of sensor_msgs/Imu")

    def test_with_a_message_that_ends_early_is_refused(self):
        with rosbag.Bag(self.bag, "w") as bag:
            bag.write("/imu", imu(at(0)), at(0))
            bag.write("/imu", (Imu._type, bytes(100), Imu._md5sum, Imu), at(1), raw=True)
        self.assert_refused("a message that ends early as message 2 of /imu")

    def test_that_was_not_closed_wants_an_index(self):
        bag = rosbag.Bag(self.folder / "open.bag", "w")
        bag.write("/imu", imu(at(0)), at(0))
        bag.flush()
        self.bag.write_bytes((self.folder / "open.bag").read_bytes())
        bag.close()
        self.assert_refused("without an index", "rosbag reindex")

    def test_that_ends_early_is_refused(self):
        self.write([("/imu", imu(at(k))) for k in range(300)])
        whole = self.bag.read_bytes()
        for size in (9, 13, 20, 4096, 5000, len(whole) // 2, len(whole) - 1):
            self.bag.write_bytes(whole[:size])
            self.assert_refused(command="characterize")
        self.assert_refused("a bag that ends early", "rosbag reindex")

    def test_of_another_version_is_refused(self):
        self.bag.write_bytes(b"#ROSBAG V1.2\n" + bytes(5000))
        self.assert_refused("another version of the format than 2.0")

    def test_that_is_damaged_ends_nothing_but_its_reading(self):
        noise = random.Random(3)
        self.write([("/imu", imu(at(k))) for k in range(300)])
        whole = self.bag.read_bytes()
        records = 4096 + 13  # behind the padded header
        offsets = [at for at in range(records, len(whole)) if whole[at:at + 3] in (b"op=", b"con", b"cou", b"siz")]
        for _ in range(40):
            damaged = bytearray(whole)
            for place in (noise.choice(offsets) + noise.randrange(-8, 12), noise.randrange(13, len(whole))):
                struct.pack_into("<B", damaged, place, noise.choice((0, 255, noise.randrange(256))))
            self.bag.write_bytes(damaged)
            run = self.run_zerorate("convert", self.bag, "-o", self.folder / "rows.csv")
            self.assertIn(run.returncode, (0, BAD_DATA), run.stderr)

    def test_with_an_index_that_leads_astray_in_a_compressed_chunk_is_refused_with_its_place(self):
        for whole in self.compressed_bags():
            first_entry = whole.index(b"count=", whole.index(b"op=\x04")) + len("count=") + 4 + 4
            entry = first_entry + 3 * 12
            for offset in (1, 5, 2**32 - 1):
                struct.pack_into("<I", whole, entry + 8, offset)
                self.bag.write_bytes(whole)
                self.assert_refused(f"an index entry at byte {entry} that leads to no message", "rosbag reindex")

    def test_with_a_compressed_chunk_that_is_damaged_is_refused_with_its_place(self):
        for whole in self.compressed_bags():
            chunk = whole.index(b"op=\x05") - 8  # behind two lengths
            whole[chunk + 1000] ^= 255
            self.bag.write_bytes(whole)
            self.assert_refused(f"a damaged chunk at byte {chunk}", "rosbag reindex")


def obstacle_to_bags():
    if not rosbag:
        return "python3-rosbag, python3-sensor-msgs or python3-nav-msgs is not installed"
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "run.bag"
        rosbag.Bag(path, "w").close()
        run = subprocess.run([ZERORATE, "characterize", path], capture_output=True, text=True, timeout=60, check=False)
    return "librosbag-storage-dev was not there at build time" if "build again" in run.stderr else ""


if __name__ == "__main__":
    if "BagOfRos1" in sys.argv and obstacle_to_bags():
        print(obstacle_to_bags())
        sys.exit(77)
    unittest.main()
