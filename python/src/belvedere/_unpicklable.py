"""What stays in its process."""

from __future__ import annotations

from typing import NoReturn


class Unpicklable:
    """Something whose memory is the native module's: it is not sent to other processes."""

    #: What to do in place of that.
    _instead: str

    def __reduce__(self) -> NoReturn:
        """Raise an error that says what to do.

        Raises:
            TypeError: always.

        """
        raise TypeError(f"a {type(self).__name__} cannot be pickled: {self._instead}")
