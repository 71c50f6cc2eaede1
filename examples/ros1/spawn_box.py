#!/usr/bin/env python3
"""Use Gazebo's services to spawn a box in front of the robot, print its position, move it while paused, and delete it."""

import sys

import rospy
from gazebo_msgs.msg import ModelState
from gazebo_msgs.srv import DeleteModel, GetModelState, SetModelState, SpawnModel
from geometry_msgs.msg import Point, Pose, Quaternion
from std_srvs.srv import Empty

BOX = """<?xml version="1.0"?>
<sdf version="1.6">
  <model name="box">
    <link name="link">
      <inertial><mass>1</mass><inertia><ixx>0.015</ixx><iyy>0.015</iyy><izz>0.015</izz></inertia></inertial>
      <collision name="collision"><geometry><box><size>0.3 0.3 0.3</size></box></geometry></collision>
      <visual name="visual"><geometry><box><size>0.3 0.3 0.3</size></box></geometry></visual>
    </link>
  </model>
</sdf>"""


def service(name, kind):
    rospy.wait_for_service("/gazebo/" + name)
    proxy = rospy.ServiceProxy("/gazebo/" + name, kind)

    def call(*arguments):
        answer = proxy(*arguments)
        if not getattr(answer, "success", True):
            sys.exit(answer.status_message)
        return answer

    return call


def show(what):
    at = service("get_model_state", GetModelState)("box", "world").pose.position
    print(f"{what}: {at.x:.2f} {at.y:.2f} {at.z:.2f}")


def main():
    rospy.init_node("spawn_box")
    pose = Pose(Point(1.5, 0, 0.5), Quaternion(0, 0, 0, 1))
    print(service("spawn_sdf_model", SpawnModel)("box", BOX, "", pose, "world").status_message)
    rospy.sleep(1.0)  # in simulated time
    show("fallen")
    service("pause_physics", Empty)()
    state = ModelState(model_name="box", reference_frame="world")
    state.pose = Pose(Point(1.5, 1, 1), Quaternion(0, 0, 0, 1))
    service("set_model_state", SetModelState)(state)
    show("held up")
    service("unpause_physics", Empty)()
    rospy.sleep(1.0)
    show("fallen again")
    print(service("delete_model", DeleteModel)("box").status_message)


if __name__ == "__main__":
    main()
