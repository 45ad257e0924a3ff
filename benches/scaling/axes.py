"""The measured cases: a base case, and axes along each of which one thing is changed."""

import dataclasses

import machine
from measured import GRIDS, SHADINGS, triangles


@dataclasses.dataclass(frozen=True)
class Case:
    """A vessel of a mesh, images of side², lights, maps of maps² texels; `threads` None means all."""

    mesh: str = "200k"
    side: int = 1024
    lights: int = 1
    maps: int = 2048
    threads: int | None = None

    @property
    def scene(self):
        """The name of the scene."""
        return f"{self.mesh}-{self.maps}-{self.lights}"

    def is_quick(self):
        """Whether its scene is generated, and an image rendered, within seconds."""
        return self.mesh not in ("2m", "20m") and self.maps <= 2048 and self.side <= 2048


@dataclasses.dataclass(frozen=True)
class Point:
    """A position on an axis: `amount` is the quantity that increases, `label` its name. `line` is the common name of
    a line of points, if the axis has several."""

    amount: float
    label: str
    case: Case
    line: str = ""
    shadings: tuple = SHADINGS


@dataclasses.dataclass(frozen=True)
class Axis:
    """`title` describes the labels."""

    name: str
    title: str
    points: tuple

    def quick(self):
        """Only the base and the ends, without cases that take long."""
        some = [point for point in self.points if point.case.is_quick()]
        amounts = [point.amount for point in some]
        kept = {min(amounts), max(amounts), *(point.amount for point in some if point.case == BASE)}
        return dataclasses.replace(self, points=tuple(point for point in some if point.amount in kept))


BASE = Case()
# The vessel of few triangles, for which threads have little to do before the tiles.
COARSE = "2k"
# The side of an image of one tile.
TINY = 64


def axes():
    """All axes, by name."""
    some = (of_triangles(), of_pixels(), of_lights(), of_textures(), of_threads())
    return {axis.name: axis for axis in some}


def of_triangles():
    """Also in images with almost no pixels to shade."""
    points = []
    for mesh in GRIDS:
        count, case = triangles(mesh), dataclasses.replace(BASE, mesh=mesh)
        points.append(Point(count, short(count), case))
        tiny = dataclasses.replace(case, side=TINY)
        points.append(Point(count, short(count), tiny, f"{TINY}² pixels", SHADINGS[:1]))
    return Axis("triangles", "triangles", tuple(points))


def short(count):
    """2 k, 200 k, 20 M."""
    return f"{count / 1e6:.0f} M" if count >= 1e6 else f"{count / 1e3:.0f} k"


def of_pixels():
    sides = (512, 1024, 2048, 4096, 8192)
    return Axis("pixels", "pixels", tuple(Point(n * n, f"{n}²", dataclasses.replace(BASE, side=n)) for n in sides))


def of_lights():
    counts = (1, 2, 4, 8, 16, 32, 64)
    return Axis("lights", "lights", tuple(Point(n, str(n), dataclasses.replace(BASE, lights=n)) for n in counts))


def of_textures():
    sides = (256, 512, 1024, 2048, 4096, 8192)
    points = (Point(n * n, f"{n}²", dataclasses.replace(BASE, maps=n)) for n in sides)
    return Axis("textures", "texels per map", tuple(points))


def of_threads():
    """1, 2, 4 and so on, and all; with many triangles and with few."""
    cores = machine.cores()
    counts = sorted({cores, *(2**i for i in range(cores.bit_length()))})
    points = []
    for mesh in (BASE.mesh, COARSE):
        line = f"{short(triangles(mesh))} triangles"
        points += [Point(n, str(n), dataclasses.replace(BASE, mesh=mesh, threads=n), line) for n in counts]
    return Axis("threads", "threads", tuple(points))
