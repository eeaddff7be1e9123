#!/usr/bin/env python3
"""ROS 2 node: the corrected rate of a zerorate node as sensor_msgs/Imu, its bias and its health beside it.

An example. The project compiles it and runs it against stand-ins for rclpy and the messages; it was never built or run
in a ROS installation.

    colcon build --packages-select zerorate_imu
    ros2 run zerorate_imu imu_node.py --ros-args -p port:=24680 -p frame_id:=imu_link

| topic | type | content |
|---|---|---|
| imu/data | sensor_msgs/Imu | angular_velocity: corrected rate in rad/s; nothing else is measured |
| imu/bias | geometry_msgs/Vector3Stamped | predicted bias in rad/s |
| imu/temperature | sensor_msgs/Temperature | of the chip |
| diagnostics | diagnostic_msgs/DiagnosticArray | motion, flags, messages lost; once a second |

By REP-145 the axes are those of the sensor's frame (`frame_id`) and the rate is right-handed; by the definition of
sensor_msgs/Imu a covariance that begins with -1 belongs to a quantity that is not measured. The covariance of the rate
holds the variance of the predicted bias and that of the white noise of one sample. A message without a rate, or
before the first calibration, is not published on imu/data: nobody could tell it from a good one there.

The stamp is the time at which the sample was taken. The node's clock is the monotonic clock of its machine: the first
messages tell its offset from this machine's time, by the least delay, and the offset follows slowly.
"""

import math
import pathlib
import sys
import threading

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import Vector3Stamped
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rclpy.time import Time
from sensor_msgs.msg import Imu, Temperature

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "python"))
from receive_rate import HEALTH, messages  # noqa: E402

NOT_MEASURED = [-1.0] + [0.0] * 8  # REP 145: there is no such figure
NOT_KNOWN = [0.0] * 9  # there is one, and its covariance is not known


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


def diagonal(variances):
    return [variances[0], 0.0, 0.0, 0.0, variances[1], 0.0, 0.0, 0.0, variances[2]]


class ImuNode(Node):
    def __init__(self):
        super().__init__("zerorate_imu")
        self._frame_id = self.declare_parameter("frame_id", "imu_link").value
        self._address = self.declare_parameter("address", "127.0.0.1").value
        self._port = self.declare_parameter("port", 24680).value
        # Standard deviation of one sample: noise density times the square root of the bandwidth.
        self._noise_rad_s = math.radians(self.declare_parameter("sample_noise_dps", 0.03).value)
        self._imu = self.create_publisher(Imu, "imu/data", qos_profile_sensor_data)
        self._bias = self.create_publisher(Vector3Stamped, "imu/bias", qos_profile_sensor_data)
        self._temperature = self.create_publisher(Temperature, "imu/temperature", qos_profile_sensor_data)
        self._diagnostics = self.create_publisher(DiagnosticArray, "diagnostics", 10)
        self._offset = ClockOffset()
        self._lost = 0
        self._told_s = -math.inf

    def receive(self):
        """Publishes messages as they come; for a thread of its own."""
        for message, lost in messages(self._address, self._port):
            if not rclpy.ok():
                return
            self._lost += lost
            self.publish(message)

    def publish(self, message):
        now_ns = self.get_clock().now().nanoseconds
        stamp = Time(nanoseconds=self._offset.stamp_ns(message["time_ns"], now_ns)).to_msg()
        if message["rate_dps"] is not None and message["calibrated"]:
            self._imu.publish(self._imu_message(message, stamp))
            self._bias.publish(self._bias_message(message, stamp))
        if message["temperature_c"] is not None:
            temperature = Temperature()
            self._stamp(temperature, stamp)
            temperature.temperature = message["temperature_c"]
            self._temperature.publish(temperature)
        if message["time_s"] - self._told_s >= 1.0 or message["time_s"] < self._told_s:
            self._told_s = message["time_s"]
            self._diagnostics.publish(self._diagnosis(message, stamp))

    def _stamp(self, out, stamp):
        out.header.stamp = stamp
        out.header.frame_id = self._frame_id

    def _imu_message(self, message, stamp):
        imu = Imu()
        self._stamp(imu, stamp)
        rate = [math.radians(rate) for rate in message["rate_dps"]]
        imu.angular_velocity.x, imu.angular_velocity.y, imu.angular_velocity.z = rate
        imu.angular_velocity_covariance = diagonal(
            [math.radians(sigma) ** 2 + self._noise_rad_s**2 for sigma in message["sigma_dps"]])
        imu.orientation_covariance = NOT_MEASURED
        force = message["acceleration_mps2"]
        if force is None:
            imu.linear_acceleration_covariance = NOT_MEASURED
        else:
            imu.linear_acceleration.x, imu.linear_acceleration.y, imu.linear_acceleration.z = force
            imu.linear_acceleration_covariance = NOT_KNOWN
        return imu

    def _bias_message(self, message, stamp):
        bias = Vector3Stamped()
        self._stamp(bias, stamp)
        bias.vector.x, bias.vector.y, bias.vector.z = [math.radians(value) for value in message["bias_dps"]]
        return bias

    def _diagnosis(self, message, stamp):
        alarms = [name for bit, name in enumerate(HEALTH) if bit > 0 and message["health"] >> bit & 1]
        status = DiagnosticStatus()
        status.name = "zerorate: gyro"
        status.hardware_id = self._frame_id
        status.level = DiagnosticStatus.WARN if alarms or not message["calibrated"] else DiagnosticStatus.OK
        status.message = ", ".join(alarms) or ("calibrated" if message["calibrated"] else "not calibrated yet")
        status.values = [KeyValue(key="motion", value=message["motion"]),
                         KeyValue(key="messages lost", value=str(self._lost))]
        array = DiagnosticArray()
        array.header.stamp = stamp
        array.status = [status]
        return array


def main():
    rclpy.init()
    node = ImuNode()
    threading.Thread(target=node.receive, daemon=True).start()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
