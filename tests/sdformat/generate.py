"""Writes SDF files with random models, frames, includes and joints. Some have a fault. What they mean is libsdformat's to
say.

    python3 tests/sdformat/generate.py OUT SEED COUNT

OUT/ours/NUMBER.sdf is written for the seeds from SEED on, and the models that the files include as
OUT/ours/models/mNUMBER-…. OUT/theirs has the same files with the version 1.9 instead of a later one, which Debian's
libsdformat does not read; the frames of these versions mean the same. SEED may be `new`, which chooses one and prints
it."""

import pathlib
import random
import sys
import time
import xml.etree.ElementTree as xml

# Few names, so that models, links and frames in different places have the same one.
NAMES = ["a", "b", "arm", "link", "base", "frame", "x-1", "rad_ä", "m.1", "tip", "joint", "model", "1"]
VERSIONS = ["1.7", "1.8", "1.9", "1.10", "1.11"]
DEEPEST = 2


class Scope:
    """What has a name in a model or world. `frames` is all that a pose can be relative to; `ends` has the link of each
    that moves with one."""

    def __init__(self, root, suffix=""):
        self.root, self.siblings, self.suffix = root, set(), suffix
        self.frames, self.ends, self.own_links = [root], {}, []


class Generator:
    def __init__(self, seed, folder):
        self.seed, self.folder, self.files = seed, folder, 0
        self.random = random.Random(seed)
        self.version = self.random.choice(VERSIONS)

    def chance(self, share):
        return self.random.random() < share

    def number(self, most):
        value = self.random.uniform(-most, most)
        return self.random.choice([repr(value), f"{value:.3f}", f"{value:e}", str(int(value)), "+0.5", "-.25"])

    def name(self, scope):
        free = [name for name in NAMES if name not in scope.siblings]
        name = self.random.choice(free) if free else f"n{len(scope.siblings)}"
        scope.siblings.add(name)
        return name + scope.suffix

    def pose(self, parent, frames, share=0.7):
        """A <pose>, relative to one of the frames."""
        if not self.chance(share):
            return
        pose = xml.SubElement(parent, "pose")
        if frames and self.chance(0.6):
            pose.set("relative_to", self.random.choice(frames))
        if self.chance(0.1):
            return
        numbers = [self.number(3) for _ in range(6)]
        kind = self.random.choice(["radians"] * 4 + ["degrees", "quaternion", "named"])
        if kind == "degrees":
            pose.set("degrees", "true")
            numbers[3:] = [self.number(180) for _ in range(3)]
        elif kind == "quaternion":
            pose.set("rotation_format", "quat_xyzw")
            parts = [self.random.gauss(0, 1) for _ in range(4)]
            length = sum(part * part for part in parts) ** 0.5
            numbers[3:] = [repr(part / length) for part in parts]
        elif kind == "named":
            pose.set("rotation_format", "euler_rpy")
        pose.text = self.random.choice([" ", "  ", "\n\t"]).join(numbers)
        if self.chance(0.3):
            pose.text = f"\n  {pose.text}\n"

    def link(self, model, scope):
        name = self.name(scope)
        link = xml.SubElement(model, "link", name=name)
        self.pose(link, scope.frames)
        scope.frames.append(name)
        scope.own_links.append(name)
        scope.ends[name] = name

    def frame(self, parent, scope):
        name = self.name(scope)
        frame = xml.SubElement(parent, "frame", name=name)
        attached = self.random.choice(scope.frames) if self.chance(0.6) else None
        if attached:
            frame.set("attached_to", attached)
        self.pose(frame, scope.frames)
        scope.frames.append(name)
        if attached in scope.ends:
            scope.ends[name] = scope.ends[attached]

    def joint(self, model, scope):
        if len(set(scope.ends.values())) < 2:
            return
        child = self.random.choice(list(scope.ends))
        parent = self.random.choice([end for end in scope.ends if scope.ends[end] != scope.ends[child]])
        name = self.name(scope)
        kind = self.random.choice(["fixed", "revolute", "revolute", "continuous", "prismatic", "ball"])
        joint = xml.SubElement(model, "joint", name=name, type=kind)
        self.pose(joint, scope.frames)
        xml.SubElement(joint, "parent").text = "world" if self.chance(0.1) else parent
        xml.SubElement(joint, "child").text = child
        if kind in ("revolute", "continuous", "prismatic"):
            axis = xml.SubElement(joint, "axis")
            xyz = xml.SubElement(axis, "xyz")
            xyz.text = " ".join(repr(self.random.uniform(0.1, 1)) for _ in range(3))
            if self.chance(0.5):
                xyz.set("expressed_in", self.random.choice(scope.frames))
        scope.frames.append(name)
        scope.ends[name] = scope.ends[child]

    def placed(self, inside):
        return self.random.choice(inside.frames) if self.chance(0.5) else None

    def take(self, scope, name, inside):
        """The model has its name, and all in it has one behind that, which SDF 1.7 cannot write."""
        # Debian's libsdformat does not take the name of a model as the end of a joint; versions from 12.4 on do.
        scope.frames.append(name)
        if self.version != "1.7":
            scope.frames += [f"{name}::{frame}" for frame in inside.frames]
            scope.ends |= {f"{name}::{end}": f"{name}::{link}" for end, link in inside.ends.items()}

    def nested(self, parent, scope, depth):
        name = self.name(scope)
        model = xml.SubElement(parent, "model", name=name)
        inside = self.fill(model, depth)
        if frame := self.placed(inside):
            model.set("placement_frame", frame)
        self.pose(model, scope.frames)
        self.take(scope, name, inside)

    def include(self, parent, scope, depth):
        """Writes a model into a file of its own."""
        self.files += 1
        uri = f"m{self.seed}-{self.files}"
        own = self.name(scope)
        root = xml.Element("sdf", version=self.version)
        model = xml.SubElement(root, "model", name=own)
        # The parts of a merged model become those of the model around it, and so need other names.
        is_merged = depth > 0 and self.version != "1.7" and self.chance(0.3)
        inside = self.fill(model, depth, f"_{self.files}" if is_merged else "")
        if not is_merged:
            if frame := self.placed(inside):
                model.set("placement_frame", frame)
            self.pose(model, [])
        write(root, self.folder, f"models/{uri}/model.sdf")
        config = xml.Element("model")
        xml.SubElement(config, "name").text = uri
        xml.SubElement(config, "sdf", version=self.version).text = "model.sdf"
        write(config, self.folder, f"models/{uri}/model.config")
        include = xml.SubElement(parent, "include")
        xml.SubElement(include, "uri").text = f"model://{uri}"
        name = own
        if self.chance(0.5):
            name = self.name(scope)
            scope.siblings.discard(own.removesuffix(scope.suffix))
            xml.SubElement(include, "name").text = name
        if is_merged:
            # libsdformat writes this pose into the outer model with six digits.
            pose = xml.SubElement(include, "pose", relative_to=self.random.choice(scope.frames))
            pose.text = f"{self.random.randrange(9) / 4} -1.5 0.25 0 0 0"
            include.set("merge", "true")
            scope.frames += inside.frames[1:]
            scope.own_links += inside.own_links
            scope.ends |= inside.ends
            return
        self.pose(include, scope.frames)
        if include.find("pose") is not None and (frame := self.placed(inside)):
            xml.SubElement(include, "placement_frame").text = frame
        if depth == 0 and self.chance(0.2):
            xml.SubElement(include, "static").text = self.random.choice(["true", "false", "1"])
        self.take(scope, name, inside)

    def fill(self, model, depth, suffix=""):
        """The content of a model, in a random order."""
        scope = Scope("__model__", suffix)
        # A frame of a static model moves with no link, so models inside of others are not static.
        if depth == 0 and self.chance(0.1):
            xml.SubElement(model, "static").text = "true"
        if depth == DEEPEST or self.chance(0.8):
            self.link(model, scope)
        else:
            self.nested(model, scope, depth + 1)
        parts = [self.link, self.link, self.frame, self.frame, self.frame, self.joint, self.joint]
        deep = [] if depth == DEEPEST else [self.nested, self.include]
        for _ in range(self.random.randrange(6)):
            part = self.random.choice(parts + deep)
            part(model, scope, depth + 1) if part in deep else part(model, scope)
        children = list(model)
        self.random.shuffle(children)
        model[:] = children
        if self.chance(0.3):
            links = set(scope.ends.values()) if self.version != "1.7" else scope.own_links
            if links:
                model.set("canonical_link", self.random.choice(sorted(links)))
        return scope

    def file(self):
        root = xml.Element("sdf", version=self.version)
        if self.chance(0.25):
            model = xml.SubElement(root, "model", name=self.random.choice(NAMES))
            inside = self.fill(model, 0)
            if frame := self.placed(inside):
                model.set("placement_frame", frame)
            self.pose(model, [])
        else:
            world = xml.SubElement(root, "world", name="w")
            scope = Scope("world")
            for _ in range(self.random.randrange(2, 5)):
                part = self.random.choice([self.nested, self.include, self.frame, self.frame])
                part(world, scope) if part == self.frame else part(world, scope, 0)
            children = list(world)
            self.random.shuffle(children)
            world[:] = children
        if self.chance(0.35):
            self.spoil(root)
        return root

    def spoil(self, root):
        """Makes one fault; also such as are none after all."""
        named = [one for one in root.iter() if one.get("name")]
        poses = [one for one in root.iter("pose")]
        joints = [one for one in root.iter("joint")]
        one, other = self.random.choice(named), self.random.choice(named)
        pose = self.random.choice(poses) if poses else xml.SubElement(one, "pose")
        joint = self.random.choice(joints) if joints else None
        faults = [
            lambda: one.set("name", other.get("name")),
            lambda: one.set("name", self.random.choice(["world", "__model__", "__x__", "a::b", "", "__root__"])),
            lambda: pose.set("relative_to", self.random.choice(["nobody", "a::nobody", "world", "__model__", "::a"])),
            lambda: pose.set("relative_to", one.get("name")),
            lambda: setattr(pose, "text", self.random.choice(["1 2", "1 2 3 4 5 6 7", "a b c d e f", "0 0 nan 0 0 0"])),
            lambda: pose.set("rotation_format", self.random.choice(["quat_xyzw", "euler", ""])),
            lambda: one.set("attached_to", self.random.choice(["nobody", other.get("name"), "world"])),
            lambda: one.set("placement_frame", self.random.choice(["nobody", other.get("name"), "world"])),
            lambda: one.set("canonical_link", self.random.choice(["nobody", other.get("name"), "__model__"])),
            lambda: root.find("*").remove(self.random.choice(list(root.find("*")))),
        ]
        if joint is not None:
            end = joint.find(self.random.choice(["parent", "child"]))
            names = ["nobody", other.get("name"), "world", "a::b", joint.get("name"), ""]
            faults += [
                lambda: setattr(end, "text", self.random.choice(names)),
                lambda: joint.remove(end),
                lambda: joint.set("type", self.random.choice(["hinge", "", "fixed"])),
                lambda: joint.attrib.pop("type"),
            ]
            if (xyz := joint.find("axis/xyz")) is not None:
                faults.append(lambda: xyz.set("expressed_in", self.random.choice(["nobody", "world", "a::b"])))
                faults.append(lambda: setattr(xyz, "text", self.random.choice(["0 0 0", "1 0", "x"])))
        self.random.choice(faults)()


def write(root, out, name):
    xml.indent(root)
    for side in ("ours", "theirs"):
        path = out / side / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(xml.tostring(root, encoding="unicode"))
        for one in root.iter():
            if one.get("version") in ("1.10", "1.11"):
                one.set("version", "1.9")


if __name__ == "__main__":
    out, seed, count = pathlib.Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    if seed == "new":
        seed = time.time_ns() % 10**9
        print(f"BELVEDERE_SEED={seed}")
    for number in range(int(seed), int(seed) + count):
        write(Generator(number, out).file(), out, f"{number}.sdf")
