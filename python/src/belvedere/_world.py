"""Worlds, which sensors see."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import _arrays, _native
from belvedere._channels import prepare
from belvedere._frames import Frames
from belvedere._imported import Imported
from belvedere._looks import SEES, cube, look_of, rgba, round_size, table
from belvedere._sources import arguments, folders, report
from belvedere._unpicklable import Unpicklable

if TYPE_CHECKING:
    import os

    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike, Bodies

#: The named worlds and robots. For an installation from the source tree, the native module has their location.
MODELS = str(Path(__file__).parent / "models")
#: The channels of ``cast``: type and shape for each ray.
_ANSWERS: dict[str, tuple[np.dtype[Any], tuple[int, ...]]] = {
    "distance": (np.dtype(np.float32), ()),
    "normal": (np.dtype(np.float32), (3,)),
    "instance": (np.dtype(np.uint32), ()),
    "primitive": (np.dtype(np.uint32), ()),
    "barycentrics": (np.dtype(np.float32), (2,)),
}


class World(Imported, Unpicklable):
    """Shapes, materials and lamps, grouped into bodies that move as one.

    ``World()`` is empty except for ambient light. ``World("playground")`` is one of the included worlds. A path or
    a text (which begins with ``<``) of SDF, URDF or xacro is read as by the command ``belvedere``, and its bodies
    are the links, ``model::link``. Lengths are metres, angles radians, frames right-handed with z up; a pose is x y
    z followed by the quaternion x y z w.

    Several threads may use a world; a running batch sees it as it was when the batch began.

    Args:
        source: file, name or text; None for an empty world.
        package_path: folders of ROS packages, searched before ``ROS_PACKAGE_PATH`` and Belvedere's own.
        xacro: arguments for ``$(arg name)``.

    Raises:
        ValueError: there is no such world, or it cannot be used; the message has the lines that the command line
            prints, with file, line and remedy. Ignored elements are logged as ``belvedere``, and listed in
            ``notes``.

    """

    def __init__(
        self,
        source: str | os.PathLike[str] | None = None,
        *,
        package_path: Sequence[str | os.PathLike[str]] = (),
        xacro: Mapping[str, Any] | None = None,
    ) -> None:
        if source is None:
            self._native = _native.World()
        else:
            text = _arrays.described("source", source)
            self._native = _native.World.load(text, folders(package_path), MODELS, arguments(xacro))
            report(self._native.notes)

    def __copy__(self) -> World:
        """Return an independent copy of the world."""
        copied = World._of(self._native.snapshot())
        copied._take(self._notes, self._cameras)
        return copied

    def __deepcopy__(self, memo: dict[int, Any]) -> World:
        """Return an independent copy of the world."""
        return self.__copy__()

    @classmethod
    def _of(cls, native: _native.World) -> World:
        world = cls.__new__(cls)
        world._native = native
        return world

    @property
    def notes(self) -> list[str]:
        """Elements that were ignored in the description or the scene, one line each."""
        return [*self._native.notes, *self._notes]

    @property
    def bodies(self) -> list[str]:
        """The names of the bodies, in the order of their numbers."""
        return self._native.bodies

    @property
    def instance_bodies(self) -> NDArray[np.int32]:
        """The number of the body that each instance belongs to, (instances,); −1 for none.

        ``world.instance_bodies[frames["instance"][seen]]`` converts the channel ``instance`` to bodies at pixels
        with a hit: ``seen = frames["instance"] != 2**32 - 1``.
        """
        return self._native.instance_bodies()

    @property
    def memory(self) -> int:
        """Bytes of shapes, materials and poses."""
        return self._native.memory_len()

    def pose(self, body: str | int) -> NDArray[np.float64]:
        """Return the pose of a body, (7,).

        Raises:
            ValueError: there is no such body.

        """
        return self._native.pose(_arrays.body_number("body", body, self.bodies))

    def set_pose(self, body: str | int, pose: ArrayLike) -> None:
        """Set the pose of a body: (7,), (4, 4) or a place (3,).

        Raises:
            ValueError: there is no such body, or the pose is invalid.

        """
        number = _arrays.body_number("body", body, self.bodies)
        self._native.set_pose(number, _arrays.one_pose("pose", pose))

    def add_box(self, size: ArrayLike, pose: ArrayLike | None = None, **look: Any) -> int:
        """Add a box of full edges x, y, z in metres, centred on its pose; return the number of the new body.

        Args:
            size: (3,).
            pose: (7,), (4, 4) or (3,); by default the world's origin.
            **look: keywords of all ``add_`` methods: ``name``; ``color`` (red, green, blue[, alpha]) from 0 to 1;
                ``emissive``, ``specular`` (3,), 0 or more, and ``shininess``; or ``roughness`` and ``metalness`` from 0
                to 1 instead of the last two, by default 1 and 0 if only one is given; ``texture``, an image (height,
                width, 3 or 4) of uint8, or the number of a body that was added with one, which is shared, and
                ``texture_repeat`` (2,); or a cube around the shape as ``texture``, (6, size, size, 3 or 4), its faces
                +x, −x, +y, −y, +z and −z as in OpenGL, and ``texture_stretch`` (3,), factors of its directions;
                ``texture_mode``, by default ``reflectance``, which the texture is multiplied by, or ``light``: all
                light, with highlights, limited to 1, as in OpenGL without shaders, which excludes ``roughness`` and
                ``metalness``; ``scale`` (3,); ``class_id`` for the channel ``class``; ``laser_retro`` for intensities,
                0 or more; ``seen_by``, ``all``, ``visual`` (only cameras) or ``collision`` (only lidars).

        Raises:
            ValueError: an argument is invalid, or a body with this name exists; nothing is added then.

        """
        return self._shape("box", _arrays.numbers("size", size, 3), pose, look)

    def add_rectangle(self, size: ArrayLike, pose: ArrayLike | None = None, **look: Any) -> int:
        """Add a rectangle in the xy plane, full edges (2,); its outside is +z. See ``add_box``."""
        return self._shape("rectangle", _arrays.numbers("size", size, 2), pose, look)

    def add_plane(self, pose: ArrayLike | None = None, **look: Any) -> int:
        """Add the infinite plane z = 0 of its pose; its outside is +z. See ``add_box``."""
        return self._shape("plane", [], pose, look)

    def add_sphere(self, radius: float, pose: ArrayLike | None = None, **look: Any) -> int:
        """Add a sphere. See ``add_box``."""
        return self._shape("sphere", [_arrays.number("radius", radius)], pose, look)

    def add_ellipsoid(self, radii: ArrayLike, pose: ArrayLike | None = None, **look: Any) -> int:
        """Add an ellipsoid of half axes (3,). See ``add_box``."""
        return self._shape("ellipsoid", _arrays.numbers("radii", radii, 3), pose, look)

    def add_cylinder(self, radius: float, length: float, pose: ArrayLike | None = None, **look: Any) -> int:
        """Add a closed cylinder along z, centred. See ``add_box``."""
        return self._shape("cylinder", round_size(radius, length), pose, look)

    def add_capsule(self, radius: float, length: float, pose: ArrayLike | None = None, **look: Any) -> int:
        """Add a cylinder along z with hemispheres at its ends, which the length excludes. See ``add_box``."""
        return self._shape("capsule", round_size(radius, length), pose, look)

    def add_cone(self, radius: float, length: float, pose: ArrayLike | None = None, **look: Any) -> int:
        """Add a closed cone along z, its apex at +length/2. See ``add_box``."""
        return self._shape("cone", round_size(radius, length), pose, look)

    def add_mesh(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        pose: ArrayLike | None = None,
        *,
        uvs: ArrayLike | None = None,
        normals: ArrayLike | None = None,
        **look: Any,
    ) -> int:
        """Add triangles, counter-clockwise seen from outside. See ``add_box``.

        Args:
            vertices: (V, 3) in metres.
            faces: (F, 3) vertex numbers, at least one triangle.
            pose: as for ``add_box``.
            uvs: (V, 2) texture coordinates, v upwards.
            normals: (V, 3) outward normals of any length but 0. Cameras interpolate between them where light falls on
                the mesh, so that it looks round. Without them, triangles look flat.
            **look: as for ``add_box``.

        Raises:
            ValueError: a vertex is not finite, a number is out of range, or there is no triangle.

        """
        points = table("vertices", vertices, 3, np.float32)
        numbers = table("faces", faces, 3, np.int64)
        if len(numbers) == 0:
            raise ValueError("faces: shape (0, 3); a mesh has one triangle at least")
        for number in (int(numbers.min()), int(numbers.max())):
            if not 0 <= number < len(points):
                raise ValueError(f"faces: there is no vertex {number}; there are {len(points)}, counted from 0")
        triangles = numbers.astype(np.uint32)
        coordinates = None if uvs is None else table("uvs", uvs, 2, np.float32)
        if coordinates is not None and len(coordinates) != len(points):
            raise ValueError(f"uvs: shape {coordinates.shape}; {(len(points), 2)}, one a vertex, is expected")
        outwards = None if normals is None else table("normals", normals, 3, np.float32)
        if outwards is not None and len(outwards) != len(points):
            raise ValueError(f"normals: shape {outwards.shape}; {(len(points), 3)}, one a vertex, is expected")
        appearance, said = look_of(pose, look)
        return self._native.add_mesh(points, triangles, coordinates, outwards, appearance, said)

    def add_copy(
        self,
        body: str | int,
        pose: ArrayLike | None = None,
        *,
        name: str = "",
        color: ArrayLike | None = None,
        scale: ArrayLike | None = None,
        class_id: int | None = None,
    ) -> int:
        """Add a body with the shape and the look of another, whose triangles and texture it shares.

        Args:
            body: name or number of a body that one of the ``add_`` methods added.
            pose: as for ``add_box``.
            name: the name of the new body.
            color: (3,) or (4,), as for ``add_box``; by default that of the other body, like ``scale`` and ``class_id``.
            scale: (3,).
            class_id: for the channel ``class``.

        Raises:
            ValueError: there is no such body, it was read from a file, or an argument is invalid.

        """
        return self._native.add_copy(
            # Names take time in proportion to the number of bodies.
            _arrays.body_number("body", body, self.bodies)
            if isinstance(body, str)
            else _arrays.count("body", body, 0),
            _arrays.text("name", name),
            _arrays.one_pose("pose", pose),
            None if color is None else rgba(color),
            None if scale is None else _arrays.numbers("scale", scale, 3),
            None if class_id is None else _arrays.count("class_id", class_id, 0, 2**32 - 1),
        )

    def add_height_field(
        self, heights: ArrayLike, size: ArrayLike, pose: ArrayLike | None = None, **look: Any
    ) -> int:
        """Add a terrain, which is seen only from above. See ``add_box``.

        Args:
            heights: (rows, columns) in metres, rows from +y to −y, columns from −x to +x.
            size: full lengths along x and y, (2,).
            pose: as for ``add_box``.
            **look: as for ``add_box``.

        """
        field = _arrays.array("heights", heights, np.float32)
        if field.ndim != 2 or min(field.shape) < 2:
            raise ValueError(f"heights: shape {field.shape}; (rows, columns), two each at least, is expected")
        appearance, said = look_of(pose, look)
        lengths = _arrays.numbers("size", size, 2)
        return self._native.add_height_field(field, field.shape, lengths, appearance, said)

    def add_light(
        self,
        kind: str = "directional",
        *,
        position: ArrayLike = (0.0, 0.0, 3.0),
        direction: ArrayLike = (-0.5, 0.2, -1.0),
        color: ArrayLike = (0.8, 0.8, 0.8),
        specular: ArrayLike = (0.0, 0.0, 0.0),
        reach: float = float("inf"),
        attenuation: ArrayLike = (1.0, 0.0, 0.0),
        cone: ArrayLike = (0.3, 0.6),
        falloff: float = 1.0,
        shadows: bool = True,
    ) -> int:
        """Add a lamp; return its number.

        Args:
            kind: ``directional``, ``point`` or ``spot``.
            position: of a point or spot light, (3,) in metres.
            direction: the direction in which the light travels, (3,).
            color: colour times brightness, (3,).
            specular: colour times brightness of highlights, (3,).
            reach: the range in metres.
            attenuation: a, b, c: the brightness at distance d is min(1, 1/(a + b·d + c·d²)).
            cone: of a spot light, the half angles of full and of no brightness, radians.
            falloff: of a spot light, the exponent of the falloff between the two angles.
            shadows: True if the lamp casts shadows.

        Raises:
            ValueError: an argument is out of its range; colours and attenuation must be 0 or more.

        """
        if kind not in ("directional", "point", "spot"):
            raise ValueError(f"kind: directional, point or spot is expected, not {kind!r}")
        inner, outer = _arrays.numbers("cone", cone, 2)
        if not 0.0 <= inner <= outer <= 3.15:
            raise ValueError(f"cone: 0 <= inner <= outer <= pi is expected, not {inner}, {outer}")
        way = _arrays.numbers("direction", direction, 3)
        if kind != "point" and not any(way):
            raise ValueError("direction: a vector of any length but 0 is expected, not 0 0 0")
        return self._native.add_light(
            kind,
            _arrays.numbers("position", position, 3),
            way,
            _arrays.numbers("color", color, 3, 0.0),
            _arrays.numbers("specular", specular, 3, 0.0),
            _arrays.number("reach", reach, 0.0),
            _arrays.numbers("attenuation", attenuation, 3, 0.0),
            [inner, outer, _arrays.number("falloff", falloff)],
            bool(shadows),
        )

    def set_environment(
        self, ambient: ArrayLike = (0.4, 0.4, 0.4), background: ArrayLike = (0.7, 0.7, 0.7)
    ) -> None:
        """Set the ambient light, and the background colour for rays without a hit: 0 or more each."""
        self._native.set_environment(
            _arrays.numbers("ambient", ambient, 3, 0.0), _arrays.numbers("background", background, 3, 0.0)
        )

    def set_sky(self, faces: ArrayLike | None) -> None:
        """Set what cameras see where there is no body, instead of the background. Its place is infinitely far away.

        Args:
            faces: (6, size, size, 3 or 4) of uint8: the faces +x, −x, +y, −y, +z and −z of a cube as in OpenGL, whose y
                axis points up and whose z axis points to −y of the world. None removes the sky.

        Raises:
            ValueError: the faces are not six squares of one size.

        """
        self._native.set_sky(None if faces is None else cube("faces", faces))

    def cast(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        ranges: ArrayLike | None = None,
        channels: Sequence[str] | None = None,
        out: Mapping[str, ArrayLike] | None = None,
        bodies: Bodies | None = None,
        sees: str = "visual",
        faces: str = "both",
        reference: ArrayLike = (0.0, 0.0, 0.0),
        threads: int | None = None,
    ) -> Frames:
        """Cast arbitrary rays and return the first hit of each.

        Args:
            origins: (…, 3) in metres, or one for all rays (3,); single precision.
            directions: (…, 3) of any length but 0.
            ranges: (…, 2), least and greatest distance of a hit, in lengths of the direction; 0 to ∞ by default.
            channels: some of ``distance`` float32, in lengths of the direction, ∞ without a hit; ``normal`` float32
                (…, 3), outwards, in the world's axes, 0 without a hit; ``instance`` and ``primitive`` (the face of
                a mesh) uint32, 2**32 − 1 without a hit; ``barycentrics`` float32 (…, 2), the weights of the face's
                second and third corner. By default those of ``out``, or all.
            out: arrays to write into, by channel.
            bodies: poses of bodies that differ from the world's, by name or number: (7,) or (4, 4) each.
            sees: ``visual`` shapes, like cameras; ``collision`` shapes, like lidars; or ``all``.
            faces: ``both`` sides of surfaces, or ``front``.
            reference: a place in the world that the origins are relative to, for worlds far from their origin.
            threads: the number of threads; one per processor by default. The result is the same.

        Returns:
            The arrays, by channel. Jupyter shows rays (…, height, width) as an image, others as a strip.

        Raises:
            ValueError: an argument is invalid. Nothing is written then.

        """
        rays = _arrays.vectors("directions", directions, 3)
        lead = rays.shape[:-1]
        starts = _arrays.vectors("origins", origins, 3)
        if starts.shape != rays.shape and starts.shape != (3,):
            raise ValueError(f"origins: shape {starts.shape}; {rays.shape}, as directions, or (3,) is expected")
        limits = None if ranges is None else _arrays.vectors("ranges", ranges, 2)
        if limits is not None and limits.shape[:-1] != lead:
            raise ValueError(f"ranges: shape {limits.shape}; {(*lead, 2)} is expected")
        outputs = prepare(_ANSWERS, tuple(_ANSWERS), channels, out, lead, ())
        visibility = _arrays.choice("sees", sees, SEES)
        both = _arrays.choice("faces", faces, {"front": 0, "both": 1}) == 1
        # Names take time in proportion to the number of bodies.
        moves = ([], None) if bodies is None else _arrays.bodies("bodies", bodies, (), self.bodies)
        place = _arrays.numbers("reference", reference, 3)
        self._native.cast(starts, rays, limits, place, visibility, both, moves, outputs, _arrays.threads(threads))
        return Frames(outputs, lead[:-2], lead[-2:])

    _instead = (
        "send its file or arrays, and create it in the other process; copy.copy(world) makes a copy in this process"
    )

    def _shape(self, kind: str, size: list[float], pose: ArrayLike | None, look: dict[str, Any]) -> int:
        appearance, said = look_of(pose, look)
        return self._native.add_shape(kind, size, appearance, said)

    def __repr__(self) -> str:
        """Return the number of bodies."""
        return f"<World of {len(self.bodies)} bodies>"
