"""``python -m taotie`` is the command ``taotie``."""

import sys

from ._command import main

sys.exit(main())
