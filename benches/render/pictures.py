"""Measures the differences between images of Taotie and llvmpipe: pictures.py FOLDER. Prints JSON.

For each pair, the mean absolute difference in 8-bit codes over the pixels where either shows the object, and the
fraction of the image covered by Taotie's object.
"""

import json
import os
import sys

import numpy as np
import view
from PIL import Image


def difference(ours, theirs):
    ours, theirs = (np.asarray(Image.open(path).convert("RGB")).astype(int) for path in (ours, theirs))
    shown = [np.abs(picture - view.BACKGROUND).max(-1) > 2 for picture in (ours, theirs)]
    apart = np.abs(ours - theirs)[shown[0] | shown[1]]
    return {"mean": float(apart.mean()), "coverage": float(shown[0].mean())}


def main(folder):
    found = {}
    for name in sorted(os.listdir(folder)):
        if name.endswith("-taotie.png") and not name.startswith("cold-"):
            case = name.removesuffix("-taotie.png")
            theirs = os.path.join(folder, f"{case}-llvmpipe.png")
            if os.path.exists(theirs):
                found[case] = difference(os.path.join(folder, name), theirs)
    print(json.dumps(found))


if __name__ == "__main__":
    main(sys.argv[1])
