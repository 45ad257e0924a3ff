"""The command ``taotie``, the same as the program of that name."""

from __future__ import annotations

import os
import sys

from . import _taotie


def main() -> int:
    """Run the command with the arguments of this process; return its exit code."""
    # By which the command starts itself again; what the system tells of this process is not the environment's Python.
    os.environ.setdefault("TAOTIE_PYTHON", sys.executable)
    return _taotie.command(["taotie", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
