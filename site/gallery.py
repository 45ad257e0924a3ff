"""The gallery: every shading model, surface method, map, output variable, tone curve, and how errors look.

Names come from `python/taotie/_options.py`, whose types list what the program accepts: a new one without a picture is an
error. Commands are shown as they are run.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import lamp
import numpy as np
from PIL import Image as Picture
from program import Program

OPTIONS = Path(__file__).resolve().parent.parent / "python/taotie/_options.py"
JUE = "taotie-demo/jue.obj"
HIGH = "taotie-demo/jue-high.glb"
SIZE = "--size 480x480 --samples 16"
RAKING = '--light "directional from=-78,12 strength=7" --light "directional from=40,30 strength=0.5" --ambient 0.06'
CLOSE = f"{RAKING} --orbit 14,10,0.17 --target 0,0.115,0 {SIZE}"

#: Commands that make what the others read.
MODELS = [
    "taotie demo --high",
    f"taotie normals taotie-demo/jue_normal.png --to object --mesh {JUE} -o jue-object.png",
]

#: Commands that make the page of the front page's viewer.
VIEWER = [
    "taotie demo --high",
    f"taotie bake {JUE} --low {JUE} --maps normal,albedo,metallic-roughness --size 1024 --images webp:85/webp:80/webp:75 --no-verify -o jue.glb",
    'taotie view jue.glb --light "directional from=-78,12 strength=7" --title "A bronze jue" -o viewer.html',
]


@dataclass
class Item:
    """A picture: its name, the command that makes it, the file, and a remark."""

    name: str
    command: str
    file: str
    remark: str = ""


def accepted(type_name: str) -> list[str]:
    """Return the names that the program accepts, by the type of Python's options."""
    for node in ast.walk(ast.parse(OPTIONS.read_text(encoding="utf-8"))):
        if isinstance(node, ast.AnnAssign) and getattr(node.target, "id", "") == type_name:
            return list(ast.literal_eval(node.value.slice))  # type: ignore[union-attr]
    raise SystemExit(f"{OPTIONS}: no type `{type_name}`; update site/gallery.py")


def matched(type_name: str, known: dict[str, object]) -> list[str]:
    """Return the accepted names, after making sure that these are the ones known here."""
    names = accepted(type_name)
    if set(names) != set(known):
        raise SystemExit(f"site/gallery.py: pictures for {sorted(known)}, but {type_name} accepts {sorted(names)}")
    return names


def shading() -> Iterator[Item]:
    """The reflectance models."""
    for name in accepted("Shading"):
        file = f"shading-{name}.png"
        yield Item(name, f"taotie render {JUE} --shading {name} {CLOSE} -o {file}", file)


def surfaces() -> Iterator[Item]:
    """The sources of the shading normal."""
    height = "--height-map taotie-demo/jue_height.png"
    extra = {
        "facet": ("", "each triangle's own normal"),
        "smooth": ("", "the normals of the vertices"),
        "bump": (f"{height} --bump-scale 0.0042", "the slope of a height map"),
        "bump-printed": (f"{height} --bump-scale 5", "the same with [the formula of a paper](docs/as-printed.md), as printed"),
        "object-normal": ("--normal-map jue-object.png --normal-space object", "a normal map in object space"),
        "tangent-normal": ("", "a normal map in tangent space, as in glTF"),
    }
    for name in matched("Surface", extra):
        options, remark = extra[name]
        file = f"surface-{name}.png"
        options = f" {options}" if options else ""
        yield Item(name, f"taotie render {JUE} --surface {name}{options} {CLOSE} -o {file}", file, remark)


def maps() -> Iterator[Item]:
    """The maps of `taotie bake`. A command may write several; the lamp's are those that a bronze does not have."""
    bronze = f"taotie bake {HIGH} --low {JUE} --size 512 --no-verify"
    together = f"{bronze} --maps normal,albedo,height,bent,curvature,convexity,concavity,metallic-roughness -o maps.png"
    points = f"{bronze} --maps normal,position,world-normal,thickness,wireframe,bevel,vector-displacement,gradient -o points.png"
    lamps = "taotie bake lamp.gltf --low lamp.gltf --size 512 --no-verify --maps emission,alpha,occlusion -o lamp.png"
    ids = "taotie bake lamp-parts.obj --low lamp.gltf --size 512 --no-verify --maps normal,vertex-color,material-id,object-id -o ids.png"
    known = {
        "normal": (together, "maps.png", "the relief, in tangent space"),
        "ao": (f"{bronze} --maps ao -o ao.png", "ao.png", "ambient occlusion, by rays"),
        "albedo": (together, "maps.albedo.png", "the scan's base colour"),
        "height": (together, "maps.height.png", "the distance from the low-poly mesh"),
        "bent": (together, "maps.bent.png", "the mean open direction"),
        "curvature": (together, "maps.curvature.png", "ridges bright, grooves dark"),
        "roughness": (f"{bronze} --maps roughness -o roughness.png", "roughness.png", "widened by relief finer than a texel"),
        "metallic-roughness": (together, "maps.metallic-roughness.png", "glTF's channels: roughness in green, metalness in blue"),
        "emission": (lamps, "lamp.emission.png", "emitted light, of a lamp"),
        "alpha": (lamps, "lamp.png", "the openings of its shade, in the base colour"),
        "occlusion": (lamps, "lamp.occlusion.png", "the scan's own occlusion texture"),
        "position": (points, "points.position.png", "x, y and z from the centre"),
        "world-normal": (points, "points.world-normal.png", "the scan's normals in its own space"),
        "thickness": (points, "points.thickness.png", "the mean distance to the other side"),
        "wireframe": (points, "points.wireframe.png", "the edges of the low-poly mesh"),
        "bevel": (points, "points.bevel.png", "the scan's normals with rounded edges"),
        "vector-displacement": (points, "points.vector-displacement.png", "the vector from the low-poly mesh to the scan"),
        "convexity": (together, "maps.convexity.png", "ridges, for worn edges"),
        "concavity": (together, "maps.concavity.png", "grooves, for dirt"),
        "gradient": (points, "points.gradient.png", "from the lowest to the highest point"),
        "vertex-color": (ids, "ids.vertex-color.png", "the colours of the scan's vertices"),
        "material-id": (ids, "ids.material-id.png", "a colour for each material"),
        "object-id": (ids, "ids.object-id.png", "a colour for each object"),
    }
    for name in matched("Map", known):
        command, file, remark = known[name]
        yield Item(name, command, file, remark)


def variables() -> Iterator[Item]:
    """The output variables of `taotie render --aov`."""
    names = accepted("Aov")
    command = f"taotie render {JUE} --size 480x480 --aov {','.join(names)} -o aov.png"
    for name in names:
        yield Item(name, command, f"aov.{name}.png")


def tones() -> Iterator[Item]:
    """The tone curves."""
    for name in accepted("Tone"):
        file = f"tone-{name}.png"
        yield Item(name, f"taotie render {JUE} --env studio --exposure 1 --tone {name} {SIZE} -o {file}", file)


def integrators() -> Iterator[Item]:
    """Ways to compute the light."""
    studio = f"taotie render {JUE} --env studio --ground --size 480x480"
    yield Item("raster", f"{studio} --samples 16 -o raster.png", "raster.png", "the rasteriser, with a ground that catches the shadow")
    yield Item("reference", f"{studio} --integrator reference --spp 64 -o reference.png", "reference.png", "the path tracer")
    yield Item("raking light", f"taotie render {JUE} --shadows {CLOSE} -o raking.png", "raking.png", "with ray-traced shadows")


def errors() -> Iterator[Item]:
    """How far methods are from the relief as geometry."""
    command = f"taotie compare {JUE} --reference {HIGH} --match uv --method smooth,tangent-normal --shading ggx -o comparison"
    for name in ("smooth", "tangent-normal"):
        yield Item(f"{name}, angles", command, f"comparison/{name}.error.png", "between normals, up to 30°")
        yield Item(f"{name}, FLIP", command, f"comparison/{name}.ggx.flip.png", "visible difference of the images")


def materials() -> Iterator[Item]:
    """The presets."""
    yield Item("all presets", "taotie materials -o materials.png", "materials.png", "in the studio")


SECTIONS = [
    ("Shading models", "`--shading` of `render`, `compare` and `view`; [formulas and their sources](docs/glossary.md#reflectance).", shading),
    ("Surface methods", "`--surface`: where the shading normal comes from, on a mesh of 352 triangles.", surfaces),
    ("Maps", "`--maps` of [`taotie bake`](docs/bake.md), from 2.3 million triangles onto 352.", maps),
    ("Light", "The rasteriser, and the path tracer that it is [measured against](docs/errors.md).", integrators),
    ("Errors", "What [`taotie compare`](docs/compare.md) draws: the map takes the error from all over the relief to a few edges.", errors),
    ("Output variables", "`--aov`: [values for compositing](docs/output-variables.md), also as EXR.", variables),
    ("Tone curves", "`--tone`, one stop brighter than the default.", tones),
    ("Materials", "`--material`; [`taotie materials`](docs/help/materials.md) lists their colours and sources.", materials),
]


def prepare(program: Program) -> None:
    """Run all commands."""
    lamp.write(program.folder)
    for command in MODELS:
        program.run(command)
    for _, _, items in SECTIONS:
        for item in items():
            program.run(item.command)


def viewer(program: Program) -> Path:
    """Make the page of the viewer, and return it."""
    for command in VIEWER:
        program.run(command)
    return program.folder / "viewer.html"


def write(source: Path, program: Program | None) -> None:
    """Write the page, and its pictures if there is a program."""
    parts = ["# Gallery\n"]
    if program is None:
        parts.append("This site was built without the program, so only the commands are here.\n")
    parts.append("All commands run in one folder, after these. `site/lamp.py` writes the lamp.\n")
    parts.append("```sh\n" + "\n".join(MODELS) + "\n```\n")
    for title, text, items in SECTIONS:
        parts.append(f"## {title}\n\n{text}\n\n:::::{{container}} gallery\n")
        parts += [entry(item, source, program) for item in items()]
        parts.append(":::::\n")
    (source / "gallery.md").write_text("\n".join(parts), encoding="utf-8")


def entry(item: Item, source: Path, program: Program | None) -> str:
    """Return one picture with its name, remark and command."""
    name = f"**{item.name}**" + (f": {item.remark}" if item.remark else "")
    command = f"```sh\n{item.command}\n```"
    if program is None:
        return f"::::{{container}} picture\n{name}\n\n{command}\n::::\n"
    path = f"pictures/{item.file.removesuffix('.png').replace('/', '-')}.webp"
    small(program.folder / item.file, source / path)
    return f"::::{{container}} picture\n![{item.name}]({path})\n\n{name}\n\n{command}\n::::\n"


def small(file: Path, to: Path) -> None:
    """Write a picture as WebP with 8 bits, at most 480 pixels wide, or 1280 if it is a sheet."""
    to.parent.mkdir(exist_ok=True)
    with Picture.open(file) as image:
        side = 480 if image.width <= 1.5 * image.height else 1280
        if image.mode.startswith("I"):
            image = Picture.fromarray((np.asarray(image) // 257).astype(np.uint8))
        picture = image.convert("RGBA" if "A" in image.getbands() else "RGB")
        picture.thumbnail((side, side))
        picture.save(to, quality=85, method=4)
