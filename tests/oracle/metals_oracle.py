"""F0 and F82 of metals from measured n and k, for the presets and their test.

    python metals_oracle.py PATH/TO/material-constants/refractiveindex

Exact unpolarised Fresnel reflectance of n + ik for 380 to 780 nm in 5 nm steps (n and k interpolated linearly),
the CIE 1931 2 degree observer, D65, linear sRGB. Writes `metals_oracle.json`:

    {name: {source, f0: [r, g, b], f82: [r, g, b]}}; f82 is at cos = 1/7; values above 1 are out of gamut, unclipped
"""

import json
import sys
from pathlib import Path

import colour
import numpy as np

METALS = {
    "copper": "main/Cu/nk/Johnson.yml",
    "cu90zn10": "other/alloys/Cu-Zn/nk/Querry-Cu90Zn10.yml",
    "cu85zn15": "other/alloys/Cu-Zn/nk/Querry-Cu85Zn15.yml",
    "brass": "other/alloys/Cu-Zn/nk/Querry-Cu70Zn30.yml",
    "gold": "main/Au/nk/Johnson.yml",
    "silver": "main/Ag/nk/Johnson.yml",
}
WAVELENGTHS = np.arange(380, 781, 5)
# Chromaticities of IEC 61966-2-1: red, green, blue, white
PRIMARIES = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])


def read_nk(path):
    """The rows `wavelength/um n k` of a refractiveindex.info file."""
    rows = []
    for line in path.read_text().splitlines():
        try:
            numbers = [float(word) for word in line.split()]
        except ValueError:
            continue
        if len(numbers) == 3:
            rows.append(numbers)
    return np.array(rows).T


def reflectance(cos, index):
    cos_t = np.sqrt(1 - (1 - cos**2) / index**2)
    r_s = (cos - index * cos_t) / (cos + index * cos_t)
    r_p = (index * cos - cos_t) / (index * cos + cos_t)
    return (abs(r_s) ** 2 + abs(r_p) ** 2) / 2


def observer():
    """Weights of each wavelength in X, Y, Z under D65, Y of a perfect mirror being 1."""
    shape = colour.SpectralShape(380, 780, 5)
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape).values
    d65 = colour.SDS_ILLUMINANTS["D65"].copy().align(shape).values
    weights = cmfs * d65[:, None]
    return weights / weights[:, 1].sum()


def srgb_from_xyz(white):
    """The matrix that takes the primaries' colours to the axes and `white` to (1, 1, 1)."""
    xyz = np.column_stack([PRIMARIES / PRIMARIES[:, 1:], (1 - PRIMARIES.sum(axis=1)) / PRIMARIES[:, 1]]).T
    scales = np.linalg.solve(xyz, white)
    return np.linalg.inv(xyz * scales)


def main():
    folder = Path(sys.argv[1])
    weights = observer()
    matrix = srgb_from_xyz(weights.sum(axis=0))
    out = {}
    for name, source in METALS.items():
        micrometres, n, k = read_nk(folder / source)
        nanometres = micrometres * 1000
        index = np.interp(WAVELENGTHS, nanometres, n) + 1j * np.interp(WAVELENGTHS, nanometres, k)
        rgb = lambda cos: [round(float(x), 6) for x in matrix @ (reflectance(cos, index) @ weights)]
        out[name] = {"source": source, "f0": rgb(1.0), "f82": rgb(1 / 7)}
    Path(__file__).with_suffix(".json").write_text(json.dumps(out, indent=1) + "\n")


if __name__ == "__main__":
    main()
