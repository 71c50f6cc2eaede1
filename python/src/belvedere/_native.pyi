"""Sensors, simulator and streams, only for the modules of this package, which check all arguments."""

from collections.abc import Sequence
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Camera",
    "DepthCamera",
    "Frame",
    "Lidar",
    "Node",
    "Scanner",
    "Sender",
    "Simulation",
    "States",
    "Subscriber",
    "World",
    "bad_pose",
    "poses_of_matrices",
    "run_words",
]

# Poses of the sensor (N, 7), numbers of the moved bodies, their poses (N, bodies, 7).
_Places: TypeAlias = tuple[NDArray[np.float64], Sequence[int], NDArray[np.float64] | None] | States
_Moves: TypeAlias = tuple[Sequence[int], NDArray[np.float64] | None]
# Places (N, objects, 3) and matrices (N, objects, 9).
_Frames: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64]]
# Colours of bodies, colours of lamps, positions or directions of lamps, ambient light: (N, ..., 3); whether bodies are
# textured.
_Looks: TypeAlias = tuple[
    NDArray[np.float32] | None,
    NDArray[np.float32] | None,
    NDArray[np.float64] | None,
    NDArray[np.float32] | None,
    NDArray[np.bool_] | None,
    NDArray[np.float64] | None,
]
# Seeds, numbers of frames, mask, appearances.
_Each: TypeAlias = tuple[Sequence[int], Sequence[int], Sequence[bool] | None, _Looks | None]
_Lens: TypeAlias = tuple[tuple[str, Sequence[float]] | None, float | None]
_Look: TypeAlias = tuple[
    Sequence[float],
    Sequence[float],
    Sequence[float],
    float,
    Sequence[float] | None,
    tuple[NDArray[np.uint8], int, bool] | int | None,
    Sequence[float],
    bool,
    Sequence[float],
]
_Said: TypeAlias = tuple[str, NDArray[np.float64], Sequence[float], int, float, int]

def bad_pose(poses: NDArray[np.float64]) -> tuple[int, str] | None: ...
def poses_of_matrices(matrices: NDArray[np.float64]) -> tuple[NDArray[np.float64], tuple[int, str] | None]: ...

@final
class World:
    def __new__(cls) -> World: ...
    @staticmethod
    def load(
        source: str, package_path: Sequence[str], models: str, xacro_args: Sequence[tuple[str, str]]
    ) -> World: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def bodies(self) -> list[str]: ...
    def instance_bodies(self) -> NDArray[np.int32]: ...
    def snapshot(self) -> World: ...
    def lights(self) -> list[tuple[list[float], list[float], bool]]: ...
    def placed_lights(
        self,
        lights: Sequence[int],
        xpos: NDArray[np.float64] | None,
        xdir: NDArray[np.float64] | None,
        camera: tuple[int, NDArray[np.float64], int] | None,
        states: int,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]: ...
    def ambient(self) -> list[float]: ...
    def memory_len(self) -> int: ...
    def pose(self, body: int) -> NDArray[np.float64]: ...
    def set_pose(self, body: int, pose: NDArray[np.float64]) -> None: ...
    def add_shape(self, kind: str, size: Sequence[float], look: _Look, said: _Said) -> int: ...
    def add_mesh(
        self,
        vertices: NDArray[np.float32],
        faces: NDArray[np.uint32],
        uvs: NDArray[np.float32] | None,
        normals: NDArray[np.float32] | None,
        look: _Look,
        said: _Said,
    ) -> int: ...
    def add_height_field(
        self,
        heights: NDArray[np.float32],
        shape: Sequence[int],
        size: Sequence[float],
        look: _Look,
        said: _Said,
    ) -> int: ...
    def add_copy(
        self,
        body: int,
        name: str,
        pose: NDArray[np.float64],
        color: Sequence[float] | None,
        scale: Sequence[float] | None,
        class_id: int | None,
    ) -> int: ...
    def add_light(
        self,
        kind: str,
        position: Sequence[float],
        direction: Sequence[float],
        diffuse: Sequence[float],
        specular: Sequence[float],
        range_m: float,
        attenuation: Sequence[float],
        cone: Sequence[float],
        cast_shadows: bool,
    ) -> int: ...
    def set_environment(self, ambient: Sequence[float], background: Sequence[float]) -> None: ...
    def set_sky(self, faces: tuple[NDArray[np.uint8], int] | None) -> None: ...
    def cast(
        self,
        origins: NDArray[np.float32],
        directions: NDArray[np.float32],
        ranges: NDArray[np.float32] | None,
        reference: Sequence[float],
        visibility: int,
        both_faces: bool,
        moves: _Moves | States,
        outputs: dict[str, NDArray[Any]],
        threads: int,
    ) -> None: ...

@final
class Camera:
    def __new__(
        cls,
        size: Sequence[int],
        lens: _Lens,
        clip: Sequence[float],
        exposure: float,
        grey: bool,
        smooth: bool,
        noise: Sequence[float],
        device: str | None,
    ) -> Camera: ...
    def render(
        self,
        world: World,
        now: _Places,
        after: _Places | None,
        before: _Places | None,
        each: _Each,
        outputs: dict[str, NDArray[Any]],
        threads: int,
    ) -> None: ...

@final
class DepthCamera:
    def __new__(
        cls,
        size: Sequence[int],
        lens: _Lens,
        clip: Sequence[float],
        exposure: float,
        grey: bool,
        smooth: bool,
        noise: Sequence[float],
        device: str | None,
        range: Sequence[float | None],
        depth_noise: Sequence[float],
        model: str | None,
        projector: bool,
        faces: int,
    ) -> DepthCamera: ...
    @staticmethod
    def presets() -> list[tuple[str, tuple[int, int], float, tuple[float, float]]]: ...
    def render(
        self,
        world: World,
        now: _Places,
        after: _Places | None,
        before: _Places | None,
        each: _Each,
        outputs: dict[str, NDArray[Any]],
        threads: int,
    ) -> None: ...

@final
class Lidar:
    def __new__(
        cls,
        horizontal: tuple[int, float, float],
        vertical: tuple[int, float, float],
        range: Sequence[float],
        noise: Sequence[float],
        visibility: int,
        both_faces: bool,
    ) -> Lidar: ...
    def render(
        self,
        world: World,
        now: _Places,
        after: _Places | None,
        before: _Places | None,
        each: _Each,
        outputs: dict[str, NDArray[Any]],
        threads: int,
    ) -> None: ...

@final
class Scanner:
    def __new__(
        cls,
        preset: str,
        rate_hz: float | None,
        columns: int | None,
        returns: str,
        intensity: str,
        weather: Sequence[float],
        visibility: int,
    ) -> Scanner: ...
    @staticmethod
    def presets() -> list[str]: ...
    @property
    def size(self) -> tuple[int, int, int]: ...
    def directions(self, frame: int) -> NDArray[np.float32]: ...
    def render(
        self,
        world: World,
        now: _Places,
        after: _Places | None,
        before: _Places | None,
        each: _Each,
        outputs: dict[str, NDArray[Any]],
        threads: int,
    ) -> None: ...

@final
class Simulation:
    def __new__(
        cls,
        world: str,
        seed: int,
        gazebo_compat: bool,
        threads: int,
        package_path: Sequence[str],
        models: str,
    ) -> Simulation: ...
    def spawn(
        self,
        source: str,
        name: str,
        namespace: str,
        pose: NDArray[np.float64],
        package_path: Sequence[str],
        models: str,
        xacro_args: Sequence[tuple[str, str]],
    ) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def thing(self) -> str | None: ...
    @property
    def time_ns(self) -> int: ...
    @property
    def models(self) -> list[str]: ...
    def topics(self) -> list[str]: ...
    def command(self, name: str, linear: float, angular: float) -> None: ...
    def step(self, steps: int) -> None: ...
    def run_for(self, time_ns: int) -> None: ...
    def reset(self) -> None: ...
    def pose(self, name: str) -> NDArray[np.float64]: ...
    def place(self, name: str, pose: NDArray[np.float64]) -> None: ...
    def render(self, topics: list[str]) -> list[tuple[bytes, NDArray[np.uint8]] | None]: ...
    def world(self) -> World: ...

@final
class States:
    def __new__(
        cls,
        sensor: _Frames,
        number: int | None,
        is_camera: bool,
        geom: _Frames,
        geoms: NDArray[np.int64],
    ) -> States: ...

def run_words(words: Sequence[str]) -> int: ...

@final
class Node:
    def __new__(cls, domain: str, name: str) -> Node: ...
    def streams(
        self,
    ) -> list[tuple[str, str | None, str | None, float | None, str | None, int | None]]: ...
    def subscriber(self, topic: str) -> Subscriber: ...
    def sender(self, topic: str, kind: int) -> Sender: ...
    def clean_up_dead(self) -> None: ...

@final
class Subscriber:
    def wait(self, timeout: float | None) -> bool: ...
    def take(self) -> Frame | None: ...
    def take_newest(self) -> Frame | None: ...
    def fileno(self) -> int: ...
    @property
    def publishers(self) -> int: ...
    @property
    def missed_total(self) -> int: ...
    @property
    def silence(self) -> float: ...
    def close(self) -> None: ...

@final
class Frame:
    @property
    def header(self) -> bytes: ...
    @property
    def missed(self) -> int: ...
    @property
    def restarted(self) -> bool: ...
    @property
    def is_from_history(self) -> bool: ...
    @property
    def __array_interface__(self) -> dict[str, Any]: ...

@final
class Sender:
    @property
    def topic(self) -> str: ...
    def send(self, command: bytes, tail: bytes) -> bool: ...
    def is_taken(self) -> bool: ...
    def close(self) -> None: ...
