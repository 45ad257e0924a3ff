"""Parameters of measured frames: shadings, the grids of the vessel, Taotie's programs and their light options."""

import os

SHADINGS = ("cook-torrance", "ggx")
# Cells around and from bottom to top; two triangles each.
GRIDS = {"2k": (32, 32), "20k": (100, 100), "200k": (320, 312), "2m": (1000, 1000), "20m": (3200, 3125)}
# Duplicates view.py, which needs NumPy; processes that only measure stay small.
AMBIENT = 0.04


def triangles(mesh):
    around, along = GRIDS[mesh]
    return 2 * around * along


def frames(programs):
    """The example in the folder that contains taotie, and frames or examples/frames."""
    installed = os.path.join(programs, "frames")
    return installed if os.path.exists(installed) else os.path.join(programs, "examples", "frames")


def light(folder, shading, option):
    """The light in addition to the file's: options of frames or taotie."""
    return [option, os.path.join(folder, "environment.hdr")] if shading == "ggx" else ["--ambient", str(AMBIENT)]
