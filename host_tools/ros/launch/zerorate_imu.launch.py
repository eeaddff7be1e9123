"""Starts the node with the parameters of config/zerorate_imu.yaml, or of the file params:=FILE."""

import pathlib

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    config = pathlib.Path(get_package_share_directory("zerorate_imu")) / "config"
    return LaunchDescription([
        DeclareLaunchArgument("params", default_value=str(config / "zerorate_imu.yaml"), description="file of parameters"),
        DeclareLaunchArgument("namespace", default_value="", description="in front of imu/data and the others"),
        Node(package="zerorate_imu", executable="imu_node.py", name="zerorate_imu", namespace=LaunchConfiguration("namespace"),
             parameters=[LaunchConfiguration("params")], output="screen"),
    ])
