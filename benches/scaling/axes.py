"""What is measured: a case to begin with, and axes along which one thing alone is changed."""

import dataclasses

import machine
from measured import GRIDS, SHADINGS, triangles


@dataclasses.dataclass(frozen=True)
class Case:
    """A vessel of so many triangles, pictures of side², lights, maps of maps² texels; no threads stand for all."""

    mesh: str = "200k"
    side: int = 1024
    lights: int = 1
    maps: int = 2048
    threads: int | None = None

    @property
    def scene(self):
        """The name of what is shown."""
        return f"{self.mesh}-{self.maps}-{self.lights}"


@dataclasses.dataclass(frozen=True)
class Point:
    """A place on an axis: `amount` is that of which there is more, `label` how it is called. `line` names what a line
    of points has in common, where the axis has several."""

    amount: float
    label: str
    case: Case
    line: str = ""
    shadings: tuple = SHADINGS


@dataclasses.dataclass(frozen=True)
class Axis:
    """`title` says what the labels are."""

    name: str
    title: str
    points: tuple

    def quick(self):
        """The same with ends and base alone."""
        amounts = [point.amount for point in self.points]
        kept = {min(amounts), max(amounts), *(point.amount for point in self.points if point.case == BASE)}
        return dataclasses.replace(self, points=tuple(point for point in self.points if point.amount in kept))


BASE = Case()
# The vessel of few triangles, where threads have little to do before the tiles.
COARSE = "2k"
# The side of a picture of one tile.
TINY = 64


def axes():
    """All, by name."""
    some = (of_triangles(), of_pixels(), of_lights(), of_textures(), of_threads())
    return {axis.name: axis for axis in some}


def of_triangles():
    """Also in pictures with next to no pixels to shade."""
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
    return Axis("textures", "texels a map", tuple(points))


def of_threads():
    """1, 2, 4 and so on, and all; with many triangles and with few."""
    cores = machine.cores()
    counts = sorted({cores, *(2**i for i in range(cores.bit_length()))})
    points = []
    for mesh in (BASE.mesh, COARSE):
        line = f"{short(triangles(mesh))} triangles"
        points += [Point(n, str(n), dataclasses.replace(BASE, mesh=mesh, threads=n), line) for n in counts]
    return Axis("threads", "threads", tuple(points))
