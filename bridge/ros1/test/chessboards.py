"""A world of chessboards, and a robot that consists only of three cameras, for their calibration.

The boards stand far apart along y. Seen from (0, y of the board, 0) along x, each fills another part of the image, at
another distance and slant, and no other board is in view.
"""

from pathlib import Path

import cv2
import numpy

COLUMNS, ROWS, SQUARE_M = 8, 6, 0.05  # inner corners
BOARDS, APART_M = 36, 20.0
WIDTH, HEIGHT, HFOV_RAD = 640, 480, 1.3962634
FOCAL = WIDTH / 2 / numpy.tan(HFOV_RAD / 2)
DISTORTION = -0.25, 0.08, 0.001, -0.0008, 0.01  # of the second camera: k1 k2 t1 t2 k3
FISHEYE = 0.03, -0.01, 0.004, -0.001  # of the third: k1 k2 k3 k4
MARGIN_PX = 12
PIXELS_PER_SQUARE = 64

PLATE = (COLUMNS + 3) * SQUARE_M, (ROWS + 3) * SQUARE_M  # all squares, with a white margin of one square


def texture():
    """Return the squares with a white margin around them."""
    rows, columns = numpy.indices((ROWS + 3, COLUMNS + 3))
    black = (rows + columns) % 2 == 0
    black[[0, -1], :] = black[:, [0, -1]] = False
    return numpy.kron(numpy.where(black, 0, 255), numpy.ones((PIXELS_PER_SQUARE, PIXELS_PER_SQUARE))).astype(numpy.uint8)


def turn(roll, pitch, yaw):
    """Return the rotation matrix of an SDF pose."""
    (cr, sr), (cp, sp), (cy, sy) = [(numpy.cos(angle), numpy.sin(angle)) for angle in (roll, pitch, yaw)]
    return numpy.array([
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ])  # fmt: skip


def poses():
    """Return the pose of each board relative to the camera (x forward, z up): x, y, z, roll, pitch, yaw."""
    random, found = numpy.random.RandomState(1), []
    corners = numpy.array([[x * PLATE[0] / 2, y * PLATE[1] / 2, 0] for x in (-1, 1) for y in (-1, 1)])
    while len(found) < BOARDS:
        slant, side, spin = random.uniform(-0.6, 0.6, 3)
        place = numpy.array([random.uniform(0.5, 1.0), random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4)])
        angles = spin, -numpy.pi / 2 + slant, side  # the plate's own z points to the camera
        x, y, z = place[:, None] + turn(*angles) @ corners.T
        across, down = FOCAL * abs(y / x), FOCAL * abs(z / x)
        if across.max() < WIDTH / 2 - MARGIN_PX and down.max() < HEIGHT / 2 - MARGIN_PX:
            found.append((*place, *angles))
    return found


def camera(name, distortion=(0.0,) * 5, fisheye=()):
    """Return a camera without noise: which frames the tests get depends on the machine's speed, and with noise so would
    what camera_calibration finds.
    """
    lens = "".join(f"<k{index}>{value}</k{index}>" for index, value in enumerate(fisheye, 1))
    if lens:
        lens = f"<lens><type>kannala_brandt</type>{lens}<intrinsics><fx>{FOCAL}</fx></intrinsics></lens>"
    told = "".join(
        f"<distortion{key}>{value}</distortion{key}>" for key, value in zip(("K1", "K2", "T1", "T2", "K3"), distortion)
    )
    return f"""
<gazebo reference="eye">
  <sensor type="camera" name="{name}">
    <update_rate>30</update_rate>
    <camera>
      <horizontal_fov>{HFOV_RAD}</horizontal_fov>
      <image><width>{WIDTH}</width><height>{HEIGHT}</height><format>L8</format><anti_aliasing>4</anti_aliasing></image>
      <clip><near>0.02</near><far>10</far></clip>
      {lens}
    </camera>
    <plugin name="{name}" filename="libgazebo_ros_camera.so">
      <cameraName>{name}</cameraName><imageTopicName>image_raw</imageTopicName>
      <cameraInfoTopicName>camera_info</cameraInfoTopicName><frameName>eye</frameName>{told}
    </plugin>
  </sensor>
</gazebo>"""


def write(folder):
    """Write robot and world into a folder; return the options of `belvedere run` for them."""
    folder = Path(folder)
    cv2.imwrite(str(folder / "board.png"), texture())
    (folder / "board.material").write_text(
        "material Board\n{\n  technique\n  {\n    pass\n    {\n      ambient 1 1 1 1\n      diffuse 1 1 1 1\n"
        "      texture_unit\n      {\n        texture board.png\n      }\n    }\n  }\n}\n"
    )
    boards = "".join(
        f"""
    <model name="board_{index}"><static>true</static>
      <pose>{x} {y + index * APART_M} {z} {roll} {pitch} {yaw}</pose>
      <link name="plate"><visual name="plate">
        <geometry><box><size>{PLATE[0]} {PLATE[1]} 0.001</size></box></geometry>
        <material><script><uri>file://{folder}</uri><name>Board</name></script></material>
      </visual></link>
    </model>"""
        for index, (x, y, z, roll, pitch, yaw) in enumerate(poses())
    )
    world, robot = folder / "chessboards.world", folder / "cameras.urdf"
    world.write_text(
        f"""<sdf version="1.6"><world name="chessboards">
    <scene><ambient>0.9 0.9 0.9 1</ambient><background>0.5 0.5 0.5 1</background></scene>
    <gravity>0 0 0</gravity>{boards}
</world></sdf>
"""
    )
    robot.write_text(
        f"""<robot name="cameras">
<link name="eye"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
{camera("straight")}
{camera("bent", DISTORTION)}
{camera("fisheye", fisheye=FISHEYE)}
</robot>
"""
    )
    return "--robot", robot, "--world", world
