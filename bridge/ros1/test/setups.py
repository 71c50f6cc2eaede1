"""The articles' robots as seen by a ROS program: topics, types, frames, rates, sizes and intrinsics.

Focal lengths are those of the field of view. The principal point is ((w - 1) / 2, (h - 1) / 2) with pixel centres at
integers, or ((w + 1) / 2, (h + 1) / 2) as Gazebo says in its camera_info.
"""

from dataclasses import dataclass, field
from math import isnan, nan, pi, tan


@dataclass
class Topic:
    type: str
    frame: str = ""
    rate: float = 0.0  # Hz; 0: once; NaN: events
    fields: dict = field(default_factory=dict)  # expected fields of the message, by name
    length: int = -1  # length of the payload

    def is_event(self):
        return isnan(self.rate)


@dataclass
class Setup:
    environment: dict
    topics: dict


def image(frame, rate, encoding="rgb8", size=3):
    fields = {"encoding": encoding, "width": 640, "height": 480, "step": 640 * size, "is_bigendian": 0}
    return Topic("sensor_msgs/Image", frame, rate, fields, 640 * 480 * size)


def camera_info(frame, rate, hfov, baseline, compat):
    focal = 320.0 / tan(hfov / 2.0)
    cx, cy = (320.5, 240.5) if compat else (319.5, 239.5)
    return Topic("sensor_msgs/CameraInfo", frame, rate, {
        "width": 640, "height": 480, "distortion_model": "plumb_bob", "D": [0.0] * 5,
        "K": [focal, 0, cx, 0, focal, cy, 0, 0, 1],
        "R": [1, 0, 0, 0, 1, 0, 0, 0, 1],
        "P": [focal, 0, cx, -focal * baseline, 0, focal, cy, 0, 0, 0, 1, 0],
    })  # fmt: skip


def scan(frame, rate, samples, half_angle, near, far, compat):
    return Topic("sensor_msgs/LaserScan", frame, rate, {
        "angle_min": -half_angle, "angle_max": half_angle, "angle_increment": 2 * half_angle / (samples - 1),
        "range_min": near, "range_max": far,
        # All rays have the same time; gazebo_ros_laser leaves both at 0.
        "time_increment": 0.0, "scan_time": 0.0 if compat else 1.0 / rate,
    }, samples)  # fmt: skip


def cloud(frame, rate):
    fields = {"width": 640, "height": 480, "point_step": 32, "row_step": 640 * 32, "is_bigendian": False}
    return Topic("sensor_msgs/PointCloud2", frame, rate, fields, 640 * 480 * 32)


#: Covariance of x, y and yaw; planar odometry does not measure the rest.
POSE_COVARIANCE = [[0.1, 0.1, 1e6, 1e6, 1e6, 0.05][i // 7] if i % 7 == 0 else 0.0 for i in range(36)]

ROBOT = {
    "/clock": Topic("rosgraph_msgs/Clock", rate=100.0),
    "/odom": Topic("nav_msgs/Odometry", "odom", 50.0, {"child_frame_id": "base_footprint", "pose.covariance": POSE_COVARIANCE}),
    "/mobile_base/sensors/core": Topic("kobuki_msgs/SensorState", rate=50.0, fields={"bumper": 0, "cliff": 0, "wheel_drop": 0}),
    "/mobile_base/events/bumper": Topic("kobuki_msgs/BumperEvent", rate=nan),
    "/mobile_base/events/cliff": Topic("kobuki_msgs/CliffEvent", rate=nan),
    "/mobile_base/events/wheel_drop": Topic("kobuki_msgs/WheelDropEvent", rate=nan),
    "/mobile_base/sensors/imu_data": Topic("sensor_msgs/Imu", "gyro_link", 50.0),
    "/joint_states": Topic(
        "sensor_msgs/JointState", rate=50.0, fields={"name": ["wheel_left_joint", "wheel_right_joint"]}
    ),
    "/tf": Topic("tf2_msgs/TFMessage", rate=50.0),
    "/tf_static": Topic("tf2_msgs/TFMessage"),
}


def ceiling_camera(compat):
    """Return the set-up of the monocular camera that faces the ceiling, with the robot's lidar."""
    # Gazebo gives images the frame of the link, which faces along x.
    frame = "base_camera_link" if compat else "base_camera_link_optical"
    return Setup(
        {"TURTLEBOT_STACKS": "nostack", "TURTLEBOT_3D_SENSOR": "camera"},
        {
            **ROBOT,
            "/image_raw": image(frame, 30.0),
            "/camera_info": camera_info(frame, 30.0, 1.3962634, 0.07, compat),
            "/scan": scan("base_laser_link", 5.5, 360, 3.1415926, 0.10, 6.0, compat),
        },
    )


def rplidar(compat):
    """Return the set-up of the lidar alone. With 360 rays over the circle the first equals the last, as in Gazebo."""
    return Setup(
        {"TURTLEBOT_STACKS": "nostack", "TURTLEBOT_3D_SENSOR": "rplidar"},
        {**ROBOT, "/scan": scan("base_laser_link", 5.5, 360, 3.1415926, 0.10, 6.0, compat)},
    )


def kinect_hokuyo(compat):
    """Return the set-up of the Kinect (20 Hz, 10 Hz by its plugin) and the Hokuyo."""
    frame = "camera_depth_optical_frame"
    # The plugin does not read its <baseline> of 0.1 (it would read <hackBaseline>).
    info = camera_info(frame, 10.0, 60.0 * pi / 180.0, 0.0, compat)
    return Setup(
        {"TURTLEBOT_STACKS": "hexagons", "TURTLEBOT_3D_SENSOR": "KinectHokuyo"},
        {
            **ROBOT,
            "/camera/rgb/image_raw": image(frame, 10.0),
            "/camera/rgb/camera_info": info,
            "/camera/depth/image_raw": image(frame, 10.0, "32FC1", 4),
            "/camera/depth/camera_info": info,
            "/camera/depth/points": cloud(frame, 10.0),
            "/rrbot/laser/scan": scan("hokuyo_link", 40.0, 720, 1.570796, 0.10, 30.0, compat),
        },
    )


#: The set-ups by name; each as described, or with Gazebo's values.
SETUPS = {"the ceiling camera": ceiling_camera, "RPLidar": rplidar, "Kinect and Hokuyo": kinect_hokuyo}
