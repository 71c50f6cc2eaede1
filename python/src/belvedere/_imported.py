"""Worlds that are made of scenes of other packages."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from belvedere._placed_camera import PlacedCamera
    from belvedere._world import World


class Imported:
    """What a world has from a scene of another package. Each package is imported when it is used."""

    _notes: Sequence[str] = ()
    _cameras: Mapping[str, PlacedCamera] = {}

    @property
    def cameras(self) -> dict[str, PlacedCamera]:
        """The cameras of the scene that the world was made of, by name; none for worlds from files and arrays."""
        return dict(self._cameras)

    def _take(self, notes: Sequence[str], cameras: Mapping[str, PlacedCamera]) -> None:
        self._notes, self._cameras = tuple(notes), dict(cameras)

    @staticmethod
    def from_trimesh(scene: Any, *, up: str = "z") -> World:
        """Return a world of what trimesh has loaded or made, a body for each node with triangles.

        A body has the name of its node. Nodes that show the same geometry share its triangles and textures. Lengths
        are converted to metres if the scene has units. The camera of the scene, if one was set, is in ``cameras``
        under its name.

        Args:
            scene: a ``trimesh.Scene``, a ``trimesh.Trimesh``, or the path of a file that trimesh reads.
            up: ``z`` or ``y``, the axis that is up in the scene; glTF has y.

        Raises:
            ImportError: trimesh is not installed.
            ValueError: it is no scene, or it has a mesh that cannot be used. What is left out is listed in ``notes``
                and logged as ``belvedere``.

        """
        from belvedere._from_trimesh import world_of

        return world_of(scene, up)

    @staticmethod
    def from_open3d(geometries: Any, *, up: str = "z") -> World:
        """Return a world of triangle meshes of Open3D, a body for each, or for each of its materials.

        Args:
            geometries: a ``geometry.TriangleMesh`` or ``t.geometry.TriangleMesh``, a ``TriangleMeshModel``, a
                dictionary ``{"name": …, "geometry": …, "material": …}`` as ``open3d.visualization.draw`` takes it, or
                a list of these. Lengths are metres.
            up: ``z`` or ``y``, the axis that is up.

        Raises:
            ImportError: a mesh is the path of a file, and Open3D is not installed.
            ValueError: something is no geometry, or a mesh cannot be used. What is left out is listed in ``notes``
                and logged as ``belvedere``.

        """
        from belvedere._from_open3d import world_of

        return world_of(geometries, up)

    @staticmethod
    def from_usd(stage: str | os.PathLike[str] | Any, *, time: float | None = None) -> World:
        """Return a world of a stage of OpenUSD, a body for each visible shape; its name is the path of its prim.

        Lengths are converted to metres and axes to z up, by the stage's ``metersPerUnit`` and ``upAxis``. Instances
        share triangles and textures. Cameras are in ``cameras``, by the paths of their prims.

        Args:
            stage: a ``pxr.Usd.Stage``, or the path of a file (``.usd``, ``.usda``, ``.usdc``, ``.usdz``).
            time: the time code of values that change; by default the first.

        Raises:
            ImportError: usd-core is not installed, or Pillow, which reads textures, if the stage has one.
            ValueError: the stage cannot be opened, or a mesh cannot be used. What is left out is listed in ``notes``
                and logged as ``belvedere``.

        """
        from belvedere._from_usd import world_of

        return world_of(stage, time)
