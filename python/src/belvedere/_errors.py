"""What can go wrong, one class for each remedy."""


class BridgeError(Exception):
    """Base of all errors of this package; raised itself for failures of the transport below."""


class InvalidNameError(BridgeError, ValueError):
    """The name of a domain or topic cannot be one."""


class IncompatibleError(BridgeError):
    """The stream is of another version of iceoryx2 or of Belvedere, or not a Belvedere stream."""


class LimitError(BridgeError):
    """All places are taken: subscribers of the stream, or frames held at a time."""


class BadFrameError(BridgeError):
    """A frame's header is wrong; the frame was dropped."""


class ReleasedError(BridgeError, ValueError):
    """The frame was released, and its data are not to be looked at any more."""


class FrameInUseError(BridgeError, BufferError):
    """A frame's ``with`` block has ended while an array still points into it."""


class StreamTimeoutError(BridgeError, TimeoutError):
    """No frame, or no answer of a simulator, came in time."""


class RefusedError(BridgeError):
    """A simulator did not do what it was told; the text is its reason."""
