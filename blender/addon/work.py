"""A bake or a verification from start to end, in steps: generators of (stage, fraction)."""

import contextlib
import json
import re
import shlex
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

import bpy

from . import program
from .errors import show_errors
from .glb import Glb
from .objects import export, load, new_collection
from .problem import Problem, text_of

# Options of `taotie bake` with a field in the panel. Empty fields are not passed on, so defaults are the program's.
FIELDS = ("triangles", "error", "size", "require")
BAKE, VERIFY = (*FIELDS, "options"), ("require",)


@dataclass
class Request:
    """The objects, the command of the program, and its options."""

    command: list
    high: bpy.types.Object
    low: bpy.types.Object | None
    options: list
    output: Path | None = None


@dataclass
class Outcome:
    """The figures as printed, as [title, text], the report for programs, and the new collections."""

    figures: list
    report: dict
    page: Path
    asset: bpy.types.Collection | None
    error: bpy.types.Collection
    top: float
    stops: list


def options_of(settings, names):
    """Returns these fields of the form as arguments."""
    given = []
    for name in names:
        value = getattr(settings, name).strip()
        if name == "options":
            given += _split(value)
        elif value:
            given += [f"--{name}", value]
    return given


def _split(options):
    try:
        return shlex.split(options)
    except ValueError as error:
        raise Problem(f"invalid options `{options}`: {error}") from error


def bake(context, request):
    """Bakes the high object, onto the low one if there is one; returns an `Outcome`."""
    with _folder() as folder:
        scan = yield from _export(context, request.high, folder / "scan")
        # Files next to the asset have its name, which it states itself.
        name = request.output.stem if request.output else _file_name(_shown(request))
        asset = folder / "asset" / f"{name}.glb"
        asset.parent.mkdir()
        low = []
        if request.low:
            low = ["--low", (yield from _export(context, request.low, folder / "low"))]
        printed = yield from program.run(
            request.command, ["bake", scan, *low, "-o", asset, "--unit", "m", *request.options]
        )
        page = asset.with_suffix(".report.html")
        return (yield from _finish(context, request, [scan, asset, page, printed]))


def verify(context, request):
    """Compares the low object, made in any way, with the high one; returns an `Outcome`."""
    with _folder() as folder:
        scan = yield from _export(context, request.high, folder / "scan")
        asset = yield from _export(context, request.low, folder / "asset")
        page = asset.with_suffix(".report.html")
        printed = yield from program.run(
            request.command, ["verify", asset, "--scan", scan, "-o", page, "--unit", "m", *request.options]
        )
        return (yield from _finish(context, request, [scan, asset, page, printed], is_new=False))


@contextlib.contextmanager
def _folder():
    folder = Path(tempfile.mkdtemp(prefix="taotie-", dir=bpy.app.tempdir))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _file_name(name):
    return re.sub(r'[\x00-\x1f<>:"/\\|?*]', "_", name).strip(". ") or "object"


def _export(context, thing, folder):
    yield f"exporting {thing.name}", 0.0
    folder.mkdir()
    path = folder / f"{_file_name(thing.name)}.glb"
    export(context, thing, path)
    return path


def _finish(context, request, files, is_new=True):
    scan, asset, page, printed = files
    try:
        error, errors = yield from _measure(context, request, scan, asset)
        made = None
        if is_new:
            with new_collection(context, f"{_shown(request)} asset") as made:
                load(context, _plain(asset), made)
    except Exception as problem:
        if is_new and request.output:  # a bake may have taken hours
            raise Problem(f"{text_of(problem)}; the asset is complete: `{_keep(asset, request)}`") from problem
        raise
    report = json.loads(page.with_suffix(".json").read_text(encoding="utf-8"))
    page = _keep(asset, request) / page.name
    return Outcome(figures_of(printed), report, page, made, error, errors.top, errors.stops)


def _shown(request):
    return (request.low or request.high).name


def _plain(asset):
    return asset.parent.with_name("plain.glb")


def _measure(context, request, scan, asset):
    """Shows the error of an asset on its surface; returns the new collection and the errors.

    Blender's importer cannot read packed geometry, so `_plain(asset)` is without. Errors are laid out on UVs.
    """
    glb = Glb(asset)
    glb.keep_shown()
    glb.save(_plain(asset))
    glb.unwrap()
    mapped, folder = (asset.parent.with_name(name) for name in ("mapped.glb", "view"))
    glb.save(mapped)
    view = ["view", mapped, "--scan", scan, "--unit", "m", "--folder", folder]
    yield from program.run(request.command, view)
    yield "importing", 1.0
    with new_collection(context, f"{_shown(request)} error") as collection:
        return collection, show_errors(context, mapped, folder, collection)


def _keep(asset, request):
    """Moves the asset and all files next to it to the folder of the output, or of this session; returns that folder."""
    if request.output:
        folder = request.output.parent
        folder.mkdir(parents=True, exist_ok=True)
    else:
        folder = Path(tempfile.mkdtemp(prefix="taotie-report-", dir=bpy.app.tempdir))
    for file in list(asset.parent.iterdir()):
        shutil.move(file, folder / file.name)
    return folder


def figures_of(printed):
    """Returns the lines of the program, `title   text`, as pairs."""
    pairs = (re.match(r"(\S.*?)\s{2,}(.*)", line) for line in printed.splitlines())
    return [list(pair.groups()) for pair in pairs if pair]
