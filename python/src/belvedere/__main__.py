"""The command line of Belvedere: ``python -m belvedere run --ros2``, or ``belvedere run --ros2``."""

from __future__ import annotations

import os
import signal
import sys

from belvedere import _native
from belvedere._world import MODELS


def main() -> int:
    """Run the command line of this process, and return its exit code."""
    if os.path.isdir(MODELS):
        os.environ.setdefault("BELVEDERE_MODELS", MODELS)
    # Python's own handler would only be called after the command.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.run_words(["belvedere", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
