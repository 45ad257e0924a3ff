"""The command ``taotie``, the same as the program of that name."""

from __future__ import annotations

import os
import sys

from . import _taotie


def main() -> int:
    """Run the command with the arguments of this process; return its exit code."""
    # The command restarts itself with this interpreter; the process's own path need not be the environment's Python.
    os.environ.setdefault("TAOTIE_PYTHON", sys.executable)
    return _taotie.command(["taotie", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
