"""Objects that stay in their process."""

from __future__ import annotations

from typing import NoReturn


class Unpicklable:
    """An object with memory of the native module, which cannot be sent to other processes."""

    #: The alternative, for the error message.
    _instead: str

    def __reduce__(self) -> NoReturn:
        """Raise an error that says what to do.

        Raises:
            TypeError: always.

        """
        raise TypeError(f"a {type(self).__name__} cannot be pickled: {self._instead}")
