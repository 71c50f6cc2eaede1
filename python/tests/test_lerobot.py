"""Data sets of LeRobot: their layout, and LeRobot's own reader where it is installed (``.ci/lerobot``)."""

from __future__ import annotations

import io
import json
import threading
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import belvedere as bv

if TYPE_CHECKING:
    from pathlib import Path

parquet = pytest.importorskip("pyarrow.parquet")
bvl = pytest.importorskip("belvedere.lerobot")

NAMES = {"action": ["speed", "turn"]}


def episode(length: int, seed: int) -> dict[str, Any]:
    """Return frames of a camera that moves past a ball, with a state and an action."""
    world = bv.World()
    world.add_sphere(0.5, (2, 0, 0), color=(0.9, 0.1, 0.1))
    poses = np.tile([0, 0, 0, 0, 0, 0, 1.0], (length, 1))
    poses[:, 1] = np.linspace(-0.5, 0.5, length) + seed / 10
    random = np.random.default_rng(seed)
    return {
        "observation.images.eye": bv.Camera(24, 16, fov=1.0, noise=0.02).render(world, poses, seeds=seed)["rgb"],
        "observation.state": poses[:, :3],
        "action": random.normal(size=(length, 2)),
        "done": np.arange(length) == length - 1,
        "step": np.arange(length) * 3,
    }


def written(folder: Path, lengths: tuple[int, ...] = (5, 1, 7)) -> list[dict[str, Any]]:
    episodes = [episode(length, seed) for seed, length in enumerate(lengths)]
    with bvl.Writer(folder, fps=10, robot_type="ball", names=NAMES) as writer:
        for number, arrays in enumerate(episodes):
            length = len(arrays["action"])
            writer.add_episode(arrays, "look" if number != 1 else ["turn"] * length)
        assert (writer.episodes, writer.frames) == (len(lengths), sum(lengths))
    return episodes


def test_the_layout_is_that_of_version_3(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    episodes = written(tmp_path / "set")
    files = sorted(
        str(path.relative_to(tmp_path / "set")) for path in (tmp_path / "set").rglob("*") if path.is_file()
    )
    assert files == [
        "data/chunk-000/file-000.parquet",
        "meta/episodes/chunk-000/file-000.parquet",
        "meta/info.json",
        "meta/stats.json",
        "meta/tasks.parquet",
    ]
    info = json.loads((tmp_path / "set/meta/info.json").read_text())
    assert info["codebase_version"] == "v3.0"
    assert (info["total_episodes"], info["total_frames"], info["total_tasks"], info["fps"]) == (3, 13, 2, 10)
    assert info["splits"] == {"train": "0:3"}
    assert info["data_path"].format(chunk_index=0, file_index=0) == files[0]
    assert info["features"]["observation.images.eye"] == {
        "dtype": "image",
        "shape": [16, 24, 3],
        "names": ["height", "width", "channels"],
    }
    assert info["features"]["action"] == {"dtype": "float32", "shape": [2], "names": ["speed", "turn"]}
    assert info["features"]["done"] == {"dtype": "bool", "shape": [1], "names": None}
    frames = parquet.read_table(tmp_path / "set" / files[0]).to_pydict()
    assert list(frames) == list(info["features"])
    for key in ("observation.state", "action", "step"):
        together = np.concatenate([np.asarray(arrays[key]) for arrays in episodes])
        np.testing.assert_array_equal(np.array(frames[key]), together.astype(info["features"][key]["dtype"]))
    assert frames["index"] == list(range(13))
    assert frames["frame_index"] == [*range(5), 0, *range(7)]
    assert frames["episode_index"] == [0] * 5 + [1] + [2] * 7
    assert frames["task_index"] == [0] * 5 + [1] + [0] * 7
    np.testing.assert_array_equal(
        np.array(frames["timestamp"], np.float32), np.float32(frames["frame_index"]) / np.float32(10)
    )
    pictures = np.concatenate([arrays["observation.images.eye"] for arrays in episodes])
    for row, expected in zip(frames["observation.images.eye"], pictures, strict=True):
        assert (np.asarray(image.open(io.BytesIO(row["bytes"]))) == expected).all()
    rows = parquet.read_table(tmp_path / "set/meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert [(row["dataset_from_index"], row["dataset_to_index"], row["length"]) for row in rows] == [
        (0, 5, 5),
        (5, 6, 1),
        (6, 13, 7),
    ]
    assert [row["tasks"] for row in rows] == [["look"], ["turn"], ["look"]]
    tasks = parquet.read_table(tmp_path / "set/meta/tasks.parquet")
    assert tasks.to_pydict() == {"task_index": [0, 1], "__index_level_0__": ["look", "turn"]}
    assert json.loads(tasks.schema.metadata[b"pandas"])["index_columns"] == ["__index_level_0__"]
    written(tmp_path / "again")
    for name in files:
        assert (tmp_path / "set" / name).read_bytes() == (tmp_path / "again" / name).read_bytes(), name


def test_statistics_are_those_of_all_frames(tmp_path: Path) -> None:
    episodes = written(tmp_path / "set")
    statistics = json.loads((tmp_path / "set/meta/stats.json").read_text())
    action = np.concatenate([arrays["action"] for arrays in episodes]).astype(np.float32).astype(float)
    pixels = np.concatenate([arrays["observation.images.eye"] for arrays in episodes]).reshape(-1, 3) / 255.0
    for key, values, shape in (("action", action, (2,)), ("observation.images.eye", pixels, (3, 1, 1))):
        found = statistics[key]
        assert found["count"] == [13]
        for name in ("min", "max", "mean", "std"):
            np.testing.assert_allclose(found[name], getattr(values, name)(axis=0).reshape(shape), atol=1e-9)
        for share in (1, 10, 50, 90, 99):
            expected = np.quantile(
                values, share / 100, axis=0, method="inverted_cdf" if len(shape) > 1 else "linear"
            )
            np.testing.assert_allclose(found[f"q{share:02d}"], expected.reshape(shape), atol=1e-9)
    rows = parquet.read_table(tmp_path / "set/meta/episodes/chunk-000/file-000.parquet").to_pylist()
    np.testing.assert_allclose(rows[0]["stats/action/mean"], episodes[0]["action"].mean(axis=0), rtol=1e-5)


def test_long_data_sets_have_several_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bvl, "_FILE_MB", 0.01)
    monkeypatch.setattr(bvl, "_FILES", 2)
    written(tmp_path / "set", (9, 9, 9))
    paths = sorted(
        str(path.relative_to(tmp_path / "set/data")) for path in (tmp_path / "set/data").rglob("*.parquet")
    )
    assert paths == ["chunk-000/file-000.parquet", "chunk-000/file-001.parquet", "chunk-001/file-000.parquet"]
    rows = parquet.read_table(tmp_path / "set/meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert [(row["data/chunk_index"], row["data/file_index"]) for row in rows] == [(0, 0), (0, 1), (1, 0)]


@pytest.mark.parametrize(
    ("arrays", "task", "words"),
    [
        ({}, "a", "arrays: a dictionary of arrays"),
        ({"index": [1]}, "a", "arrays: 'index' is no name of a feature"),
        ({"a/b": [1]}, "a", "arrays: 'a/b' is no name of a feature"),
        ({"a": ["x"]}, "a", r"arrays\['a'\]: its elements are <U1"),
        ({"a": np.zeros((2, 3, 4))}, "a", r"arrays\['a'\]: shape \(2, 3, 4\) of float64; images"),
        ({"a": np.zeros((0, 2))}, "a", r"arrays\['a'\]: shape \(0, 2\)"),
        ({"a": [1.0, np.nan]}, "a", r"arrays\['a'\]: finite numbers are expected"),
        ({"a": [1, 2], "b": [1]}, "a", r"arrays\['b'\]: 1 frames; 2, as the other arrays have"),
        ({"action": [[1, 2, 3]]}, "a", r"names\['action'\]: 2 names for 3 numbers"),
        ({"a": [1, 2]}, ["b"], "task: 1 texts; one, or 2"),
        ({"a": [1, 2]}, ["b", 3], r"task\[1\]: a text is expected, not 3"),
    ],
)
def test_bad_input_is_one_clear_error(tmp_path: Path, arrays: Any, task: Any, words: str) -> None:
    writer = bvl.Writer(tmp_path / "set", fps=10, names=NAMES if "action" in arrays else None)
    with pytest.raises(ValueError, match=words):
        writer.add_episode(arrays, task)
    assert not (tmp_path / "set").exists(), "nothing is written"
    with pytest.raises(ValueError, match="there is no episode"):
        writer.close()
    with pytest.raises(RuntimeError, match="after close"):
        writer.add_episode({"a": [1]}, "a")
    with pytest.raises(ValueError, match=r"folder: .* exists already"):
        bvl.Writer(tmp_path, fps=10)
    with pytest.raises(ValueError, match="fps: a whole number"):
        bvl.Writer(tmp_path / "other", fps=0)


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ({"action": 3}, r"names\['action'\]: a list of texts"),
        ({"action": "xy"}, r"names\['action'\]: a list of texts"),
        ({"action": ["x", 3]}, r"names\['action'\]\[1\]: a text"),
        (["action"], "names: a dictionary"),
        ({"action": ["x"]}, r"names\['action'\]: 1 names for 2 numbers"),
        ({"acton": ["x", "y"]}, r"names: 'acton' is no feature with numbers; there are \['action'\]"),
    ],
)
def test_bad_names_are_one_clear_error(tmp_path: Path, names: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        bvl.Writer(tmp_path / "set", fps=10, names=names).add_episode({"action": np.zeros((3, 2))}, "a")


def test_threads_add_whole_episodes(tmp_path: Path) -> None:
    def add(number: int) -> None:
        for _ in range(10):
            writer.add_episode({"a": np.full(5, number)}, f"task {number}")

    with bvl.Writer(tmp_path / "set", fps=10) as writer:
        threads = [threading.Thread(target=add, args=(number,)) for number in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    (data,) = (tmp_path / "set/data").rglob("*.parquet")
    frames = parquet.read_table(data).to_pydict()
    assert frames["index"] == list(range(200))
    for first in range(0, 200, 5):
        assert len(set(frames["a"][first : first + 5])) == 1
        assert frames["frame_index"][first : first + 5] == list(range(5))


def test_a_data_set_that_broke_off_is_not_complete(tmp_path: Path) -> None:
    writer = bvl.Writer(tmp_path / "set", fps=10)

    def break_off() -> None:
        with writer:
            writer.add_episode({"a": [1, 2]}, "b")
            raise KeyError("no more")

    with pytest.raises(KeyError, match="no more"):
        break_off()
    assert not (tmp_path / "set/meta/info.json").exists()
    (data,) = (tmp_path / "set").rglob("*.parquet")
    assert parquet.read_table(data).num_rows == 2
    writer.close()
    assert not (tmp_path / "set/meta/info.json").exists()


def test_episodes_with_other_features_are_refused(tmp_path: Path) -> None:
    with bvl.Writer(tmp_path / "set", fps=10) as writer:
        writer.add_episode({"a": [1, 2]}, "b")
        with pytest.raises(ValueError, match="differ from those of the first episode"):
            writer.add_episode({"a": [1.5, 2.5]}, "b")
    assert writer.frames == 2


def test_lerobot_reads_the_same_frames(tmp_path: Path, lerobot: Any) -> None:
    episodes = written(tmp_path / "set")
    read = lerobot.LeRobotDataset("belvedere/ball", root=tmp_path / "set", delta_timestamps={"action": [0.0, 0.1]})
    assert (read.num_episodes, read.num_frames, read.fps) == (3, 13, 10)
    assert read.meta.robot_type == "ball"
    assert list(read.meta.camera_keys) == ["observation.images.eye"]
    number = 0
    for count, arrays in enumerate(episodes):
        for frame in range(len(arrays["action"])):
            item = read[number]
            picture = item["observation.images.eye"].numpy().transpose(1, 2, 0) * 255.0
            np.testing.assert_allclose(picture, arrays["observation.images.eye"][frame], atol=1e-3)
            following = arrays["action"][[frame, min(frame + 1, len(arrays["action"]) - 1)]]
            np.testing.assert_allclose(item["action"].numpy(), following, rtol=1e-6)
            np.testing.assert_allclose(
                item["observation.state"].numpy(), arrays["observation.state"][frame], rtol=1e-6
            )
            assert item["task"] == ("turn" if count == 1 else "look")
            assert bool(item["done"]) == arrays["done"][frame]
            assert int(item["step"]) == arrays["step"][frame]
            number += 1
    mean = np.concatenate([arrays["action"] for arrays in episodes]).mean(axis=0)
    np.testing.assert_allclose(read.meta.stats["action"]["mean"], mean, rtol=1e-5)
    # LeRobot's own statistics of an episode.
    from lerobot.datasets.compute_stats import compute_episode_stats

    own = compute_episode_stats({"action": episodes[2]["action"].astype(np.float32)}, read.meta.features)["action"]
    row = parquet.read_table(tmp_path / "set/meta/episodes/chunk-000/file-000.parquet").to_pylist()[2]
    for name in ("min", "max", "mean", "std"):
        np.testing.assert_allclose(row[f"stats/action/{name}"], own[name], rtol=1e-4, atol=1e-6)
    assert row["stats/action/count"] == own["count"].tolist()
    alone = lerobot.LeRobotDataset("belvedere/ball", root=tmp_path / "set", episodes=[2])
    assert len(alone) == 7
