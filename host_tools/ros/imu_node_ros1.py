#!/usr/bin/env python3
"""ROS 1 node: the corrected rate of a zerorate node as sensor_msgs/Imu; imu_publisher.py says what it publishes.

    host_tools/ros/imu_node_ros1.py _port:=24680 _frame_id:=imu_link
"""

import pathlib
import sys

import rospy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from imu_publisher import MOTION_TYPES, PARAMETERS, TOPICS, ImuPublisher  # noqa: E402 # pylint: disable=wrong-import-position

NS_PER_S = 1_000_000_000


class Ros:
    """What ImuPublisher wants of ROS."""

    def __init__(self):
        self._topics = {topic: rospy.Publisher(topic, kind, queue_size=10) for topic, kind in TOPICS.items()}

    def publish(self, topic, message):
        try:
            self._topics[topic].publish(message)
        except rospy.ROSException:
            pass  # the topics were closed: the node ends

    def now_ns(self):
        return rospy.Time.now().to_nsec()

    def stamp(self, time_ns):
        return rospy.Time(time_ns // NS_PER_S, time_ns % NS_PER_S)

    def error(self, text):
        rospy.logerr(text)


def main():
    rospy.init_node("zerorate_imu")
    values = {parameter.name: rospy.get_param(f"~{parameter.name}", parameter.default) for parameter in PARAMETERS}
    imu = ImuPublisher(Ros(), values)
    if values["motion_topic"]:
        rospy.Subscriber(values["motion_topic"], MOTION_TYPES[values["motion_type"]], imu.forward)
    rospy.Timer(rospy.Duration(1.0), lambda _: imu.diagnose())
    imu.run(lambda: not rospy.is_shutdown())


if __name__ == "__main__":
    main()
