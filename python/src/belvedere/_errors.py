"""Errors, one class for each remedy."""


class BridgeError(Exception):
    """Base of all errors of this package; raised itself for failures of the transport."""


class InvalidNameError(BridgeError, ValueError):
    """The name of a domain or topic is unusable."""


class IncompatibleError(BridgeError):
    """The stream is of another version of iceoryx2 or of Belvedere, or is not a Belvedere stream."""


class LimitError(BridgeError):
    """A limit is reached: subscribers of the stream, or frames held at a time."""


class BadFrameError(BridgeError):
    """The header of a frame is invalid; the frame was dropped."""


class ReleasedError(BridgeError, ValueError):
    """The frame was released, and its data must not be accessed any more."""


class FrameInUseError(BridgeError, BufferError):
    """A frame's ``with`` block has ended while an array still points into it."""


class StreamTimeoutError(BridgeError, TimeoutError):
    """No frame, or no answer of a simulator, arrived in time."""


class RefusedError(BridgeError):
    """A simulator refused a command; the text is its reason."""
