"""What the nodes for ROS 1 and ROS 2 have in common: frames of a zerorate node to messages.

| topic | type | content |
|---|---|---|
| imu/data | sensor_msgs/Imu | corrected rate in rad/s, and the specific force where it is measured |
| imu/data_raw | sensor_msgs/Imu | the rate as the chip gave it |
| imu/bias | geometry_msgs/TwistWithCovarianceStamped | predicted bias in rad/s, with its variance |
| imu/heading | geometry_msgs/PoseWithCovarianceStamped | yaw from the references of the node |
| imu/turn | geometry_msgs/PoseWithCovarianceStamped | yaw since the vehicle drove off, about the measured vertical |
| imu/temperature | sensor_msgs/Temperature | of the chip, once a second |
| /diagnostics | diagnostic_msgs/DiagnosticArray | once a second, also while nothing comes |

By REP-145 the axes are those of the sensor's frame (`frame_id`) and the rate is right-handed; by the definition of
sensor_msgs/Imu a covariance that begins with -1 belongs to a quantity that is not measured. A message without a rate, or
before the first calibration, is not published on imu/data: nobody could tell it from a good one there.

The stamp is the time at which the sample was taken. The node's clock is the monotonic clock of its machine: the first
messages give its offset from this machine's time, by the least delay, and the offset follows slowly.
"""

import errno
import math
import pathlib
import socket
import sys
import threading
import time
import typing

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseWithCovarianceStamped, Twist, TwistStamped, TwistWithCovarianceStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, Temperature

_HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(_HERE), str(_HERE.parents[1] / "docs/examples/python")]  # installed, and in the clone
from receive_rate import HEALTH, decode, decode_learnt  # noqa: E402 # pylint: disable=wrong-import-position

NOT_MEASURED = [-1.0] + [0.0] * 8  # REP 145: there is no such figure
NOT_KNOWN = [0.0] * 9  # there is one, and its covariance is not known
# Flags that leave no rate.
FAULTS = ("sample_refused", "time_refused", "sensor_fault")


class Parameter(typing.NamedTuple):
    name: str
    default: typing.Any
    description: str


PARAMETERS = (
    Parameter("frame_id", "imu_link", "frame of the sensor's axes"),
    Parameter("heading_frame_id", "odom", "frame in which imu/heading and imu/turn are yaws, z upwards"),
    Parameter("address", "127.0.0.1", "address of this machine to which zerorated's udp sink sends"),
    Parameter("port", 24680, "port to which it sends"),
    Parameter("stale_s", 2.0, "without a message for so long the diagnostics say STALE [s]"),
    Parameter("sample_noise_dps", 0.03, "standard deviation of one sample until the node has learnt the noise [deg/s]"),
    Parameter("drive_s", 0.0, "usual time between two stops, by which a filter that takes the error of the bias for white "
                              "noise has the right heading error at the next stop; 0: variance of one sample alone [s]"),
    Parameter("motion_topic", "", "topic of the odometry that shows rest, such as /odom; empty: none is forwarded"),
    Parameter("motion_type", "odometry", "its type: odometry, twist_stamped or twist"),
    Parameter("track_width_m", 1.0, "distance of left and right wheels: a turn is forwarded as the speed of a wheel [m]"),
    Parameter("motion_address", "127.0.0.1", "address of zerorated's [odometer] of the type udp"),
    Parameter("motion_port", 4000, "its port"),
)
MOTION_TYPES = {"odometry": Odometry, "twist_stamped": TwistStamped, "twist": Twist}
TOPICS = {"imu/data": Imu, "imu/data_raw": Imu, "imu/bias": TwistWithCovarianceStamped,
          "imu/heading": PoseWithCovarianceStamped, "imu/turn": PoseWithCovarianceStamped,
          "imu/temperature": Temperature, "/diagnostics": DiagnosticArray}


class ClockOffset:
    """Time of this machine less time of the node, by the message that was delayed least."""

    FORGET_NS_PER_S = 50_000  # the clocks of two machines drift apart by up to 50 ppm

    def __init__(self):
        self._offset_ns = None
        self._seen_ns = 0

    def stamp_ns(self, node_ns, now_ns):
        offset_ns = now_ns - node_ns
        if self._offset_ns is None or abs(offset_ns - self._offset_ns) > 1_000_000_000:
            self._offset_ns = offset_ns  # the first message, a restart, a clock that was set
        else:
            allowed_ns = self._offset_ns + (node_ns - self._seen_ns) * self.FORGET_NS_PER_S // 1_000_000_000
            self._offset_ns = min(offset_ns, allowed_ns)
        self._seen_ns = node_ns
        return node_ns + self._offset_ns


class Noise:
    """Variances of one sample by axis, in rad2/s2."""

    def __init__(self, sample_noise_dps, drive_s):
        self._white = [math.radians(sample_noise_dps) ** 2] * 3
        self._drive_s = drive_s
        self._densities = None
        self._before = None
        self._rate_hz = 0.0

    def learn(self, learnt):
        """Takes N from the learnt frame. A two-sided density: the variance of a sample is N^2 times the rate."""
        self._densities = [math.radians(figure) ** 2 for figure in learnt["angle_random_walk_dps_per_sqrt_hz"]]

    def follow(self, message):
        """Takes the rate of the samples from the stamps of two messages in a row."""
        now = message["sequence"], message["time_s"]
        if self._before and now[0] == self._before[0] + 1 and now[1] > self._before[1]:
            rate_hz = 1.0 / (now[1] - self._before[1])
            self._rate_hz += (rate_hz - self._rate_hz) * (0.02 if self._rate_hz else 1.0)
        self._before = now

    def white(self):
        if self._densities is None or not self._rate_hz:
            return self._white
        return [density * self._rate_hz for density in self._densities]

    def corrected(self, message):
        """White noise and the error of the bias, which is one and the same throughout a drive."""
        repeats = max(1.0, self._drive_s * self._rate_hz)
        return [white + math.radians(sigma) ** 2 * repeats for white, sigma in zip(self.white(), message["sigma_dps"])]


def diagonal(variances):
    return [variances[0], 0.0, 0.0, 0.0, variances[1], 0.0, 0.0, 0.0, variances[2]]


def fastest(twist, track_width_m):
    """Speeds in m/s of a Twist: of the vehicle, and of a wheel by its turn. What turns on the spot moves."""
    linear, angular = twist.linear, twist.angular
    turn = math.hypot(angular.x, angular.y, angular.z)
    return math.hypot(linear.x, linear.y, linear.z), 0.5 * track_width_m * turn


class ImuPublisher:
    """Receives frames and gives messages to `ros`: publish(topic, message), now_ns(), stamp(ns), error(text)."""

    def __init__(self, ros, parameters):
        self._ros = ros
        self._set = parameters
        if parameters["motion_type"] not in MOTION_TYPES:
            raise ValueError(f"motion_type: {parameters['motion_type']}; there are {', '.join(MOTION_TYPES)}")
        self._noise = Noise(parameters["sample_noise_dps"], parameters["drive_s"])
        self._offset = ClockOffset()
        self._lock = threading.Lock()
        self._heard_s = -math.inf
        self._newest = None
        self._expected = None
        self._lost = 0
        self._fault = ""
        self._temperature_s = -math.inf
        self._motion = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def run(self, is_running):
        """Publishes messages as they come; for a thread of its own."""
        while is_running():
            try:
                with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
                    receiver.bind((self._set["address"], self._set["port"]))
                    self._tell_fault("")
                    receiver.settimeout(0.5)
                    self._receive(receiver, is_running)
            except OSError as error:
                hint = ("; another program listens there: give zerorated a second [[sink]] with a port of its own, and this "
                        "node that port" if error.errno == errno.EADDRINUSE else "")
                self._tell_fault(f"{self._set['address']}:{self._set['port']}: {error.strerror}{hint}")
                time.sleep(1.0)

    def _receive(self, receiver, is_running):
        while is_running():
            try:
                datagram = receiver.recv(256)
            except socket.timeout:
                continue
            self.take(datagram)

    def take(self, datagram):
        """One datagram. A frame of a version that is not known is told, and the next one counts again."""
        learnt = decode_learnt(datagram)
        if learnt:
            self._noise.learn(learnt)
            return
        try:
            message = decode(datagram)
        except ValueError as error:
            self._tell_fault(str(error))
            return
        if message is None:
            return
        self._tell_fault("")
        with self._lock:
            if self._expected is not None and message["sequence"] >= self._expected:
                self._lost += message["sequence"] - self._expected
            self._expected = message["sequence"] + 1
            self._newest = message
            self._heard_s = time.monotonic()
        self._noise.follow(message)
        self._publish(message)

    def forward(self, motion):
        """A message of the odometry, to zerorated."""
        twist = motion
        while not hasattr(twist, "linear"):  # Odometry holds a TwistWithCovariance, TwistStamped a Twist
            twist = twist.twist
        speed, turn = fastest(twist, self._set["track_width_m"])
        try:
            self._motion.sendto(f"{speed:.6f} {turn:.6f}".encode(), (self._set["motion_address"], self._set["motion_port"]))
        except OSError:
            pass  # zerorated takes silence for motion

    def _tell_fault(self, fault):
        if fault and fault != self._fault:
            self._ros.error(fault)
        self._fault = fault

    def _publish(self, message):
        stamp = self._ros.stamp(self._offset.stamp_ns(message["time_ns"], self._ros.now_ns()))
        if message["rate_dps"] is not None:
            self._ros.publish("imu/data_raw", self._imu(message, stamp, message["measured_dps"], self._noise.white()))
            if message["calibrated"]:
                self._ros.publish("imu/data",
                                  self._imu(message, stamp, message["rate_dps"], self._noise.corrected(message)))
                self._ros.publish("imu/bias", self._bias(message, stamp))
        for topic, yaw, sigma in (("imu/heading", message["heading_deg"], message["heading_sigma_deg"]),
                                  ("imu/turn", message["vertical_turn_deg"], message["vertical_turn_sigma_deg"])):
            if sigma is not None and math.isfinite(sigma):
                self._ros.publish(topic, self._yaw(math.radians(yaw), math.radians(sigma), stamp))
        if message["temperature_c"] is not None and abs(message["time_s"] - self._temperature_s) >= 1.0:
            self._temperature_s = message["time_s"]
            temperature = self._stamped(Temperature(), stamp)
            temperature.temperature = message["temperature_c"]
            self._ros.publish("imu/temperature", temperature)

    def _stamped(self, out, stamp, frame_id="frame_id"):
        out.header.stamp = stamp
        out.header.frame_id = self._set[frame_id]
        return out

    def _imu(self, message, stamp, rate_dps, variances):
        imu = self._stamped(Imu(), stamp)
        imu.angular_velocity.x, imu.angular_velocity.y, imu.angular_velocity.z = map(math.radians, rate_dps)
        imu.angular_velocity_covariance = diagonal(variances)
        imu.orientation_covariance = NOT_MEASURED
        force = message["acceleration_mps2"]
        imu.linear_acceleration_covariance = NOT_MEASURED if force is None else NOT_KNOWN
        if force is not None:
            imu.linear_acceleration.x, imu.linear_acceleration.y, imu.linear_acceleration.z = force
        return imu

    def _bias(self, message, stamp):
        bias = self._stamped(TwistWithCovarianceStamped(), stamp)
        angular = bias.twist.twist.angular
        angular.x, angular.y, angular.z = map(math.radians, message["bias_dps"])
        covariance = [0.0] * 36
        for axis, sigma in enumerate(message["sigma_dps"]):
            covariance[7 * (3 + axis)] = math.radians(sigma) ** 2
        bias.twist.covariance = covariance
        return bias

    def _yaw(self, yaw, sigma, stamp):
        pose = self._stamped(PoseWithCovarianceStamped(), stamp, "heading_frame_id")
        pose.pose.pose.orientation.z = math.sin(yaw / 2)
        pose.pose.pose.orientation.w = math.cos(yaw / 2)
        covariance = [0.0] * 36
        covariance[35] = sigma ** 2
        pose.pose.covariance = covariance
        return pose

    def diagnose(self):
        """Publishes the diagnosis; to be called once a second, whatever comes."""
        with self._lock:
            newest, lost, silence_s = self._newest, self._lost, time.monotonic() - self._heard_s
        status = DiagnosticStatus()
        status.name = "zerorate: gyro"
        status.hardware_id = self._set["frame_id"]
        status.level, status.message = self._level(newest, silence_s)
        status.values = [KeyValue(key="messages lost", value=str(lost))]
        if newest:
            status.values.append(KeyValue(key="motion", value=newest["motion"]))
        array = DiagnosticArray()
        array.header.stamp = self._ros.stamp(self._ros.now_ns())
        array.status = [status]
        self._ros.publish("/diagnostics", array)

    def _level(self, newest, silence_s):
        if self._fault:
            return DiagnosticStatus.ERROR, self._fault
        if silence_s > self._set["stale_s"]:
            return DiagnosticStatus.STALE, (f"no message for {silence_s:.0f} s: does zerorated run?" if newest
                                            else "no message yet: has zerorated a udp sink to this port?")
        flags = [name for bit, name in enumerate(HEALTH) if newest["health"] >> bit & 1]
        alarms = [name for name in flags if name != "calibrated"]
        if any(flag in FAULTS for flag in flags):
            return DiagnosticStatus.ERROR, ", ".join(alarms)
        if alarms or not newest["calibrated"]:
            return DiagnosticStatus.WARN, ", ".join(alarms) or "not calibrated yet"
        return DiagnosticStatus.OK, "calibrated"
