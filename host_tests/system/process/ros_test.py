#!/usr/bin/env python3
"""host_tools/ros with zerorated and its simulated gyro, on loopback: the node of ROS 2 against a stand-in for rclpy, that of
ROS 1 under a real roscore, and the package by a real colcon.

usage: ros_test.py ZERORATED Ros2|Ros1|Colcon; what is not installed ends with code 77
"""

import importlib.util
import math
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest
import xml.etree.ElementTree

import zerorated_test
from message_inputs_test import free_port
from without_hardware_test import Simulated
from zerorated_test import LIMIT_S, REPOSITORY

try:
    import rospy
except ImportError:
    rospy = None

FOLDER = REPOSITORY / "host_tools/ros"
TYPES = {"diagnostic_msgs.msg": ("DiagnosticArray", "DiagnosticStatus", "KeyValue"),
         "geometry_msgs.msg": ("PoseWithCovarianceStamped", "Twist", "TwistStamped", "TwistWithCovarianceStamped"),
         "nav_msgs.msg": ("Odometry",), "rcl_interfaces.msg": ("ParameterDescriptor",),
         "sensor_msgs.msg": ("Imu", "Temperature")}


def stand_ins_for_ros(published, declared, subscribed):
    """Modules with just what imu_node.py takes of a ROS installation, which is not here."""
    class Message(types.SimpleNamespace):
        def __getattr__(self, name):  # a member of a message is a message until it is set
            member = Message()
            setattr(self, name, member)
            return member

    class Node:
        def __init__(self, name):
            pass

        def declare_parameter(self, name, default, descriptor):
            declared.setdefault(name, (default, descriptor.description))
            return Message(value=declared[name][0])

        def create_publisher(self, kind, topic, quality):
            return Message(publish=lambda message: published.append((topic, message)))

        def create_subscription(self, kind, topic, callback, quality):
            subscribed[topic] = callback

        def create_timer(self, period_s, callback):
            def run():
                while True:
                    time.sleep(period_s)
                    callback()
            threading.Thread(target=run, daemon=True).start()

        def get_clock(self):
            return Message(now=lambda: Message(nanoseconds=time.time_ns()))

        def get_logger(self):
            return Message(error=lambda text: None)

    class Time(Message):
        def to_msg(self):
            return self.nanoseconds

    status = type("DiagnosticStatus", (Message,), {"OK": b"\0", "WARN": b"\1", "ERROR": b"\2", "STALE": b"\3"})
    names = {"rclpy": {"ok": lambda: True}, "rclpy.node": {"Node": Node}, "rclpy.time": {"Time": Time},
             "rclpy.qos": {"qos_profile_sensor_data": None}}
    names.update({module: {name: Message for name in members} for module, members in TYPES.items()})
    names["diagnostic_msgs.msg"]["DiagnosticStatus"] = status
    for name, members in names.items():
        sys.modules[name] = types.ModuleType(name)
        vars(sys.modules[name]).update(members)


class Ros2(Simulated):
    """The node for ROS 2, against stand-ins: it was never run in ROS 2."""

    def setUp(self):
        super().setUp()
        self.published, self.declared, self.subscribed = [], {}, {}
        stand_ins_for_ros(self.published, self.declared, self.subscribed)
        self.declared["port"] = self.receiver.getsockname()[1], ""
        sys.modules.pop("imu_publisher", None)
        specification = importlib.util.spec_from_file_location("imu_node", FOLDER / "imu_node.py")
        self.module = importlib.util.module_from_spec(specification)
        specification.loader.exec_module(self.module)

    def of(self, topic):
        return [message for name, message in list(self.published) if name == topic]

    def wait_for(self, is_reached):
        deadline = time.monotonic() + LIMIT_S
        while not is_reached():
            self.assertLess(time.monotonic(), deadline, "not reached")
            time.sleep(0.05)

    def diagnosis(self):
        return [(array.status[0].level, array.status[0].message) for array in self.of("/diagnostics")][-1:]

    def test_publishes_imu_messages_by_rep_145(self):
        self.receiver.close()
        node = self.module.ImuNode()
        threading.Thread(target=node.receive, daemon=True).start()
        self.wait_for(lambda: self.diagnosis() == [(b"\3", "no message yet: has zerorated a udp sink to this port?")])
        self.simulate(of_gyro="acceleration = true\n")
        self.start()
        self.wait_for(lambda: len(self.of("imu/data")) > 100 and self.diagnosis()[0][0] == b"\0")
        raw = self.of("imu/data_raw")[-1]
        self.stop()
        self.wait_for(lambda: self.diagnosis()[0][0] == b"\3")
        self.assertRegex(self.diagnosis()[0][1], "no message for . s: does zerorated run")
        stamps = [imu.header.stamp for imu in self.of("imu/data")]
        for before, after in zip(stamps, stamps[1:]):
            self.assertAlmostEqual(after - before, 1e9 / 104, delta=1e7)
        self.assertLess(abs(stamps[-1] - time.time_ns()), 20e9)
        imu = self.of("imu/data")[-1]
        self.assertEqual(imu.header.frame_id, "imu_link")
        self.assertEqual((imu.orientation_covariance[0], imu.linear_acceleration_covariance[0]), (-1.0, 0.0))
        self.assertAlmostEqual(imu.linear_acceleration.z, 9.80665, delta=0.06)  # six deviations of 1 mg
        covariance = imu.angular_velocity_covariance
        self.assertEqual([i for i, value in enumerate(covariance) if value != 0.0], [0, 4, 8])
        self.assertGreater(covariance[0], math.radians(0.03) ** 2)
        self.assertLess(covariance[0], math.radians(0.1) ** 2)
        self.assertLess(abs(imu.angular_velocity.x), math.radians(0.5))
        bias = self.of("imu/bias")[-1].twist
        self.assertAlmostEqual(math.degrees(bias.twist.angular.x), 0.35, delta=0.1)
        self.assertEqual([i for i, value in enumerate(bias.covariance) if value != 0.0], [21, 28, 35])
        self.assertAlmostEqual(math.degrees(raw.angular_velocity.x), 0.35, delta=0.3)
        self.assertLess(len(self.of("imu/temperature")), 0.1 * len(self.of("imu/data_raw")))

    def test_goes_on_after_a_frame_of_another_version(self):
        imu = self.module.ImuPublisher(self.module.ImuNode(), {name: value for name, (value, _) in self.declared.items()})
        self.simulate()
        self.start()
        self.message()
        frame = self.receiver.recv(256)
        self.stop()
        imu.take(frame[:2] + b"\x63" + frame[3:])
        imu.diagnose()
        self.assertEqual(self.diagnosis(), [(b"\2", "rate frame of version 99; this program reads version 5")])
        imu.take(frame)
        imu.diagnose()
        self.assertEqual(self.diagnosis()[0][0], b"\1")

    def test_says_that_its_port_is_taken(self):
        node = self.module.ImuNode()
        threading.Thread(target=node.receive, daemon=True).start()
        self.wait_for(lambda: self.diagnosis() and self.diagnosis()[0][0] == b"\2")
        self.assertIn("Address already in use; another program listens there: give zerorated a second [[sink]]",
                      self.diagnosis()[0][1])

    def test_has_a_file_of_all_parameters(self):
        self.module.ImuNode()
        text = (FOLDER / "config/zerorate_imu.yaml").read_text(encoding="utf-8")
        of_file = dict(re.findall(r"^    (\w+): (.*)$", text, re.MULTILINE))
        self.declared["port"] = 24680, self.declared["port"][1]
        expected = {name: str(value) if value != "" else '""' for name, (value, _) in self.declared.items()}
        self.assertEqual(of_file, expected)
        compile((FOLDER / "launch/zerorate_imu.launch.py").read_text(encoding="utf-8"), "launch", "exec")

    def test_has_a_package_that_can_be_read(self):
        package = xml.etree.ElementTree.parse(FOLDER / "package.xml").getroot()
        self.assertEqual((package.tag, package.find("name").text), ("package", "zerorate_imu"))


def white_dps(imu):
    return math.degrees(math.sqrt(imu.angular_velocity_covariance[0]))


class Ros1(Simulated):
    """The node for ROS 1, under a roscore of its own."""

    @classmethod
    def setUpClass(cls):
        cls.home = tempfile.TemporaryDirectory()
        os.environ.update(ROS_MASTER_URI=f"http://127.0.0.1:{free_port()}", ROS_IP="127.0.0.1", ROS_HOME=cls.home.name,
                          ROS_LOG_DIR=cls.home.name, ROSCONSOLE_STDOUT_LINE_BUFFERED="1")
        cls.core = subprocess.Popen(["roscore", "-p", os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1]],
                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + LIMIT_S
        while time.monotonic() < end and subprocess.run(["rosparam", "get", "/run_id"], capture_output=True,
                                                        check=False).returncode != 0:
            time.sleep(0.2)
        rospy.init_node("test", disable_signals=True)

    @classmethod
    def tearDownClass(cls):
        rospy.signal_shutdown("the end")
        cls.core.send_signal(signal.SIGINT)
        cls.core.wait(LIMIT_S)
        cls.home.cleanup()

    def diagnosed(self, level, text=""):
        """Waits for a diagnosis."""
        deadline = time.monotonic() + LIMIT_S
        while not (self.statuses and self.statuses[-1].level == level and text in self.statuses[-1].message):
            self.assertLess(time.monotonic(), deadline, f"{level} {text}: {self.statuses[-1:]}")
            time.sleep(0.1)

    def motion(self):
        return {value.key: value.value for value in self.statuses[-1].values}.get("motion")

    def drive(self, odometry, turn_rad_s, is_reached):
        """Publishes what a robot on its place says, until what it should cause."""
        from nav_msgs.msg import Odometry
        message = Odometry()
        message.twist.twist.angular.z = turn_rad_s
        deadline = time.monotonic() + LIMIT_S
        while not is_reached():
            self.assertLess(time.monotonic(), deadline, f"{turn_rad_s}: {self.statuses[-1:]}")
            odometry.publish(message)
            time.sleep(0.1)

    def test_publishes_forwards_and_diagnoses(self):
        from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
        from nav_msgs.msg import Odometry
        from sensor_msgs.msg import Imu
        port, speed_port = self.receiver.getsockname()[1], free_port()
        self.receiver.close()
        self.statuses, imus = [], []
        rospy.Subscriber("/diagnostics", DiagnosticArray, lambda array: self.statuses.append(array.status[0]))
        rospy.Subscriber("imu/data", Imu, imus.append)
        odometry = rospy.Publisher("odom", Odometry, queue_size=10)
        node = subprocess.Popen([sys.executable, "-B", FOLDER / "imu_node_ros1.py", f"_port:={port}", "_motion_topic:=odom",
                                 f"_motion_port:={speed_port}"], stderr=subprocess.DEVNULL)
        self.addCleanup(node.wait, LIMIT_S)
        self.addCleanup(node.terminate)
        self.diagnosed(DiagnosticStatus.STALE, "no message yet")
        self.simulate(f'[odometer]\ntype = "udp"\naddress = "127.0.0.1"\nport = {speed_port}\ndead_band_mps = 0.1\n'
                      "latency_s = 0.05\n", of_gyro="drives = false\n")
        self.start()
        self.drive(odometry, 0.0, lambda: len(imus) > 100 and self.motion() == "still")
        self.drive(odometry, 0.5, lambda: self.motion() == "moving")
        self.drive(odometry, 0.0, lambda: self.motion() == "still" and white_dps(imus[-1]) < 0.03)
        stamps = [imu.header.stamp.to_nsec() for imu in imus]
        self.assertEqual(stamps, sorted(stamps))
        self.assertLess(abs(stamps[-1] - time.time_ns()), 10e9)
        # N of the catalogue's model of the simulated chip at 104 Hz; before it was learnt, the parameter.
        self.assertGreater(white_dps(imus[0]), 0.03)
        self.assertAlmostEqual(white_dps(imus[-1]), 0.00269 * math.sqrt(104), delta=0.004)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for _ in range(3):
                sender.sendto(b"ZR\x63" + bytes(117), ("127.0.0.1", port))
        self.stop()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.sendto(b"ZR\x63" + bytes(117), ("127.0.0.1", port))
        self.diagnosed(DiagnosticStatus.ERROR, "rate frame of version 99")
        self.assertIsNone(node.poll())
        self.start()
        self.diagnosed(DiagnosticStatus.WARN)
        self.stop()
        self.diagnosed(DiagnosticStatus.STALE, "does zerorated run")


class Colcon(unittest.TestCase):
    """The package by Debian's colcon and ament-cmake: in the clone, and by a link in a workspace."""

    def build(self, base, *arguments):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            run = subprocess.run(["colcon", "--log-base", folder / "log", "build", "--build-base", folder / "build",
                                  "--install-base", folder / "install", "--base-paths", base, *arguments], cwd=folder,
                                 env=dict(os.environ, PATH="/usr/bin:/bin"),  # Debian's Python, which has ament_package
                                 capture_output=True, text=True, timeout=300, check=False)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            package = folder / "install/zerorate_imu"
            programs = sorted(path.name for path in (package / "lib/zerorate_imu").iterdir())
            self.assertEqual(programs, ["imu_node.py", "imu_publisher.py", "receive_rate.py"])
            share = package / "share/zerorate_imu"
            for path in ("package.xml", "launch/zerorate_imu.launch.py", "config/zerorate_imu.yaml"):
                self.assertTrue((share / path).is_file(), path)
            # The installed files find each other.
            code = "import sys; sys.path.insert(0, sys.argv[1]); import receive_rate; print(receive_rate.__file__)"
            subprocess.run([sys.executable, "-B", "-c", code, package / "lib/zerorate_imu"], check=True, capture_output=True)

    def test_builds_it_in_the_clone(self):
        self.build(FOLDER)

    def test_builds_it_in_a_workspace(self):
        with tempfile.TemporaryDirectory() as workspace:
            (pathlib.Path(workspace) / "zerorate_imu").symlink_to(FOLDER)
            self.build(workspace, "--packages-select", "zerorate_imu")

    def test_says_what_a_copy_lacks(self):
        with tempfile.TemporaryDirectory() as workspace:
            shutil.copytree(FOLDER, pathlib.Path(workspace) / "zerorate_imu")
            with self.assertRaisesRegex(AssertionError, "clone all of zerorate"):
                self.build(workspace)


def missing():
    """What the wanted class lacks; empty where nothing."""
    if "Ros1" in sys.argv:
        return "" if rospy and shutil.which("roscore") else "no rospy or no roscore (Debian: python3-rospy, python3-roslaunch)"
    if "Colcon" in sys.argv:
        found = shutil.which("colcon") and pathlib.Path("/usr/share/ament_cmake").is_dir()
        return "" if found else "no colcon or no ament-cmake"
    return ""


if __name__ == "__main__":
    if missing():
        print(f"skipped: {missing()}")
        sys.exit(77)
    unittest.main()
