"""The protocol of the Python peers: lines `WIDTH HEIGHT FRAMES [PNG]` in, one line of JSON for each out.

With `--cold WIDTH HEIGHT PNG`, one image is written and the process ends.
"""

import argparse
import json
import sys
import time

import view

# The maximum number of untimed frames before the timed ones, and the seconds after which no more are started.
WARM_UP = 3
WARM_ENOUGH = 0.3


def arguments(description, shadings):
    """The arguments of every peer: the folder of the scene, the mesh, the shading."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("folder", help="folder of scene.py")
    parser.add_argument("mesh")
    parser.add_argument("shading", choices=shadings)
    parser.add_argument("--cold", nargs=3, metavar=("WIDTH", "HEIGHT", "PNG"))
    return parser.parse_args()


def peak_mib():
    """The peak memory of this process; 0 if the system does not report it."""
    try:
        with open("/proc/self/status", encoding="utf-8") as file:
            return next(int(line.split()[1]) / 1024 for line in file if line.startswith("VmHWM"))
    except OSError:
        return 0.0


def write(path, pixels):
    """Rows from the top, (height, width, 3 or 4) of uint8."""
    from PIL import Image

    Image.fromarray(pixels[..., :3].copy()).save(path)


def run(args, peer):
    """`peer` has resize(width, height), frame(angle), which ends with all pixels in memory, and picture(), which
    returns those of the last frame."""
    if args.cold:
        width, height, path = args.cold
        peer.resize(int(width), int(height))
        peer.frame(0.0)
        write(path, peer.picture())
        return
    for line in sys.stdin:
        width, height, frames, *png = line.split()
        print(json.dumps(timed(peer, int(width), int(height), int(frames), png)), flush=True)


def timed(peer, width, height, frames, png):
    """The answer to one request."""
    peer.resize(width, height)
    begun = time.perf_counter()
    for i in range(WARM_UP):
        peer.frame(i * view.STEP)
        if time.perf_counter() - begun > WARM_ENOUGH:
            break
    times = []
    for i in range(frames):
        start = time.perf_counter()
        peer.frame((WARM_UP + i) * view.STEP)
        times.append(round((time.perf_counter() - start) * 1e3, 3))
    if png:
        peer.frame(0.0)
        write(png[0], peer.picture())
    return {"ms": times, "peak_mib": round(peak_mib(), 1), "about": peer.about()}
