"""The settings to try: those of the page, and the few of the quick check."""

import dataclasses


@dataclasses.dataclass(frozen=True)
class Precision:
    """Options of gltfpack for the bits of normals, positions and UVs, which are 8, 14 and 12 by default.

    Tried on assets of at least `least` and at most `most` degrees.
    """

    options: tuple[str, ...]
    least: float
    most: float


@dataclasses.dataclass(frozen=True)
class Grid:
    """Values of each option.

    `ratios` of triangles are for gltfpack and `transform_ratios` for gltf-transform; `sides` (texels, 0 for the model's
    own) and `qualities` are for WebP, and gltfpack also gets textures as they are if `is_original_tried`. `precisions`
    are tried on promising assets of gltfpack. `errors` are for Taotie in degrees, None for its default options.
    """

    ratios: tuple[float, ...]
    transform_ratios: tuple[float, ...]
    sides: tuple[int, ...]
    qualities: tuple[int, ...]
    is_original_tried: bool
    precisions: tuple[Precision, ...]
    errors: tuple[float | None, ...]

    @property
    def most_degrees(self):
        """Assets with more degrees are not refined."""
        return max(precision.most for precision in self.precisions)

    def precisions_at(self, degrees):
        """The options of the precisions that are worth trying on an asset with this many degrees."""
        return [own.options for own in self.precisions if own.least <= degrees <= own.most]

    def sides_below(self, own):
        """The texture sizes below the original, and the original; none without textures."""
        return [side for side in self.sides if side < own]


FINE = Precision(("-vn", "10"), 0, 0.8)
MEDIUM = Precision(("-vp", "12", "-vt", "10"), 0, 6)
COARSE = Precision(("-vn", "6", "-vp", "12", "-vt", "10"), 1, 6)

RATIOS = (1, 0.5, 0.3, 0.2, 0.1, 0.05, 0.02)

FULL = Grid(
    ratios=RATIOS,
    transform_ratios=RATIOS,
    sides=(0, 1024, 512, 256),
    qualities=(97, 90, 75, 50, 30),
    is_original_tried=True,
    precisions=(FINE, MEDIUM, COARSE),
    errors=(0.3, 0.5, 1, 2, 4, None),
)
QUICK = Grid(
    ratios=(1, 0.5),
    transform_ratios=(),
    sides=(512, 256),
    qualities=(90, 50),
    is_original_tried=False,
    precisions=(MEDIUM,),
    errors=(0.7, 1),
)
