#!/usr/bin/env python3
"""Display of the launch file in rviz with gui:=true, on a virtual screen. Needs Xvfb and ImageMagick; starts its own
roscore. BELVEDERE_ROS_ARTIFACTS names a folder where the picture is left for people to look at.
"""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import cv2
import numpy
import rospy
from processes import Process, eventually, free_port
from sensor_msgs.msg import Image, PointCloud2

DOMAIN = f"rviz-{os.getpid()}"
#: All sensors of the articles' robots on one robot: the camera that faces up (on a shelf behind), a Kinect, a lidar.
ROBOT = """<robot name="turtlebot" xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:include filename="$(find turtlebot_description)/urdf/turtlebot_library.urdf.xacro"/>
  <kobuki/>
  <stack_hexagons parent="base_link"/>
  <sensor_kinect parent="base_link"/>
  <sensor_rplidar parent="base_link"/>
  <link name="shelf"/>
  <joint name="shelf" type="fixed">
    <parent link="base_link"/><child link="shelf"/><origin xyz="-0.28 0 0.1"/>
  </joint>
  <sensor_camera parent="shelf"/>
</robot>
"""
# The colours in turtlebot.rviz.
BACKGROUND, SCAN = (48, 48, 48), (255, 0, 0)
VIEW = slice(70, 700), slice(370, 850)  # rows and columns of the 3D view on the screen
ROBOT_IN_VIEW = slice(230, 340), slice(195, 285)  # the view is centred on the robot
WOOD = numpy.array([0.55, 0.40, 0.25])  # the plates of the robot's stack, in turtlebot_description
LIKENESS = 0.9  # correlation of a topic's image with the screen


def pixels(image):
    return numpy.frombuffer(image.data, numpy.uint8).reshape(image.height, image.width, 3)


def codes(rgb):
    """Return a number for each colour."""
    return rgb.astype(int) @ [1 << 16, 1 << 8, 1]


def colours(cloud):
    """Return the colours of the cloud's points."""
    offset = next(field.offset for field in cloud.fields if field.name == "rgb")
    points = numpy.frombuffer(cloud.data, numpy.uint8).reshape(-1, cloud.point_step)
    x = points[:, :4].copy().view(numpy.float32)[:, 0]
    rgb = points[numpy.isfinite(x), offset : offset + 3][:, ::-1]
    return numpy.unique(codes(rgb))


def likeness(screen, image):
    """Return the correlation of a topic's image with the screen."""
    best, picture = 0.0, pixels(image)
    for width in range(300, 341, 10):
        small = cv2.resize(picture, (width, width * picture.shape[0] // picture.shape[1]), interpolation=cv2.INTER_AREA)
        # A panel may crop the sides of the image.
        best = max(best, cv2.matchTemplate(screen, small[10:-10, 20:-40], cv2.TM_CCOEFF_NORMED).max())
    return best


class Rviz(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        robot = Path(folder) / "all_sensors.urdf.xacro"
        robot.write_text(ROBOT)
        artifacts = Path(os.environ.get("BELVEDERE_ROS_ARTIFACTS", folder))
        artifacts.mkdir(parents=True, exist_ok=True)
        self.picture = artifacts / "rviz.png"
        screen = "-displayfd", "1", "-screen", "0", "1200x800x24", "+extension", "GLX"
        xvfb = self.enterContext(Process("Xvfb", *screen))
        self.assertTrue(eventually(lambda: xvfb.output().strip().isdigit()), xvfb.output())
        self.display = ":" + xvfb.output().strip()
        port = free_port()
        os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{port}"
        arguments = f"domain:={DOMAIN}", "gui:=true", f"robot:={robot}", "world_file:=tag_ceiling"
        self.environment = {"DISPLAY": self.display, "LIBGL_ALWAYS_SOFTWARE": "1", "XDG_RUNTIME_DIR": folder}
        command = "roslaunch", "-p", port, "belvedere_ros", "turtlebot_world.launch", *arguments
        self.launch = self.enterContext(Process(*command, **self.environment))

    def crash(self):
        """Return the program and the configuration of rviz if a signal has ended it."""
        return re.search(r"process has died \[pid \d+, exit code -\d+, cmd (\S+/rviz) -d (\S+)", self.launch.output())

    def look(self):
        """Return the screen as red, green, blue."""
        subprocess.run(["import", "-display", self.display, "-window", "root", self.picture], check=True, timeout=30)
        return cv2.cvtColor(cv2.imread(str(self.picture)), cv2.COLOR_BGR2RGB)

    def measure(self):
        """Measure the display of each topic."""
        screen = self.look()
        view = screen[VIEW]
        robot = view[ROBOT_IN_VIEW].astype(float)
        brightness = robot.sum(axis=2, keepdims=True) / WOOD.sum()
        is_wood = (abs(robot - brightness * WOOD) < 8).all(axis=2) & (brightness[..., 0] > 40)
        return {
            "camera": likeness(screen, self.messages["/image_raw"]),
            "kinect": likeness(screen, self.messages["/camera/rgb/image_raw"]),
            "scan": int((view == SCAN).all(axis=2).sum()),
            "cloud": int(numpy.isin(codes(view), self.cloud).sum()),
            "robot": float((abs(robot - BACKGROUND).max(axis=2) > 12).mean()),
            "wood": int(is_wood.sum()),
        }

    def is_all_there(self):
        self.seen = self.measure()
        return (
            min(self.seen["camera"], self.seen["kinect"]) > LIKENESS
            and self.seen["scan"] > 200
            and self.seen["cloud"] > 20_000
            and self.seen["robot"] > 0.5
            and self.seen["wood"] > 300
        )

    def test_robot_pictures_cloud_and_scan_are_on_the_screen(self):
        topics = {"/image_raw": Image, "/camera/rgb/image_raw": Image, "/camera/depth/points": PointCloud2}
        self.assertTrue(eventually(lambda: rospy_is_up(self.launch), 30), self.launch.output())
        rospy.init_node("belvedere_test", disable_signals=True)
        self.messages = {topic: rospy.wait_for_message(topic, kind, timeout=30) for topic, kind in topics.items()}
        palette = colours(self.messages["/camera/depth/points"])
        self.cloud = palette[~numpy.isin(palette, codes(numpy.array([BACKGROUND, SCAN])))]
        there = eventually(lambda: self.crash() or self.is_all_there(), 45)
        if crash := self.crash():
            # On a busy machine, rviz sometimes crashes while it starts. What it shows must not depend on that, so it is
            # started once more.
            print("rviz crashed and is started again")
            self.enterContext(Process(crash[1], "-d", crash[2], **self.environment))
            there = eventually(self.is_all_there, 45)
        print(self.seen)
        self.assertTrue(there, f"{self.seen}, see {self.picture}\n{self.launch.output()}")


def rospy_is_up(launch):
    """Return whether the launch file has started its roscore."""
    return "started core service" in launch.output()


if __name__ == "__main__":
    unittest.main(verbosity=2, warnings="ignore")
