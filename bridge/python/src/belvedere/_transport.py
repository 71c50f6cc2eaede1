"""What iceoryx2 is told: names, types and configuration that all peers share."""

from __future__ import annotations

import ctypes
import re
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


def open_node(domain: str, name: str) -> Any:
    """Join a domain."""
    if not _DOMAIN.fullmatch(domain):
        raise InvalidNameError(f"{domain!r} cannot be a domain: 1 to 24 of a-z A-Z 0-9 _ -")
    # Its messages repeat what the errors say.
    iox2.set_log_level(iox2.LogLevel.Fatal)
    # Not from a file: a config/iceoryx2.toml in the working directory must not part two peers.
    config = iox2.config.default()
    config.global_cfg.prefix = iox2.FileName.new(f"blvd.{domain}.")
    try:
        return (
            iox2.NodeBuilder.new()
            .name(iox2.NodeName.new(name[:100]))
            .config(config)
            .signal_handling_mode(iox2.SignalHandlingMode.Disabled)
            .create(iox2.ServiceType.Ipc)
        )
    except iox2.NodeCreationFailure as error:
        raise BridgeError(
            f"joining domain {domain!r}: {error}; if /tmp/iceoryx2 belongs to another user, "
            "run as that user or remove it when nothing uses it"
        ) from error


def topic_of(topic: str) -> str:
    """Return the topic without its leading slash, checked."""
    bare = topic.removeprefix("/")
    if not _TOPIC.fullmatch(bare):
        raise InvalidNameError(f"{topic!r} cannot be a topic: parts of a-z A-Z 0-9 _ - . ~ between slashes")
    return bare


def topic_of_service(service: str) -> str | None:
    """Return the topic of a service, if it is one of ours."""
    return service.removeprefix(_SERVICE_ROOT) if service.startswith(_SERVICE_ROOT) else None


def open_stream(node: Any, topic: str) -> tuple[Any, Any]:
    """Open the frames and the events of a stream.

    Raises:
        NotThere: it does not exist now.
        IncompatibleError: it is of another version, or not one of ours.

    """
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
