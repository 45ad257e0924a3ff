"""Stages the docs site: copies of the repository's pages, and pages generated from the program.

The copies have the same arrangement as in the repository, so relative links work as they do on a forge.
"""

from __future__ import annotations

import argparse
import importlib.util
import shutil
from pathlib import Path

import gallery
from program import Program

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
SITE = ROOT / "target" / "site"

#: The pages and their pictures. `conf.py` chooses those that become pages of the site.
COPIED = [*sorted(path.name for path in ROOT.glob("*.md")), "docs", "python/notebooks"]

NOTEBOOKS = """# Notebooks

The notebooks of [python/notebooks](docs/python.md#notebooks), {how}.

```{{toctree}}
:glob:

python/notebooks/*
```
"""

NO_NAMES = """# Python names

This site was built without the Python package, so its names are not listed here. `help(taotie)` shows them, and
[Python](docs/python.md) describes them.
"""


def files(place: Path) -> list[Path]:
    """Return a file, or all files below a folder."""
    return [place] if place.is_file() else sorted(path for path in place.rglob("*") if path.is_file())


def mirror(source: Path) -> None:
    """Copy what has changed into the staged folder, and remove what is gone."""
    kept = set()
    for path in (path for name in COPIED for path in files(ROOT / name)):
        to = source / path.relative_to(ROOT)
        kept.add(to)
        to.parent.mkdir(parents=True, exist_ok=True)
        if not to.exists() or to.read_bytes() != path.read_bytes():
            shutil.copyfile(path, to)
    for gone in (path for name in COPIED for path in files(source / name) if path not in kept):
        gone.unlink()
    shutil.copyfile(HERE / "index.md", source / "index.md")


def python_pages(source: Path, has_package: bool) -> None:
    """Write the lists of notebooks and of Python's names; without the package, they say what is missing."""
    how = "run when this site was built" if has_package else "shown without results: this site was built without the Python package"
    (source / "notebooks.md").write_text(NOTEBOOKS.format(how=how), encoding="utf-8")
    names = (HERE / "python-api.md").read_text(encoding="utf-8") if has_package else NO_NAMES
    (source / "python-api.md").write_text(names, encoding="utf-8")


def program_pages(source: Path, program: Program | None) -> None:
    """Write the gallery, its pictures, and the page of the front page's frame."""
    extra = SITE / "extra"
    if program is None:
        for folder in (source / "pictures", extra):
            shutil.rmtree(folder, ignore_errors=True)
    else:
        gallery.prepare(program)
        extra.mkdir(exist_ok=True)
        shutil.copyfile(gallery.viewer(program), extra / "viewer.html")
    gallery.write(source, program)


def main() -> None:
    """Stage everything."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, help="the program that makes pictures and the viewer's page; without it they are left out")
    parser.add_argument("--check", type=Path, metavar="FOLDER", help="stage into FOLDER what `make site-check` reads: no pictures, no package")
    chosen = parser.parse_args()
    source = chosen.check or SITE / "source"
    source.mkdir(parents=True, exist_ok=True)
    mirror(source)
    has_package = chosen.check is None and importlib.util.find_spec("taotie") is not None
    python_pages(source, has_package)
    if chosen.check is None:
        program = Program(chosen.program.resolve(), SITE / "work") if chosen.program else None
        report(has_package, program)
        program_pages(source, program)
    else:
        gallery.write(source, None)


def report(has_package: bool, program: Program | None) -> None:
    """Print what the site will lack."""
    if not has_package:
        print("Notebooks have no results and Python's names are left out: the package taotie is not installed (`make wheel`).")
    if program is None:
        print("Gallery and front page have no pictures by the program: there is none (TAOTIE=/path/to/taotie, or a release build).")


if __name__ == "__main__":
    main()
