"""Data sets in the layout of LeRobot, version 3.0: episodes of frames with actions.

The extra ``lerobot`` installs pyarrow, which writes Parquet; LeRobot itself is not needed.

>>> import numpy, tempfile, belvedere.lerobot
>>> folder = tempfile.mkdtemp() + "/pushes"
>>> with belvedere.lerobot.Writer(folder, fps=10) as writer:
...     episode = {"observation.images.eye": numpy.zeros((5, 4, 6, 3), numpy.uint8), "action": numpy.ones((5, 2))}
...     writer.add_episode(episode, "push the box")
...     (writer.episodes, writer.frames)
(1, 5)
"""

from __future__ import annotations

import json
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import _arrays
from belvedere._closing import Closing
from belvedere._lerobot_features import Feature, Statistics, features_of
from belvedere._picture import png
from belvedere._required import required

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence
    from types import TracebackType

    from belvedere._arrays import ArrayLike

#: Files in a folder, and the length at which a file ends.
_FILES, _FILE_MB = 1000, 100
#: The columns that every data set has.
_OWN = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}


class Writer(Closing):
    """Writes a data set of LeRobot into a folder that does not exist yet; ``close`` completes it.

    Args:
        folder: the new folder.
        fps: frames per second.
        robot_type: the name of the robot.
        names: names of the numbers of features: ``{"action": ["speed", "turn"]}``.

    Raises:
        ImportError: pyarrow is not installed.
        ValueError: an argument is invalid, or the folder exists.

    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        fps: int,
        *,
        robot_type: str | None = None,
        names: Mapping[str, Sequence[str]] | None = None,
    ) -> None:
        self._arrow = required("pyarrow", "pyarrow", "belvedere.lerobot")
        self._parquet = required("pyarrow.parquet", "pyarrow", "belvedere.lerobot")
        self._folder = Path(_arrays.described("folder", folder))
        self._fps = _arrays.count("fps", fps, 1, 1_000_000)
        self._robot = None if robot_type is None else _arrays.text("robot_type", robot_type)
        if names is not None and not isinstance(names, Mapping):
            raise ValueError(f"names: a dictionary of lists of texts is expected, not {names!r}")
        self._names = {key: _arrays.texts(f"names[{key!r}]", given) for key, given in (names or {}).items()}
        if self._folder.exists():
            raise ValueError(f"folder: {str(self._folder)!r} exists already; the name of a new folder is expected")
        self._features: dict[str, Feature] = {}
        self._statistics: dict[str, Statistics] = {}
        self._tasks: dict[str, int] = {}
        self._rows: list[dict[str, Any]] = []
        self._file, self._file_length = 0, 0
        self._data: Any = None
        self._is_closed = False
        # Several threads may add episodes.
        self._lock = threading.Lock()
        #: The number of frames.
        self.frames = 0

    @property
    def episodes(self) -> int:
        """The number of episodes."""
        return len(self._rows)

    def add_episode(self, arrays: Mapping[str, ArrayLike], task: str | Sequence[str]) -> None:
        """Add an episode of T frames.

        Args:
            arrays: the features, such as ``observation.images.front`` uint8 (T, height, width, 3),
                ``observation.state`` and ``action`` (T, numbers) of whole or other numbers or bool. Those of the first
                episode are those of all. Floating-point numbers are stored in single precision.
            task: what the robot is to do, in words; or a text for each frame.

        Raises:
            ValueError: a feature is invalid, or differs from those of the first episode; nothing is written then.
            RuntimeError: ``close`` was called.

        """
        with self._lock:
            self._add(arrays, task)

    def _add(self, arrays: Mapping[str, ArrayLike], task: str | Sequence[str]) -> None:
        """Add an episode; the caller has the lock."""
        if self._is_closed:
            raise RuntimeError("add_episode cannot be called after close.")
        features, columns = features_of(arrays, self._names)
        if self._features and features != self._features:
            raise ValueError(f"arrays: {features} differ from those of the first episode, {self._features}")
        count = len(next(iter(columns.values())))
        words = [task] * count if isinstance(task, str) else _arrays.texts("task", task)
        if len(words) != count:
            raise ValueError(f"task: {len(words)} texts; one, or {count}, one a frame, is expected")
        self._features = features
        first = self.frames
        numbers = [self._tasks.setdefault(word, len(self._tasks)) for word in words]
        own = {
            "timestamp": np.arange(count, dtype=np.float32) / np.float32(self._fps),
            "frame_index": np.arange(count),
            "episode_index": np.full(count, self.episodes),
            "index": np.arange(first, first + count),
            "task_index": np.array(numbers, np.int64),
        }
        statistics: dict[str, Any] = {}
        for key, values in (columns | own).items():
            made = Statistics(values, is_image=key in features and features[key].dtype == "image")
            statistics |= {f"stats/{key}/{name}": value for name, value in made.as_lists().items()}
            if key in self._statistics:
                self._statistics[key].add(made)
            else:
                self._statistics[key] = made
        table = self._table(columns, own)
        self._next_file(table.nbytes)
        self._write(table)
        self.frames += count
        self._rows.append(
            {
                "episode_index": self.episodes,
                "tasks": list(dict.fromkeys(words)),
                "length": count,
                "data/chunk_index": self._file // _FILES,
                "data/file_index": self._file % _FILES,
                "dataset_from_index": first,
                "dataset_to_index": first + count,
                "meta/episodes/chunk_index": 0,
                "meta/episodes/file_index": 0,
                **statistics,
            }
        )

    def _table(self, columns: Mapping[str, Any], own: Mapping[str, Any]) -> Any:
        """Return the rows of an episode."""
        arrow = self._arrow
        fields, arrays = [], []
        for key, feature in self._features.items():
            values = columns[key]
            if feature.dtype == "image":
                kind = arrow.struct([("bytes", arrow.binary()), ("path", arrow.string())])
                rows = [
                    {"bytes": png(frame), "path": f"frame-{number:06d}.png"} for number, frame in enumerate(values)
                ]
                array = arrow.array(rows, kind)
            else:
                flat = arrow.array(values.reshape(-1), getattr(arrow, feature.arrow)())
                size = feature.shape[0]
                array = flat if size == 1 else arrow.FixedSizeListArray.from_arrays(flat, size)
            fields.append(arrow.field(key, array.type))
            arrays.append(array)
        for key, dtype in _OWN.items():
            array = arrow.array(own[key], getattr(arrow, dtype)())
            fields.append(arrow.field(key, array.type))
            arrays.append(array)
        return arrow.Table.from_arrays(arrays, schema=arrow.schema(fields))

    def _next_file(self, length: int) -> None:
        """Begin another file if this one would become too long."""
        if self._file_length > 0 and self._file_length + length > _FILE_MB * 1_000_000:
            self._end_file()
            self._file, self._file_length = self._file + 1, 0
        self._file_length += length

    def _write(self, table: Any) -> None:
        if self._data is None:
            path = self._folder / f"data/chunk-{self._file // _FILES:03d}/file-{self._file % _FILES:03d}.parquet"
            path.parent.mkdir(parents=True, exist_ok=True)
            # Images are compressed already.
            self._data = self._parquet.ParquetWriter(path, table.schema, compression="snappy", use_dictionary=True)
        self._data.write_table(table)

    def _end_file(self) -> None:
        if self._data is not None:
            self._data.close()
            self._data = None

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Complete the data set; after an error in the block, only close its file, so that no reader takes it for whole."""
        if error is None:
            self.close()
            return
        with self._lock:
            self._is_closed = True
            self._end_file()

    def close(self) -> None:
        """Write what describes the data set.

        Raises:
            ValueError: there is no episode.

        """
        with self._lock:
            self._complete()

    def _complete(self) -> None:
        """Write what describes the data set, once; the caller has the lock."""
        if self._is_closed:
            return
        self._is_closed = True
        self._end_file()
        if not self._rows:
            raise ValueError("there is no episode; a data set has one at least")
        arrow, meta = self._arrow, self._folder / "meta"
        (meta / "episodes/chunk-000").mkdir(parents=True)
        self._parquet.write_table(arrow.Table.from_pylist(self._rows), meta / "episodes/chunk-000/file-000.parquet")
        self._parquet.write_table(self._task_table(), meta / "tasks.parquet")
        statistics = {key: made.as_lists() for key, made in self._statistics.items()}
        (meta / "stats.json").write_text(json.dumps(statistics, indent=4))
        own = {key: {"dtype": dtype, "shape": [1], "names": None} for key, dtype in _OWN.items()}
        info = {
            "codebase_version": "v3.0",
            "robot_type": self._robot,
            "total_episodes": self.episodes,
            "total_frames": self.frames,
            "total_tasks": len(self._tasks),
            "chunks_size": _FILES,
            "data_files_size_in_mb": _FILE_MB,
            "video_files_size_in_mb": 200,
            "fps": self._fps,
            "splits": {"train": f"0:{self.episodes}"},
            "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
            "video_path": None,
            "features": {key: feature.described() for key, feature in self._features.items()} | own,
        }
        # The last file: a folder without it is not complete.
        (meta / "info.json").write_text(json.dumps(info, indent=4))

    def _task_table(self) -> Any:
        """Return the tasks as pandas stores them: the words are the index."""
        index = "__index_level_0__"
        plain = {"pandas_type": "int64", "numpy_type": "int64", "metadata": None}
        words = {"pandas_type": "unicode", "numpy_type": "object", "metadata": None}
        described = {
            "index_columns": [index],
            "column_indexes": [{"name": None, "field_name": None, **words, "metadata": {"encoding": "UTF-8"}}],
            "columns": [
                {"name": "task_index", "field_name": "task_index", **plain},
                {"name": None, "field_name": index, **words},
            ],
            "creator": {"library": "belvedere", "version": "0"},
            "pandas_version": "2.0.0",
        }
        arrow = self._arrow
        table = arrow.table(
            {"task_index": arrow.array(self._tasks.values(), arrow.int64()), index: list(self._tasks)}
        )
        return table.replace_schema_metadata({b"pandas": json.dumps(described).encode()})
