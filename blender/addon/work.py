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
from .problem import Problem

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
        asset = folder / f"{_file_name((request.low or request.high).name)}.glb"
        low = []
        if request.low:
            low = ["--low", (yield from _export(context, request.low, folder / "low"))]
        printed = yield from program.run(
            [*request.command, "--progress", "bake", scan, *low, "-o", asset, "--unit", "m", *request.options]
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
            [*request.command, "--progress", "verify", asset, "--scan", scan, "-o", page, "--unit", "m", *request.options]
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
    # Blender's importer cannot read packed geometry, and errors are laid out on UVs.
    plain = asset.with_name("plain") / asset.name
    plain.parent.mkdir()
    glb = Glb(asset)
    glb.save(plain)
    mapped = plain.with_name("mapped.glb")
    glb.unwrap()
    glb.save(mapped)
    folder = plain.parent / "view"
    view = [*request.command, "--progress", "view", mapped, "--scan", scan, "--unit", "m", "--folder", folder]
    yield from program.run(view)
    yield "importing", 1.0
    shown = (request.low or request.high).name
    error = new_collection(context, f"{shown} error")
    errors = show_errors(context, mapped, folder, error)
    made = None
    if is_new:
        made = new_collection(context, f"{shown} asset")
        load(context, plain, made)
    report = json.loads(page.with_suffix(".json").read_text(encoding="utf-8"))
    page = _keep([page, page.with_suffix(".json"), asset], request)
    return Outcome(figures_of(printed), report, page, made, error, errors.top, errors.stops)


def _keep(files, request):
    """Moves asset and reports to the folder of the output, or of this session; returns the first."""
    asset = files[-1]
    if request.output:
        request.output.parent.mkdir(parents=True, exist_ok=True)
        target = request.output
    else:
        target = Path(tempfile.mkdtemp(prefix="taotie-report-", dir=bpy.app.tempdir)) / asset.name
    for file in files:
        shutil.move(file, target.with_name(target.stem + file.name.removeprefix(asset.stem)))
    return target.with_name(target.stem + files[0].name.removeprefix(asset.stem))


def figures_of(printed):
    """Returns the lines of the program, `title   text`, as pairs."""
    pairs = (re.match(r"(\S.*?)\s{2,}(.*)", line) for line in printed.splitlines())
    return [list(pair.groups()) for pair in pairs if pair]
