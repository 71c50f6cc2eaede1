#!/usr/bin/env python3
"""Gazebo's services and topics, as scripts for Gazebo use them. Starts its own roscore."""

import math
import os
import signal
import subprocess
import threading
import time
import unittest
import xmlrpc.client
from collections import Counter
from pathlib import Path

import rosgraph.xmlrpc
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from gazebo_msgs import msg, srv
from gazebo_msgs.msg import LinkStates, ModelState, ModelStates
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3
from nav_msgs.msg import Odometry
from processes import Process, bridge, eventually, free_port, roscore, simulator, subscribers_of_streams
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty

DOMAIN = f"gazebo-{os.getpid()}"
EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "ros1"

#: MD5 sums of ROS Noetic's gazebo_msgs.
SUMS = {
    msg.ContactState: "48c0ffb054b8c444f870cecea1ee50d9",
    msg.ContactsState: "acbcb1601a8e525bf72509f18e6f668d",
    msg.LinkState: "0818ebbf28ce3a08d48ab1eaa7309ebe",
    msg.LinkStates: "48c080191eb15c41858319b4d8a609c2",
    msg.ModelState: "9330fd35f2fcd82d457e54bd54e10593",
    msg.ModelStates: "48c080191eb15c41858319b4d8a609c2",
    srv.DeleteModel: "9ce56b4e9e54616de25d796dc972a262",
    srv.GetLinkState: "09d6c98cce97b35f7ab9bd70300657ab",
    srv.GetModelState: "4c515e936d3319c9610c559c60bfc3d4",
    srv.GetWorldProperties: "36bb0f2eccf4d8be971410c22818ba3f",
    srv.SetModelState: "5b3ab0281d4f5445def017e3a2e4a07b",
    srv.SpawnModel: "9ed9c82c96abe1a00c3e8cdaeee24413",
}

SERVICES = {
    "pause_physics": Empty,
    "unpause_physics": Empty,
    "reset_world": Empty,
    "reset_simulation": Empty,
    "get_model_state": srv.GetModelState,
    "get_link_state": srv.GetLinkState,
    "get_world_properties": srv.GetWorldProperties,
    "set_model_state": srv.SetModelState,
    "spawn_sdf_model": srv.SpawnModel,
    "spawn_urdf_model": srv.SpawnModel,
    "delete_model": srv.DeleteModel,
}

SDF = """
<?xml version="1.0"?>
<sdf version="1.4"><model name="crate"><static>true</static><link name="body">
  <collision name="c"><geometry><box><size>0.4 0.4 1</size></box></geometry></collision>
  <visual name="v"><geometry><box><size>0.4 0.4 1</size></box></geometry></visual>
</link></model></sdf>"""

URDF = """<robot name="ball"><link name="body">
  <inertial><mass value="1"/><inertia ixx="0.004" iyy="0.004" izz="0.004" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><sphere radius="0.1"/></geometry></collision>
  <visual><geometry><sphere radius="0.1"/></geometry></visual>
</link></robot>"""


def pose(x=0.0, y=0.0, z=0.0, yaw=0.0):
    return Pose(Point(x, y, z), Quaternion(0, 0, math.sin(yaw / 2), math.cos(yaw / 2)))


def xyz(point):
    return point.x, point.y, point.z


class Face:
    """All services, as functions, under a namespace."""

    def __init__(self, namespace="/gazebo"):
        self.namespace = namespace
        for name, kind in SERVICES.items():
            setattr(self, name, rospy.ServiceProxy(f"{namespace}/{name}", kind))

    def wait(self):
        for name in SERVICES:
            rospy.wait_for_service(f"{self.namespace}/{name}", 15)


class Door(rosgraph.xmlrpc.ThreadingXMLRPCServer):
    """A proxy of the master that answers the nodes that look for a service together, once all of them have asked."""

    request_queue_size = 64  # nodes make many calls at once
    daemon_threads = True

    def __init__(self, master, askers):
        super().__init__(("127.0.0.1", 0), log_requests=False)
        self.master, self.uri = master, f"http://127.0.0.1:{self.server_address[1]}"
        self.answered, self.together = set(), threading.Barrier(askers, timeout=20)

    def _dispatch(self, method, parameters):
        answer = getattr(xmlrpc.client.ServerProxy(self.master), method)(*parameters)
        if method == "lookupService" and parameters[0] not in self.answered:
            self.answered.add(parameters[0])
            self.together.wait()
        return answer

    def __enter__(self):
        threading.Thread(target=self.serve_forever, daemon=True).start()
        return self

    def __exit__(self, *_):
        self.shutdown()
        self.server_close()


class Gazebo(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        port = free_port()
        os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{port}"
        cls.master = xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"])
        cls.core = cls.enterClassContext(roscore(port))
        assert eventually(cls.knows), cls.core.output()
        cls.simulator = cls.enterClassContext(simulator(DOMAIN))
        cls.node = cls.enterClassContext(bridge(DOMAIN))
        assert eventually(lambda: cls.master.hasParam("/test", "/use_sim_time")[2]), cls.node.output()
        rospy.init_node("test_gazebo", disable_signals=True)
        cls.face = Face()
        cls.face.wait()

    @classmethod
    def knows(cls):
        try:
            return cls.master.getPid("/test")[0] == 1
        except OSError:
            return False

    def setUp(self):
        """Restore the initial models."""
        for name in set(self.face.get_world_properties().model_names) - {"tag_room", "tag_ceiling", "turtlebot"}:
            self.face.delete_model(name)
        self.face.unpause_physics()
        self.face.reset_simulation()

    def done(self, answer, message=None):
        self.assertTrue(answer.success, answer.status_message)
        if message:
            self.assertEqual(answer.status_message, message)
        return answer

    def refused(self, answer, *words):
        self.assertFalse(answer.success)
        for word in words:
            self.assertIn(word, answer.status_message)

    def near(self, found, expected, tolerance=1e-3):
        for one, other in zip(found, expected):
            self.assertAlmostEqual(one, other, delta=tolerance, msg=f"{found} instead of {expected}")

    def position(self, model, reference=""):
        return xyz(self.done(self.face.get_model_state(model, reference)).pose.position)

    def in_stream(self, model):
        """Return the position of a model by the topic; None if it is missing."""
        states = rospy.wait_for_message("/gazebo/model_states", ModelStates, 5)
        return xyz(states.pose[states.name.index(model)].position) if model in states.name else None

    def test_definitions_are_those_of_noetic(self):
        for kind, expected in SUMS.items():
            self.assertEqual(kind._md5sum, expected, kind._type)
        self.assertEqual(len(SUMS), sum(hasattr(kind, "_md5sum") for kind in vars(msg).values()) +
                         sum(issubclass(type(kind), type) and hasattr(kind, "_request_class") for kind in vars(srv).values()))

    def test_programs_of_ros_know_them(self):
        for command, said in {
            "rosmsg show gazebo_msgs/ModelStates": "geometry_msgs/Twist[] twist",
            "rossrv md5 gazebo_msgs/SpawnModel": SUMS[srv.SpawnModel],
            "rosservice call /gazebo/get_world_properties": "GetWorldProperties: got properties",
            "rostopic echo -n 1 /gazebo/link_states": "turtlebot::base_footprint",
        }.items():
            done = subprocess.run(command.split(), capture_output=True, text=True, timeout=20, check=False)
            self.assertIn(said, done.stdout, done.stderr)

    def test_the_world_and_its_models(self):
        world = self.done(self.face.get_world_properties(), "GetWorldProperties: got properties")
        self.assertEqual(world.model_names, ["tag_room", "tag_ceiling", "turtlebot"])
        self.assertTrue(world.rendering_enabled)
        self.assertTrue(eventually(lambda: self.face.get_world_properties().sim_time > world.sim_time + 0.1))
        states = rospy.wait_for_message("/gazebo/model_states", ModelStates, 5)
        self.assertEqual(states.name, world.model_names)
        self.near(xyz(states.pose[1].position), (0, 0, 2.5))
        links = rospy.wait_for_message("/gazebo/link_states", LinkStates, 5)
        self.assertIn("tag_room::room", links.name)

        ceiling = self.done(self.face.get_model_state("tag_ceiling", "world"), "GetModelState: got properties")
        self.near(xyz(ceiling.pose.position), (0, 0, 2.5))
        self.assertEqual(ceiling.header.frame_id, "world")
        self.assertGreater(ceiling.header.stamp.to_sec(), 0)
        base = self.done(self.face.get_link_state("turtlebot::base_link", "world"), "GetLinkState: got state").link_state
        self.near(xyz(base.pose.position), xyz(links.pose[links.name.index("turtlebot::base_link")].position))
        self.assertEqual((base.link_name, base.reference_frame), ("turtlebot::base_link", "world"))

        self.refused(self.face.get_model_state("turtle", ""), "GetModelState: model does not exist", "'turtle'", "turtlebot")
        self.refused(self.face.get_model_state("turtlebot", "moon"), "relative_entity_name not found", "'moon'")
        self.refused(self.face.get_link_state("turtlebot::nose", ""), "link not found", "'turtlebot::nose'")
        self.refused(self.face.get_link_state("turtlebot::base_link", "moon"), "reference_frame not found", "'moon'")

    def test_states_are_given_in_any_frame(self):
        self.face.pause_physics()
        moved = ModelState("turtlebot", pose(1, 1, 0, math.pi / 2), Twist(Vector3(0.5, 0, 0), Vector3(0, 0, 0.25)), "map")
        self.done(self.face.set_model_state(moved), "SetModelState: set model state done")
        self.near(self.position("tag_ceiling", "turtlebot"), (-1, 1, 2.5))
        ceiling = self.face.get_model_state("tag_ceiling", "turtlebot").twist
        self.near(xyz(ceiling.linear) + xyz(ceiling.angular), (0, 0.5, 0, 0, 0, -0.25))
        base = self.position("turtlebot", "turtlebot::base_footprint")
        self.near(base, (0, 0, 0))
        self.near(self.position("turtlebot", "base_footprint"), base)
        foot = self.done(self.face.get_link_state("turtlebot::base_footprint", "tag_ceiling")).link_state
        self.near(xyz(foot.pose.position), (1, 1, -2.5))
        self.near(xyz(foot.twist.linear), (0.5, 0, 0))
        self.near((foot.pose.orientation.z, foot.pose.orientation.w), (math.sqrt(0.5), math.sqrt(0.5)))

    def test_a_pause(self):
        clocks = []
        subscriber = rospy.Subscriber("/clock", Clock, lambda clock: clocks.append(clock.clock))
        self.assertTrue(eventually(lambda: len(clocks) > 3))
        self.face.pause_physics()
        time.sleep(0.1)
        before, sim_time = len(clocks), self.face.get_world_properties().sim_time
        time.sleep(0.5)
        self.assertEqual(len(clocks), before, "/clock goes on")
        self.assertEqual(self.face.get_world_properties().sim_time, sim_time)
        self.near(self.position("turtlebot"), (0, 0, 0))
        self.assertIsNotNone(self.in_stream("turtlebot"), "who comes in a pause sees nothing")
        begin = time.monotonic()
        for x in range(10):
            self.done(self.face.set_model_state(ModelState("turtlebot", pose(x * 0.1), Twist(), "")))
            self.near(self.position("turtlebot"), (x * 0.1, 0, 0), 1e-6)
        self.assertLess(time.monotonic() - begin, 2.0)
        self.face.unpause_physics()
        self.assertTrue(eventually(lambda: len(clocks) > before + 3), "/clock stands")
        subscriber.unregister()

    def test_moving(self):
        there = ModelState("tag_ceiling", pose(0, 0, 2.9), Twist(), "world")
        self.done(self.face.set_model_state(there))
        self.near(self.position("tag_ceiling"), (0, 0, 2.9))
        there = ModelState("tag_ceiling", pose(0.25, 0, 2.7), Twist(), "turtlebot")
        self.done(self.face.set_model_state(there))
        self.near(self.in_stream("tag_ceiling"), (0.25, 0, 2.7), 0.02)
        there.pose.orientation = Quaternion()  # not filled in, as in many scripts
        self.done(self.face.set_model_state(there))

        self.refused(self.face.set_model_state(ModelState("moon", pose(), Twist(), "")), "SetModelState: ", "no model 'moon'")
        self.refused(self.face.set_model_state(ModelState("turtlebot", pose(), Twist(), "moon")), "reference frame 'moon'")
        self.refused(self.face.set_model_state(ModelState("turtlebot", pose(math.nan), Twist(), "")), "position")
        self.refused(self.face.set_model_state(ModelState("m" * 64, pose(), Twist(), "")), "more than 63 bytes")

        topic = rospy.Publisher("/gazebo/set_model_state", ModelState, queue_size=1)
        self.assertTrue(eventually(lambda: topic.get_num_connections() > 0))
        topic.publish(ModelState("tag_ceiling", pose(0, 0, 2.2), Twist(), ""))
        self.assertTrue(eventually(lambda: self.position("tag_ceiling")[2] == 2.2))
        topic.publish(ModelState("moon", pose(), Twist(), ""))
        self.assertTrue(self.node.says("there is no model 'moon'"), self.node.output())
        topic.unregister()

    def test_models_come_and_go(self):
        ahead = lambda: (lambda scan: scan.ranges[round(-scan.angle_min / scan.angle_increment)])(  # noqa: E731
            rospy.wait_for_message("/scan", LaserScan, 5)
        )
        free = ahead()
        self.assertGreater(free, 2)
        crate = self.face.spawn_sdf_model("crate", SDF, "/crate", pose(1.5, 0, 0.5), "turtlebot")
        self.done(crate, "SpawnModel: Successfully spawned entity")
        self.near(self.position("crate"), (1.5, 0, 0.5))
        self.near(self.in_stream("crate"), (1.5, 0, 0.5))
        self.assertTrue(eventually(lambda: abs(ahead() - 1.3) < 0.2), "the lidar does not see it")
        self.assertIn("crate", self.face.get_world_properties().model_names)

        self.done(self.face.spawn_urdf_model("ball", URDF, "", pose(-1, 0, 1), ""))
        self.assertTrue(eventually(lambda: abs(self.position("ball")[2] - 0.1) < 0.01), "it does not fall")

        self.refused(self.face.spawn_sdf_model("crate", SDF, "", pose(), ""), "SpawnModel: ", "a model 'crate' already")
        self.refused(self.face.spawn_sdf_model("other", "", "", pose(), ""), "broken XML")
        self.refused(self.face.spawn_urdf_model("other", "<robot name='r'>", "", pose(), ""), "other:1", "broken XML")
        self.refused(self.face.spawn_sdf_model("other", SDF, "", pose(), "moon"), "reference frame 'moon'")
        self.refused(self.face.spawn_sdf_model("o" * 64, SDF, "", pose(), ""), "more than 63 bytes")

        self.done(self.face.delete_model("crate"), "DeleteModel: successfully deleted model")
        self.assertNotIn("crate", self.face.get_world_properties().model_names)
        self.assertTrue(eventually(lambda: abs(ahead() - free) < 0.2), "the lidar sees it still")
        self.refused(self.face.delete_model("crate"), "DeleteModel: ", "no model 'crate'")

    def test_resets(self):
        odometry = []
        subscriber = rospy.Subscriber("/odom", Odometry, odometry.append)
        commands = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        self.assertTrue(eventually(lambda: odometry and commands.get_num_connections() > 0))
        commands.publish(Twist(Vector3(0.5, 0, 0), Vector3()))
        self.assertTrue(eventually(lambda: odometry[-1].pose.pose.position.x > 0.2))
        commands.publish(Twist())
        self.assertGreater(self.position("turtlebot")[0], 0.1)
        sim_time = self.face.get_world_properties().sim_time

        self.face.reset_world()
        self.near(self.position("turtlebot"), (0, 0, 0), 0.02)
        self.assertGreater(self.face.get_world_properties().sim_time, sim_time)

        self.face.reset_simulation()
        self.assertLess(self.face.get_world_properties().sim_time, sim_time)
        self.near(self.position("turtlebot"), (0, 0, 0), 0.02)
        before = len(odometry)
        self.assertTrue(eventually(lambda: len(odometry) > before + 5), "topics stand after a reset")
        last = odometry[-1]
        self.assertLess(last.header.stamp.to_sec(), sim_time)
        self.near(xyz(last.pose.pose.position), (0, 0, 0), 0.02)
        subscriber.unregister()
        commands.unregister()

    def test_unused_streams_are_released(self):
        followed = lambda: [topic for topic in subscribers_of_streams(DOMAIN).items() if "/simulation/" in topic[0] and topic[1]]  # noqa: E731
        self.position("turtlebot")
        self.assertTrue(followed())
        self.assertTrue(eventually(lambda: not followed(), 20), followed())

    def test_a_simulator_that_does_not_answer_delays_nothing_else(self):
        answers = []
        self.simulator.child.send_signal(signal.SIGSTOP)
        try:
            callers = [threading.Thread(target=lambda: answers.append(self.face.delete_model("nobody"))) for _ in range(3)]
            for caller in callers:
                caller.start()
            time.sleep(0.3)
            rospy.wait_for_message("/diagnostics", DiagnosticArray, 1.5)
            self.assertEqual(answers, [])
        finally:
            self.simulator.child.send_signal(signal.SIGCONT)
        for caller in callers:
            caller.join(10)
        for answer in answers:
            self.refused(answer, "no model 'nobody'")
        self.assertEqual(len(answers), 3)

    def test_without_a_simulator_requests_fail_at_once(self):
        domain = DOMAIN + "-gone"
        face = Face("/elsewhere/gazebo")
        with simulator(domain) as robot, bridge(domain, "__ns:=/elsewhere", "_gazebo_namespace:=gazebo") as node:
            face.wait()
            self.done(face.get_model_state("turtlebot", ""))
            robot.stop(signal.SIGKILL)
            time.sleep(0.3)  # states are current for a quarter of a second
            arguments = {
                "get_model_state": ("turtlebot", ""),
                "get_link_state": ("turtlebot::base_link", ""),
                "set_model_state": (ModelState("turtlebot", pose(), Twist(), ""),),
                "spawn_sdf_model": ("crate", SDF, "", pose(), ""),
                "spawn_urdf_model": ("ball", URDF, "", pose(), ""),
                "delete_model": ("turtlebot",),
            }
            for name, kind in SERVICES.items():
                with self.subTest(name):
                    begin = time.monotonic()
                    words = f"there is no simulator in domain {domain}"
                    if kind is Empty:
                        with self.assertRaisesRegex(rospy.ServiceException, words):
                            getattr(face, name)()
                    else:
                        self.refused(getattr(face, name)(*arguments.get(name, ())), words)
                    self.assertLess(time.monotonic() - begin, 2.0)
            with simulator(domain, "--paused"):
                self.assertTrue(eventually(lambda: face.get_model_state("turtlebot", "").success), node.output())
                self.assertEqual(face.get_world_properties().sim_time, 0)
                face.unpause_physics()
                self.assertTrue(eventually(lambda: face.get_world_properties().sim_time > 0.1), node.output())

    def test_a_second_node_does_not_serve(self):
        with bridge(DOMAIN, "__name:=second", "_publish_clock:=false") as node:
            self.assertTrue(node.says("another node serves /gazebo, so this one does not while that runs"), node.output())
            self.assertIn("give it a ~gazebo_namespace of its own", node.output())
        with bridge(DOMAIN, "__name:=silent", "_publish_clock:=false", "_gazebo_namespace:=") as node:
            self.assertTrue(node.says("/image_raw"), node.output())
            self.assertNotIn("/gazebo/", node.output())
        self.done(self.face.get_world_properties())
        with bridge(DOMAIN, "__name:=wrong", "_gazebo_namespace:=no good") as node:
            self.assertTrue(node.says("/wrong/gazebo_namespace is no good; it must be a namespace"), node.output())
            self.assertEqual(node.child.wait(10), 1)

    def servers(self, namespace):
        """Count the services and topics of a namespace by node."""
        topics, _, services = self.master.getSystemState("/test")[2]
        return Counter(node for name, nodes in topics + services if name.startswith(namespace + "/") for node in nodes)

    def test_one_of_two_nodes_that_start_together_serves(self):
        """The other node logs this once, and serves when the first one ends."""
        arguments = DOMAIN, "_publish_clock:=false", "_gazebo_namespace:=/both"
        everything = len(SERVICES) + len(("model_states", "link_states"))
        with (
            Door(os.environ["ROS_MASTER_URI"], 2) as door,
            bridge(*arguments, "__name:=one", ROS_MASTER_URI=door.uri) as one,
            bridge(*arguments, "__name:=other", ROS_MASTER_URI=door.uri) as other,
        ):
            nodes = {"/one": one, "/other": other}
            self.assertTrue(eventually(lambda: list(self.servers("/both").values()) == [everything]), self.servers("/both"))
            time.sleep(1.5)  # three checks
            (winner,) = self.servers("/both")
            (loser,) = nodes.keys() - {winner}
            warning = "another node serves /both, so this one does not while that runs"
            self.assertEqual([nodes[name].output().count(warning) for name in (winner, loser)], [0, 1])
            self.assertEqual(nodes[winner].stop(), 0, nodes[winner].output())
            self.assertTrue(eventually(lambda: self.servers("/both") == {loser: everything}), self.servers("/both"))
            self.done(Face("/both").get_model_state("turtlebot", ""))

    def test_a_node_that_takes_a_service_gets_all(self):
        """The master gives a service to the last node that registers it, without notice to the others."""
        domain = DOMAIN + "-taken"
        with simulator(domain), bridge(domain, "__name:=robbed", "_publish_clock:=false", "_gazebo_namespace:=/taken") as node:
            served = lambda: self.servers("/taken")["/robbed"] == len(SERVICES) + 2  # noqa: E731
            self.assertTrue(eventually(served), node.output())
            taker = rospy.Service("/taken/get_world_properties", srv.GetWorldProperties, lambda _: None)
            self.assertTrue(node.says("another node serves /taken"), node.output())
            self.assertTrue(eventually(lambda: self.servers("/taken") == {rospy.get_name(): 1}), self.servers("/taken"))
            taker.shutdown()
            self.assertTrue(node.says("serving /taken, as the other node has ended"), node.output())
            self.assertTrue(eventually(served), node.output())

    def test_the_nodelet_has_it_too(self):
        nodelet = "/usr/lib/nodelet/nodelet" if os.path.exists("/usr/lib/nodelet/nodelet") else "nodelet"
        names = "__name:=bridge", "__ns:=/let", f"_domain:={DOMAIN}", "_publish_clock:=false", "_gazebo_namespace:=gazebo"
        with Process(nodelet, "standalone", "belvedere_ros/bridge", *names) as node:
            face = Face("/let/gazebo")
            try:
                face.wait()
            except rospy.ROSException:
                self.fail(node.output())
            self.near(xyz(self.done(face.get_model_state("tag_ceiling", "")).pose.position), (0, 0, 2.5))

    def test_the_example(self):
        done = subprocess.run([EXAMPLES / "spawn_box.py"], capture_output=True, text=True, timeout=30, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(
            done.stdout.splitlines(),
            [
                "SpawnModel: Successfully spawned entity",
                "fallen: 1.50 0.00 0.15",
                "held up: 1.50 1.00 1.00",
                "fallen again: 1.50 1.00 0.15",
                "DeleteModel: successfully deleted model",
            ],
        )


if __name__ == "__main__":
    unittest.main(verbosity=2, warnings="ignore")  # rospy leaves sockets to the garbage collector
