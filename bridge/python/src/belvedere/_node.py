"""This process's membership of a domain."""

from __future__ import annotations

import os
from typing import Any, NamedTuple

import iceoryx2 as iox2

from belvedere import _transport
from belvedere._closing import Closing
from belvedere._errors import BridgeError
from belvedere._subscriber import Subscriber
from belvedere._velocity import VelocityPublisher


class StreamInfo(NamedTuple):
    """A stream that exists; None where its publisher says nothing."""

    topic: str
    kind: str | None
    encoding: str | None
    rate_hz: float | None
    frame_id: str | None


class Node(Closing):
    """Membership of a domain, which is one simulation's name for all that it shares.

    If ``domain`` is None it is that of the environment variable ``BELVEDERE_DOMAIN``, else ``default``. ``name`` is
    for listings. No signal handler is installed.
    """

    def __init__(self, name: str = "python", domain: str | None = None) -> None:
        self._domain = domain if domain is not None else os.environ.get("BELVEDERE_DOMAIN") or "default"
        self._node: Any = _transport.open_node(self._domain, name)

    @property
    def domain(self) -> str:
        """The domain that was joined."""
        return self._domain

    def subscribe(self, topic: str) -> Subscriber:
        """Follow a stream, whether it exists already or not. A leading slash is ignored."""
        return Subscriber(self._joined(), _transport.topic_of(topic))

    def velocity_publisher(self, topic: str = "cmd_vel") -> VelocityPublisher:
        """Open a velocity command stream for sending; several processes may."""
        return VelocityPublisher(self._joined(), _transport.topic_of(topic))

    def streams(self) -> list[StreamInfo]:
        """List what is there in the domain, by topic."""
        found = {}
        for service in iox2.Service.list(self._joined().config, iox2.ServiceType.Ipc):
            topic = _transport.topic_of_service(service.name().to_string())
            if topic is None or service.messaging_pattern() != iox2.MessagingPattern.PublishSubscribe:
                continue
            said = {
                attribute.key.to_string(): attribute.value.to_string() for attribute in service.attributes().values
            }
            rate = said.get("rate_hz")
            found[topic] = StreamInfo(
                topic,
                said.get("kind"),
                said.get("encoding"),
                float(rate) if rate else None,
                said.get("frame_id"),
            )
        return [found[topic] for topic in sorted(found)]

    def close(self) -> None:
        """Leave the domain, as far as subscribers and publishers made from it are closed."""
        self._node = None

    def _joined(self) -> Any:
        if self._node is None:
            raise BridgeError("the node was closed: open another")
        return self._node
