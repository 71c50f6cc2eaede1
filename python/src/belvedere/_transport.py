"""What iceoryx2 is told: names, types and configuration that all peers share."""

from __future__ import annotations

import contextlib
import ctypes
import os
import re
from pathlib import Path
from typing import Any

import iceoryx2 as iox2

from belvedere import wire
from belvedere._errors import BridgeError, IncompatibleError, InvalidNameError

_SERVICE_ROOT = "belvedere/"
_DOMAIN = re.compile(r"[A-Za-z0-9_-]{1,24}")
_TOPIC = re.compile(r"(?!.*//)[A-Za-z0-9_.~-][A-Za-z0-9_/.~-]{0,199}(?<!/)")


class FrameHeader(ctypes.Structure):
    """Name and size of the user header; its fields are in ``wire.HEADER``."""

    _fields_ = (("words", ctypes.c_uint64 * (wire.HEADER_LEN // 8)),)

    @staticmethod
    def type_name() -> str:
        """Return the name that iceoryx2 compares."""
        return wire.HEADER_TYPE_NAME


class NotThere(Exception):
    """The stream does not exist now."""


class Membership:
    """Joins a domain, and leaves it when nobody refers to this any more.

    All that is made from the node refers to it, so that it goes last: iceoryx2 keeps a file after the last node of
    a domain, which is removed here as the simulator does.
    """

    def __init__(self, domain: str, name: str) -> None:
        if not _DOMAIN.fullmatch(domain):
            raise InvalidNameError(f"{domain!r} cannot be a domain: 1 to 24 of a-z A-Z 0-9 _ -")
        if group := os.environ.get("BELVEDERE_GROUP"):
            # Nothing would come: the domain that is shared with a group is another one.
            raise BridgeError(
                f"BELVEDERE_GROUP is {group!r}, and this package cannot open its files to a group: run it as the "
                "simulator's user without that variable, or use the C++ or Rust library (see bridge/SECURITY.md)"
            )
        # Its messages repeat what the errors say.
        iox2.set_log_level(iox2.LogLevel.Fatal)
        # Not from a file: a config/iceoryx2.toml in the working directory must not part two peers.
        self._config = iox2.config.default()
        # Each user has domains of their own, in a directory of their own.
        self._prefix = f"blvd.{domain}~{os.geteuid()}."
        directory = f"/tmp/blvd~{os.geteuid()}"
        self._config.global_cfg.prefix = iox2.FileName.new(self._prefix)
        self._config.global_cfg.root_path = iox2.Path.new(directory)
        try:
            self.node: Any = (
                iox2.NodeBuilder.new()
                .name(iox2.NodeName.new(name[:100]))
                .config(self._config)
                .signal_handling_mode(iox2.SignalHandlingMode.Disabled)
                .create(iox2.ServiceType.Ipc)
            )
        except iox2.NodeCreationFailure as error:
            raise BridgeError(
                f"joining domain {domain!r}: {error}; if {directory} belongs to another user, "
                "that user or an administrator must remove it"
            ) from error

    def __del__(self) -> None:
        if not hasattr(self, "node"):
            return
        del self.node
        # Another process may be doing the same, or just joining the domain.
        with contextlib.suppress(OSError, iox2.NodeListFailure):
            self._remove_traces()

    def _remove_traces(self) -> None:
        """Remove the domain's node counter and the directories of all domains, if nobody is left in them."""
        states = iox2.Node.list(iox2.ServiceType.Ipc, self._config)
        if any(not isinstance(state, iox2.NodeState.Dead) for state in states):
            return
        for path in Path("/dev/shm").glob(f"{self._prefix}*.global_mgmt"):
            path.unlink()
        # Only empty directories can be removed this way; while any node of any domain lives, the first is not.
        root = Path(self._config.global_cfg.root_path.to_string())
        for directory in (root / "nodes", root / "services", root):
            directory.rmdir()


def topic_of(topic: str) -> str:
    """Return the topic without its leading slash, checked."""
    bare = topic.removeprefix("/")
    if not _TOPIC.fullmatch(bare):
        raise InvalidNameError(f"{topic!r} cannot be a topic: parts of a-z A-Z 0-9 _ - . ~ between slashes")
    return bare


def topic_of_service(service: str) -> str | None:
    """Return the topic of a service, if it is one of ours."""
    return service.removeprefix(_SERVICE_ROOT) if service.startswith(_SERVICE_ROOT) else None


def open_stream(membership: Membership, topic: str) -> tuple[Any, Any]:
    """Open the frames and the events of a stream.

    Raises:
        NotThere: it does not exist now.
        IncompatibleError: it is of another version, or not one of ours.

    """
    node = membership.node
    name = iox2.ServiceName.new(f"{_SERVICE_ROOT}{topic}")
    try:
        frames = (
            node.service_builder(name).publish_subscribe(iox2.Slice[ctypes.c_uint8]).user_header(FrameHeader).open()
        )
        return frames, node.service_builder(name).event().open_or_create()
    except (iox2.PublishSubscribeOpenError, iox2.EventOpenError) as error:
        text = str(error)
        if any(word in text for word in ("DoesNotExist", "MarkedForDestruction", "HangsInCreation", "Interrupt")):
            raise NotThere from error
        if any(word in text for word in ("Incompatible", "Corrupted", "VersionMismatch")):
            raise IncompatibleError(
                f"{topic} cannot be read: {text}. This package has iceoryx2 0.10.0 and the wire format "
                f"{wire.HEADER_TYPE_NAME}; the publisher must have the same"
            ) from error
        raise BridgeError(f"opening {topic}: {text}") from error
