"""Small mechanisms, each as a world of SDF and as a model of MuJoCo, with what is compared.

`period`: the time between two passages of a link through its middle, along an axis. `rest`: where the links lie in the
end. `path`: where they are at all times."""

from dataclasses import dataclass
from math import cos, radians, sin, sqrt


@dataclass
class Mechanism:
    name: str
    sdf: str
    mjcf: str
    judge: str
    links: tuple[str, ...]
    axis: int = 0
    seconds: float = 6.0


def inertial(mass, moments, at="0 0 0"):
    x, y, z = moments
    return (
        f"<inertial><pose>{at} 0 0 0</pose><mass>{mass}</mass><inertia><ixx>{x}</ixx><iyy>{y}</iyy><izz>{z}</izz>"
        "<ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>"
    )


def mj_inertial(mass, moments, at="0 0 0"):
    return f'<inertial pos="{at}" mass="{mass}" diaginertia="{" ".join(map(str, moments))}"/>'


def block(mass, x, y, z):
    return [mass / 12 * (y * y + z * z), mass / 12 * (x * x + z * z), mass / 12 * (x * x + y * y)]


def axis(xyz, more=""):
    return f"<axis><xyz>{xyz}</xyz>{more}</axis>"


def joint(name, kind, parent, child, xyz, more="", pose="0 0 0"):
    return (
        f"<joint name='{name}' type='{kind}'><pose>{pose} 0 0 0</pose><parent>{parent}</parent><child>{child}</child>"
        f"{axis(xyz, more) if kind != 'fixed' else ''}</joint>"
    )


GROUND = (
    "<model name='ground'><static>1</static><link name='l'><collision name='c'><geometry><plane><normal>0 0 1</normal>"
    "</plane></geometry><surface><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface></collision></link></model>"
)
MJ_GROUND = '<geom type="plane" size="20 20 1" friction="{mu} 0 0"/>'


def friction(mu):
    return f"<surface><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface>"


def one_joint(kind, mass, moments, at, xyz, dynamics="", limit="", pose="0 0 2 0 0 0"):
    """A link on a joint to the world."""
    more = f"<dynamics>{dynamics}</dynamics><limit>{limit}</limit>"
    return (
        f"<model name='m'><link name='l'><pose>{pose}</pose>{inertial(mass, moments, at)}</link>"
        f"{joint('j', kind, 'world', 'l', xyz, more)}</model>"
    )


def mj_one(kind, mass, moments, at, xyz, more="", euler="0 0 0"):
    return (
        f'<body name="m::l" pos="0 0 2" euler="{euler}"><joint type="{kind}" axis="{xyz}" {more}/>'
        f"{mj_inertial(mass, moments, at)}</body>"
    )


ROD = block(2, 0.05, 0.05, 1)
TURN = 0.1
MODE = sqrt(2)  # The slow mode of two equal pendulums: the ratio of their small angles.


def pendulums():
    small = [1e-6] * 3
    yield Mechanism(
        "a point on a thread",
        one_joint("revolute", 1, small, "0 0 -1", "0 1 0", pose=f"0 0 2 0 {TURN} 0"),
        mj_one("hinge", 1, small, "0 0 -1", "0 1 0", euler=f"0 {TURN} 0"),
        "angle",
        ("m::l",),
        1,
    )
    yield Mechanism(
        "a rod that swings by a radian",
        one_joint("revolute", 2, ROD, "0 0 -0.5", "0 1 0", pose="0 0 2 0 1 0"),
        mj_one("hinge", 2, ROD, "0 0 -0.5", "0 1 0", euler="0 1 0"),
        "angle",
        ("m::l",),
        1,
    )
    yield Mechanism(
        "a rod on an oblique axis",
        one_joint("revolute", 2, ROD, "0 0.3 -0.5", "0.6 0.8 0", pose="0 0 2 0.2 0.1 0"),
        mj_one("hinge", 2, ROD, "0 0.3 -0.5", "0.6 0.8 0", euler="0.2 0.1 0"),
        "path",
        ("m::l",),
        seconds=4,
    )
    second = TURN * MODE
    elbow = f"{-sin(TURN)} 0 {2 - cos(TURN)}"
    yield Mechanism(
        "a pendulum on a pendulum",
        f"<model name='m'><link name='l'><pose>0 0 2 0 {TURN} 0</pose>{inertial(1, small, '0 0 -1')}</link>"
        f"<link name='k'><pose>{elbow} 0 {second} 0</pose>{inertial(1, small, '0 0 -1')}</link>"
        f"{joint('a', 'revolute', 'world', 'l', '0 1 0')}{joint('b', 'revolute', 'l', 'k', '0 1 0')}</model>",
        f'<body name="m::l" pos="0 0 2" euler="0 {TURN} 0"><joint type="hinge" axis="0 1 0"/>{mj_inertial(1, small, "0 0 -1")}'
        f'<body name="m::k" pos="0 0 -1" euler="0 {second - TURN} 0"><joint type="hinge" axis="0 1 0"/>'
        f'{mj_inertial(1, small, "0 0 -1")}</body></body>',
        "angle",
        ("m::l", "m::k"),
        1,
        10,
    )
    yield Mechanism(
        "welded parts swing as one",
        f"<model name='m'><link name='l'><pose>0 0 2 0 0.2 0</pose>{inertial(1, ROD, '0 0 -0.5')}</link>"
        f"<link name='k'><pose relative_to='l'>0.3 0 -1 0 0 0</pose>{inertial(2, ROD, '0 0 0')}</link>"
        f"{joint('a', 'revolute', 'world', 'l', '0 1 0')}{joint('b', 'fixed', 'l', 'k', '')}</model>",
        f'<body name="m::l" pos="0 0 2" euler="0 0.2 0"><joint type="hinge" axis="0 1 0"/>{mj_inertial(1, ROD, "0 0 -0.5")}'
        f'<body name="m::k" pos="0.3 0 -1">{mj_inertial(2, ROD)}</body></body>',
        "angle",
        ("m::l",),
        1,
    )


def springs():
    def spring(stiffness, reference, damping=0):
        return (
            f"<damping>{damping}</damping><spring_stiffness>{stiffness}</spring_stiffness>"
            f"<spring_reference>{reference}</spring_reference>"
        )

    box = block(2, 0.1, 0.1, 0.1)
    for name, damping, judge in [("a mass on a spring", 0, "period"), ("a damped mass on a spring", 20, "rest")]:
        yield Mechanism(
            name,
            one_joint("prismatic", 2, box, "0 0 0", "0 0 1", spring(200, 0.1, damping)),
            mj_one("slide", 2, box, "0 0 0", "0 0 1", f'stiffness="200" springref="0.1" damping="{damping}"'),
            judge,
            ("m::l",),
            2,
        )
    yield Mechanism(
        "a balance wheel",
        one_joint("revolute", 2, [0.02, 0.02, 0.02], "0 0 0", "0 0 1", spring(0.5, 0.4)),
        mj_one("hinge", 2, [0.02, 0.02, 0.02], "0 0 0", "0 0 1", 'stiffness="0.5" springref="0.4"'),
        "angle",
        ("m::l",),
        2,
    )
    yield Mechanism(
        "a lever that a spring holds",
        one_joint("revolute", 2, ROD, "0.5 0 0", "0 1 0", spring(30, -0.2, 6)),
        mj_one("hinge", 2, ROD, "0.5 0 0", "0 1 0", 'stiffness="30" springref="-0.2" damping="6"'),
        "rest",
        ("m::l",),
        seconds=10,
    )
    yield Mechanism(
        "a slider that falls through oil",
        one_joint("prismatic", 2, box, "0 0 0", "0 0 1", "<damping>15</damping>"),
        mj_one("slide", 2, box, "0 0 0", "0 0 1", 'damping="15"'),
        "path",
        ("m::l",),
        seconds=1,
    )
    slope = "0.8 0 -0.6"
    for name, force in [("dry friction holds a slider", 13), ("a slider overcomes dry friction", 6)]:
        yield Mechanism(
            name,
            one_joint("prismatic", 2, box, "0 0 0", slope, f"<friction>{force}</friction>"),
            mj_one("slide", 2, box, "0 0 0", slope, f'frictionloss="{force}"'),
            "path",
            ("m::l",),
            seconds=1,
        )
    yield Mechanism(
        "a rod falls onto its limit",
        one_joint("revolute", 2, ROD, "0.5 0 0", "0 1 0", "<damping>3</damping>", "<lower>-0.5</lower><upper>0.7</upper>"),
        mj_one("hinge", 2, ROD, "0.5 0 0", "0 1 0", 'damping="3" limited="true" range="-0.5 0.7" solreflimit="0.002 1"'),
        "rest",
        ("m::l",),
        seconds=8,
    )
    # Here a leader does not feel its follower, which is light.
    light = [0.001, 0.001, 0.001]
    half = "<mimic joint='a'><multiplier>-0.5</multiplier><offset>0</offset></mimic>"
    yield Mechanism(
        "a wheel that follows another one",
        f"<model name='m'><link name='l'><pose>0 0 2 0 0 0</pose>{inertial(2, ROD, '0.1 0 0')}</link>"
        f"<link name='k'><pose>1 0 2 0 0 0</pose>{inertial(0.1, light)}</link>"
        f"{joint('a', 'revolute', 'world', 'l', '0 1 0')}{joint('b', 'revolute', 'world', 'k', '0 1 0', half)}</model>",
        f'<body name="m::l" pos="0 0 2"><joint name="a" type="hinge" axis="0 1 0"/>{mj_inertial(2, ROD, "0.1 0 0")}</body>'
        f'<body name="m::k" pos="1 0 2"><joint name="b" type="hinge" axis="0 1 0"/>{mj_inertial(0.1, light)}</body>'
        '</worldbody><equality><joint joint1="b" joint2="a" polycoef="0 -0.5 0 0 0" solref="0.002 1"/></equality><worldbody>',
        "path",
        ("m::l", "m::k"),
        seconds=1.5,
    )


def loops():
    def bar(name, at, turn, length):
        moments = block(1, length, 0.02, 0.02)
        return (
            f"<link name='{name}'><pose>{at} 0 {turn} 0</pose>{inertial(1, moments, f'{length / 2} 0 0')}</link>",
            mj_inertial(1, moments, f"{length / 2} 0 0"),
        )

    # A parallelogram that hangs from two points and begins 0.3 rad from its rest.
    down = 1.5707963267948966 - 0.3
    x, z = cos(down), -sin(down)
    a, mj_a = bar("a", "0 0 2", down, 1)
    b, mj_b = bar("b", f"{x} 0 {2 + z}", 0, 2)
    c, mj_c = bar("c", "2 0 2", down, 1)
    joints = [
        joint("ja", "revolute", "world", "a", "0 1 0"),
        joint("jb", "revolute", "a", "b", "0 1 0"),
        joint("jc", "revolute", "world", "c", "0 1 0"),
        joint("jd", "revolute", "b", "c", "0 1 0", pose="1 0 0"),
    ]
    hinge = '<joint type="hinge" axis="0 1 0"/>'
    yield Mechanism(
        "four bars",
        f"<model name='m'>{a}{b}{c}{''.join(joints)}</model>",
        f'<body name="m::a" pos="0 0 2" euler="0 {down} 0">{hinge}{mj_a}<body name="m::b" pos="1 0 0" euler="0 {-down} 0">{hinge}'
        f'{mj_b}</body></body><body name="m::c" pos="2 0 2" euler="0 {down} 0">{hinge}{mj_c}</body></worldbody><equality>'
        '<connect body1="m::c" body2="m::b" anchor="1 0 0" solref="0.002 1"/></equality><worldbody>',
        "period",
        ("m::b",),
        0,
        8,
    )


def contacts():
    def solid(name, shape, size, mass, moments, at, mu=0.8):
        match shape:
            case "box":
                geometry = f"<box><size>{' '.join(map(str, size))}</size></box>"
                half = [it / 2 for it in size]
            case "sphere":
                geometry, half = f"<sphere><radius>{size[0]}</radius></sphere>", size
            case "cylinder":
                geometry = f"<cylinder><radius>{size[0]}</radius><length>{size[1]}</length></cylinder>"
                half = [size[0], size[1] / 2]
        return (
            f"<model name='{name}'><pose>{at}</pose><link name='l'>{inertial(mass, moments)}<collision name='c'><geometry>"
            f"{geometry}</geometry>{friction(mu)}</collision></link></model>",
            f'<body name="{name}::l" pos="{" ".join(at.split()[:3])}" euler="{" ".join(at.split()[3:])}"><freejoint/>'
            f'{mj_inertial(mass, moments)}<geom type="{shape}" size="{" ".join(map(str, half))}" friction="{mu} 0 0"/></body>',
        )

    ground, mj_ground = GROUND.format(mu=0.8), MJ_GROUND.format(mu=0.8)
    ball, mj_ball = solid("m", "sphere", [0.1], 1, [0.004] * 3, "0 0 20 0 0 0")
    yield Mechanism("a ball falls", ball, mj_ball, "path", ("m::l",), seconds=1)
    things = {
        "a box falls on its face": ("box", [0.4, 0.3, 0.2], 3, block(3, 0.4, 0.3, 0.2), "0 0 0.15 0 0 0"),
        "a ball comes to rest": ("sphere", [0.1], 1, [0.004] * 3, "0 0 0.15 0 0 0"),
        "a can stands": ("cylinder", [0.1, 0.3], 2, [0.02, 0.02, 0.01], "0 0 0.2 0 0 0"),
    }
    for name, (shape, size, mass, moments, at) in things.items():
        thing, mj_thing = solid("m", shape, size, mass, moments, at)
        yield Mechanism(name, ground + thing, mj_ground + mj_thing, "rest", ("m::l",), seconds=4)
    size, moments = [0.4, 0.3, 0.2], block(2, 0.4, 0.3, 0.2)
    stack = [solid(f"m{place}", "box", size, 2, moments, f"0 0 {0.102 + 0.202 * place} 0 0 0") for place in range(3)]
    boxes, mj_boxes = ("".join(parts) for parts in zip(*stack))
    links = tuple(f"m{place}::l" for place in range(3))
    yield Mechanism("a stack of three boxes stands", ground + boxes, mj_ground + mj_boxes, "rest", links, seconds=4)
    for degrees, mu, judge in [(20, 0.5, "rest"), (35, 0.5, "path")]:
        turn = radians(degrees)
        at = f"{0.1 * sin(turn)} 0 {0.1 * cos(turn)} 0 {turn} 0"
        box, mj_box = solid("m", "box", [0.3, 0.3, 0.2], 2, block(2, 0.3, 0.3, 0.2), at, mu)
        ramp = (
            f"<model name='ramp'><static>1</static><pose>0 0 0 0 {turn} 0</pose><link name='l'><collision name='c'>"
            f"<pose>0 0 -0.5 0 0 0</pose><geometry><box><size>40 4 1</size></box></geometry>{friction(mu)}</collision></link></model>"
        )
        mj_ramp = f'<body euler="0 {turn} 0"><geom type="box" pos="0 0 -0.5" size="20 2 0.5" friction="{mu} 0 0"/></body>'
        name = "a box stays on a ramp" if judge == "rest" else "a box slides down a ramp"
        yield Mechanism(name, ramp + box, mj_ramp + mj_box, judge, ("m::l",), seconds=3 if judge == "rest" else 1)
    turn = radians(10)
    at = f"{0.1 * sin(turn)} 0 {0.1 * cos(turn)} 0 0 0"
    ball, mj_ball = solid("m", "sphere", [0.1], 1, [0.004] * 3, at)
    ramp = (
        f"<model name='ramp'><static>1</static><pose>0 0 0 0 {turn} 0</pose><link name='l'><collision name='c'>"
        f"<pose>0 0 -0.5 0 0 0</pose><geometry><box><size>40 4 1</size></box></geometry>{friction(0.8)}</collision></link></model>"
    )
    mj_ramp = f'<body euler="0 {turn} 0"><geom type="box" pos="0 0 -0.5" size="20 2 0.5" friction="0.8 0 0"/></body>'
    yield Mechanism("a ball rolls down a ramp", ramp + ball, mj_ramp + mj_ball, "path", ("m::l",), seconds=1)


def all_of_them():
    for kind in [pendulums, springs, loops, contacts]:
        yield from kind()
