"""rclpy controls a simulation by the services of `belvedere ros2`, and a replay as far as that goes (`.ci/ros2`).

services.py BELVEDERE RECORDING: the program, and a recording.
"""

import fcntl
import json
import os
import signal
import sys
import tempfile
import termios
import time
from pathlib import Path

import kit
import rclpy
import simulation_interfaces
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, Twist, Vector3
from rcl_interfaces.srv import GetParameters
from rclpy.executors import SingleThreadedExecutor
from rosgraph_msgs.msg import Clock
from simulation_interfaces import srv
from simulation_interfaces.msg import Bounds, EntityCategory, EntityFilters, EntityState, SimulationState, SpawnEntity, TagsFilter
from std_msgs.msg import Header

BELVEDERE, RECORDING = sys.argv[1:]
HASHES = json.loads(Path(simulation_interfaces.__file__).with_name("hashes.json").read_text())
ROBOT = "turtlebot"
UNSUPPORTED, OK, NOT_FOUND, FAILED = 0, 1, 2, 4
STOPPED, PLAYING, PAUSED, QUITTING, NO_WORLD = range(5)
BOX = """<sdf version="1.7"><model name="box"><link name="link"><collision name="c"><geometry><box><size>0.2 0.2 0.2</size>
</box></geometry></collision></link></model></sdf>"""
WALL = BOX.replace('name="box">', 'name="wall"><static>true</static>')
LONGEST_S = 15.0


def snake(name):
    return "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name).strip("_")


class Caller:
    """Calls services, from one thread after another."""

    def __init__(self):
        self.node = rclpy.create_node("caller")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.clients = {}

    def client(self, name, prefix=""):
        kind, topic = getattr(srv, name), f"{prefix}/{snake(name)}"
        if topic not in self.clients:
            self.clients[topic] = self.node.create_client(kind, topic)
            assert self.clients[topic].wait_for_service(LONGEST_S), f"{topic} is not there"
        return kind, self.clients[topic]

    def begin(self, name, prefix="", /, **fields):
        kind, client = self.client(name, prefix)
        return client.call_async(kind.Request(**fields))

    def end(self, future, name, seconds=LONGEST_S):
        self.executor.spin_until_future_complete(future, seconds)
        assert future.done(), f"{name} is not answered within {seconds} s"
        return future.result()

    def call(self, name, prefix="", /, **fields):
        return self.end(self.begin(name, prefix, **fields), name)

    def expect(self, code, name, says="", /, **fields):
        """Calls a service, whose result must have this code, and these words in its message."""
        response = self.call(name, **fields)
        result = response.result
        assert result.result == code and says in result.error_message, f"{name}({fields}): {result}, not {code} '{says}'"
        assert (code == OK) == (not result.error_message), f"{name}: {result}"
        return response


def until(done, what):
    end = time.monotonic() + LONGEST_S
    while not done():
        assert time.monotonic() < end, what
        time.sleep(0.05)


def state_at(x, y, z=0.0, frame="", **twist):
    pose = Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(w=1.0))
    return EntityState(header=Header(frame_id=frame), pose=pose, twist=Twist(**twist))


def pose_at(x, y, z=0.0, frame=""):
    return PoseStamped(header=Header(frame_id=frame), pose=state_at(x, y, z).pose)


def names(caller, **filters):
    return sorted(caller.expect(OK, "GetEntities", filters=EntityFilters(**filters)).entities)


def judge_state(caller):
    """The simulation was started with --paused."""
    features = caller.call("GetSimulatorFeatures").features
    assert {0, 1, 10, 11, 20, 24, 25, 31, 50} <= set(features.features) and "urdf" in features.spawn_formats, features
    state = lambda: caller.expect(OK, "GetSimulationState").state.state
    set_to = lambda code, number, says="": caller.expect(code, "SetSimulationState", says, state=SimulationState(state=number))
    assert state() == STOPPED
    set_to(101, STOPPED, "already")
    set_to(OK, PAUSED)
    assert state() == PAUSED
    caller.expect(OK, "StepSimulation", steps=50)
    stamp = caller.expect(OK, "GetEntityState", entity=ROBOT).state.header.stamp
    assert (stamp.sec, stamp.nanosec) == (0, 250_000_000), stamp
    caller.expect(FAILED, "StepSimulation", "0 steps", steps=0)
    set_to(OK, PLAYING)
    assert state() == PLAYING
    caller.expect(FAILED, "StepSimulation", "not paused", steps=1)
    set_to(UNSUPPORTED, QUITTING, "Ctrl-C")
    set_to(UNSUPPORTED, 9, "state 9")
    set_to(OK, PAUSED)
    # Steps that take long: other services answer meanwhile, and a pause ends them.
    steps = caller.begin("StepSimulation", steps=10_000_000)
    until(lambda: state() == PLAYING, "steps do not begin")
    set_to(OK, PAUSED)
    ended = caller.end(steps, "StepSimulation").result
    assert ended.result == FAILED and "ended by a pause" in ended.error_message, ended
    set_to(OK, STOPPED)
    assert state() == STOPPED


def judge_entities(caller):
    caller.expect(OK, "SetSimulationState", state=SimulationState(state=PAUSED))
    both = [spawn_request("box_1", BOX), spawn_request("wall_1", WALL)]
    results = caller.expect(OK, "SpawnEntities", spawn_requests=both).results
    assert [each.entity_name for each in results] == ["box_1", "wall_1"], results
    everything = names(caller)
    assert {"box_1", "wall_1", ROBOT} <= set(everything), everything
    assert names(caller, filter="^(box|wall)_[[:digit:]]$") == ["box_1", "wall_1"]
    assert names(caller, filter="no such name") == []
    caller.expect(FAILED, "GetEntities", "unclosed group", filters=EntityFilters(filter="("))
    caller.expect(UNSUPPORTED, "GetEntities", "no tags", filters=EntityFilters(tags=TagsFilter(tags=["red"])))
    caller.expect(UNSUPPORTED, "GetEntities", "bounds", filters=EntityFilters(bounds=Bounds(type=3)))
    of = lambda category: names(caller, categories=[EntityCategory(category=category)])
    assert of(1) == [ROBOT] and of(0) == ["box_1"] and "wall_1" in of(5), (of(1), of(0), of(5))
    assert caller.expect(OK, "GetEntityInfo", entity="wall_1").info.category.category == 5
    caller.expect(NOT_FOUND, "GetEntityInfo", "box_1", entity="box_2")

    caller.expect(OK, "SetEntityState", entity="box_1", state=state_at(1.0, 2.0, 3.0, linear=Vector3(x=0.5)))
    caller.expect(OK, "SetEntityState", entity="wall_1", state=state_at(0.0, 1.0, frame="box_1"))
    states = caller.expect(OK, "GetEntitiesStates", filters=EntityFilters(filter="_1"))
    found = dict(zip(states.entities, states.states))
    box, wall = found["box_1"], found["wall_1"]
    near = lambda point, *values: all(abs(a - b) < 1e-6 for a, b in zip((point.x, point.y, point.z), values))
    assert near(box.pose.position, 1.0, 2.0, 3.0) and near(box.twist.linear, 0.5, 0.0, 0.0), box
    assert near(wall.pose.position, 1.0, 3.0, 3.0) and wall.header.frame_id == "world", wall
    caller.expect(FAILED, "SetEntityState", "static", entity="wall_1", state=state_at(0.0, 0.0, linear=Vector3(x=1.0)))
    caller.expect(101, "SetEntityState", "position", entity="box_1", state=state_at(float("nan"), 0.0))
    caller.expect(FAILED, "SetEntityState", "nowhere", entity="box_1", state=state_at(0.0, 0.0, frame="nowhere"))
    for service in ("SetEntityState", "GetEntityState", "DeleteEntity"):
        caller.expect(NOT_FOUND, service, "box_2", entity="box_2")
    caller.expect(NOT_FOUND, "DeleteEntity", "empty", entity="")
    caller.expect(OK, "DeleteEntity", entity="wall_1")
    assert "wall_1" not in names(caller)

    # Scopes: only what was spawned goes, then only states, then everything.
    caller.expect(OK, "StepSimulation", steps=20)
    caller.expect(UNSUPPORTED, "ResetSimulation", "scope 3", scope=1)
    caller.expect(UNSUPPORTED, "ResetSimulation", "scope 8", scope=8)
    caller.expect(OK, "ResetSimulation", scope=2)
    caller.expect(OK, "ResetSimulation", scope=4)
    assert names(caller) == sorted(set(everything) - {"box_1", "wall_1"})
    assert caller.expect(OK, "GetEntityState", entity=ROBOT).state.header.stamp.nanosec == 100_000_000
    caller.expect(OK, "ResetSimulation", scope=0)
    assert caller.expect(OK, "GetEntityState", entity=ROBOT).state.header.stamp.nanosec == 0


def spawn_request(name, text):
    request = SpawnEntity(name=name, initial_pose=pose_at(3.0, 0.0, 0.1))
    request.entity_resource.resource_string = text
    return request


def judge_spawning(caller):
    spawn = lambda code, says="", /, **fields: caller.expect(code, "SpawnEntity", says, **fields).entity_name
    assert spawn(OK, resource_string=BOX, initial_pose=pose_at(2.0, 0.0, 0.5)) == "box"
    assert spawn(OK, resource_string=BOX, allow_renaming=True, initial_pose=pose_at(0.0, 0.0, 1.0, "box")) == "box_1"
    spawn(101, "allow_renaming", resource_string=BOX)
    spawn(102, "separates", resource_string=BOX, name="a::b")
    spawn(103, "<mujoco>", resource_string="<mujoco/>")
    spawn(104, "both")
    spawn(105, "namespace", resource_string=BOX, name="other", entity_namespace="1st")
    spawn(106, "resource_string:1", resource_string="<robot")
    spawn(106, "other:", resource_string='<robot name="r"><link name="a"/><link name="b"/></robot>', name="other")
    spawn(109, "orientation", resource_string=BOX, name="other", initial_pose=PoseStamped(pose=Pose(orientation=Quaternion(w=float("nan")))))
    spawn(103, "by its name", uri="file:///etc/hosts")
    spawn(NOT_FOUND, "no file", uri="file:///no/such.urdf")
    spawn(NOT_FOUND, "did you mean", uri="kobuki_nostack_camra")
    spawn(UNSUPPORTED, "scheme", uri="https://example.org/box.sdf")
    failed = caller.expect(150, "SpawnEntities", "1 of 2", spawn_requests=[spawn_request("box", BOX), spawn_request("third", BOX)])
    assert [each.result.result for each in failed.results] == [101, OK], failed
    # A robot by its name, with its topics in a namespace.
    assert spawn(OK, uri="kobuki_nostack_camera", name="second", entity_namespace="second", initial_pose=pose_at(-2.0, 0.0)) == "second"
    until(lambda: "/second/odom" in dict(caller.node.get_topic_names_and_types()), "the topics of the second robot")
    assert caller.expect(OK, "GetEntityInfo", entity="second").info.category.category == 1


def judge_parameters_meanwhile(caller):
    """Parameters are answered while a model is read that takes long: a part of it comes from a pipe."""
    parameters = caller.node.create_client(GetParameters, "/belvedere/get_parameters")
    assert parameters.wait_for_service(LONGEST_S)
    with tempfile.TemporaryDirectory() as folder:
        pipe, robot = Path(folder, "slow.yaml"), Path(folder, "robot.urdf.xacro")
        os.mkfifo(pipe)
        name = f"${{xacro.load_yaml('{pipe}')}}"
        robot.write_text(f'<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro"><link name="{name}"/></robot>')
        with pipe.open("r+b", buffering=0) as part:
            part.write(b"lin")
            spawned = caller.begin("SpawnEntity", uri=str(robot), name="slow", initial_pose=pose_at(4.0, 0.0))
            # The program has read this, and waits for more.
            until(lambda: fcntl.ioctl(part, termios.FIONREAD, bytes(4)) == bytes(4), "the pipe is not read")
            found = caller.end(parameters.call_async(GetParameters.Request(names=["use_sim_time"])), "GetParameters")
            assert found.values[0].bool_value and not spawned.done(), found
            part.write(b"k")
        assert caller.end(spawned, "SpawnEntity").result.result == OK, spawned.result()
        caller.expect(OK, "DeleteEntity", entity="slow")


def judge_types(caller):
    """The types have the hashes of the package, as other nodes see."""
    services = [name for name in dir(srv) if name[0].isupper() and "_" not in name]
    for name in services:
        caller.client(name)
    named = dict(caller.node.get_service_names_and_types())
    for name in services:
        topic, kind = f"/{snake(name)}", f"simulation_interfaces/srv/{name}"
        assert named.get(topic) == [kind], f"{topic}: {named.get(topic)}"
        # The name of the node comes a moment after its services.
        of_node = lambda: [
            each
            for each in caller.node.get_subscriptions_info_by_topic(f"rq{topic}Request", no_mangle=True)
            if each.node_name == "belvedere"
        ]
        until(of_node, f"{topic} belongs to no node")
        assert HASHES[kind] in str(of_node()[0].topic_type_hash), topic


def judge_end_of_the_simulator(caller, child):
    """A call that waits is answered when the simulator ends, and so is one afterwards."""
    steps = caller.begin("StepSimulation", steps=10_000_000)
    until(lambda: caller.call("GetSimulationState").state.state == PLAYING, "steps do not begin")
    child.send_signal(signal.SIGINT)
    ended = caller.end(steps, "StepSimulation").result
    assert ended.result == FAILED and ended.error_message, ended
    child.wait(timeout=20)
    assert caller.expect(FAILED, "GetSimulationState", "start one with belvedere run").state.state == NO_WORLD
    for name in ("GetEntities", "ResetSimulation", "StepSimulation", "SpawnEntity"):
        caller.expect(FAILED, name, "start one with belvedere run")
    features = caller.call("GetSimulatorFeatures").features
    assert not features.features and "no simulator" in features.custom_info, features


def judge_replay(caller):
    assert 0 not in caller.call("GetSimulatorFeatures").features.features
    pause = SimulationState(state=PAUSED)
    caller.expect(OK, "SetSimulationState", state=pause)
    assert caller.expect(OK, "GetSimulationState").state.state == PAUSED
    caller.expect(OK, "StepSimulation", steps=2)
    for name in ("ResetSimulation", "SpawnEntity", "DeleteEntity", "SetEntityState"):
        caller.expect(UNSUPPORTED, name, "replay")
    # The states of models are recorded.
    assert ROBOT in names(caller)


def judge_no_commands(caller):
    """What only reads is answered, and the refusals name the option."""
    for name in ("SetSimulationState", "StepSimulation", "ResetSimulation", "SpawnEntity", "DeleteEntity", "SetEntityState"):
        response = caller.call(name, "/safe")
        assert response.result.result == UNSUPPORTED and "--no-commands" in response.result.error_message, response
    failed = caller.call("SpawnEntities", "/safe", spawn_requests=[spawn_request("box", BOX)])
    assert failed.results[0].result.result == UNSUPPORTED, failed
    assert ROBOT in caller.call("GetEntities", "/safe").entities
    assert set(caller.call("GetSimulatorFeatures", "/safe").features.features) == {8, 10, 12, 24}


began = time.monotonic()
rclpy.init()
caller = Caller()
clock = []
caller.node.create_subscription(Clock, "/clock", clock.append, 10)
with kit.program(BELVEDERE, "ros2", "--wait"):
    with kit.process(BELVEDERE, "run", "--drive", "still", "--paused") as (simulator, _):
        judge_types(caller)
        until(lambda: caller.call("GetSimulatorFeatures").features.features, "the simulator")
        judge_state(caller)
        judge_entities(caller)
        judge_spawning(caller)
        judge_parameters_meanwhile(caller)
        with kit.program(BELVEDERE, "ros2", "--no-commands", "--ros-namespace", "safe"):
            judge_no_commands(caller)
        judge_end_of_the_simulator(caller, simulator)
    with kit.program(BELVEDERE, "replay", RECORDING, "--loop"):
        until(lambda: caller.call("GetSimulatorFeatures").features.features, "the replay")
        judge_replay(caller)
rclpy.shutdown()
print(f"services: all answered, in {time.monotonic() - began:.1f} s\n1 passed, 0 failed")
