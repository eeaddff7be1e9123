#!/usr/bin/env python3
"""ROS 2 node: the corrected rate of a zerorate node as sensor_msgs/Imu; imu_publisher.py says what it publishes.

Not built or run in ROS 2 by the project, because Debian has no rclpy: a test runs it against a stand-in for rclpy, and its
other half, imu_publisher.py, in ROS 1.

    ros2 run zerorate_imu imu_node.py --ros-args --params-file zerorate_imu.yaml
    ros2 launch zerorate_imu zerorate_imu.launch.py
"""

import pathlib
import sys
import threading

import rclpy
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rclpy.time import Time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from imu_publisher import MOTION_TYPES, PARAMETERS, TOPICS, ImuPublisher  # noqa: E402 # pylint: disable=wrong-import-position

DIAGNOSTICS_DEPTH = 10  # reliable: one message a second, and none to be missed


class ImuNode(Node):
    def __init__(self):
        super().__init__("zerorate_imu")
        values = {parameter.name: self.declare_parameter(parameter.name, parameter.default,
                                                         ParameterDescriptor(description=parameter.description)).value
                  for parameter in PARAMETERS}
        # What sensors publish is best effort, so that a slow receiver holds nobody up.
        self._topics = {topic: self.create_publisher(kind, topic, DIAGNOSTICS_DEPTH if topic.startswith("/")
                                                     else qos_profile_sensor_data)
                        for topic, kind in TOPICS.items()}
        self._imu = ImuPublisher(self, values)
        self.create_timer(1.0, self._imu.diagnose)
        if values["motion_topic"]:
            # Best effort takes messages of a reliable publisher, too.
            self.create_subscription(MOTION_TYPES[values["motion_type"]], values["motion_topic"], self._imu.forward,
                                     qos_profile_sensor_data)

    def receive(self):
        self._imu.run(rclpy.ok)

    def publish(self, topic, message):
        self._topics[topic].publish(message)

    def now_ns(self):
        return self.get_clock().now().nanoseconds

    def stamp(self, time_ns):
        return Time(nanoseconds=time_ns).to_msg()

    def error(self, text):
        self.get_logger().error(text)


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
