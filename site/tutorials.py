"""Runs every command of the tutorials, in a folder for each with the models that they use.

A comment in front of a block states what it is: `<!-- file: NAME -->` for the content of a file, `<!-- exit: N -->` for
commands that end with that code. `<!-- printed: COMMAND -->` is checked by `crates/taotie-cli/tests/models/printed.rs`.
Blocks of Python are run by `python/tests/test_notebooks.py`.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"(?:<!-- (file|exit): (.+?) -->\n)?```(\w+)\n(.*?)```", re.S)

#: The models by the name that pages use, below the folder of test data.
MODELS = {
    "nefertiti.obj": "odedstein-meshes/nefertiti/nefertiti-lowres.obj",
    "spot.obj": "odedstein-meshes/spot/spot.obj",
}


def prepare(folder: Path, data: Path) -> None:
    """Copy the models, also into a folder of scans."""
    (folder / "scans").mkdir()
    for name, path in MODELS.items():
        (source,) = data.glob(path)
        shutil.copyfile(source, folder / name)
        shutil.copyfile(source, folder / "scans" / name)


def run(page: Path, folder: Path, program: Path) -> int:
    """Run a page's commands, and return their number."""
    # No browser opens for `taotie view`.
    environment = {**os.environ, "BROWSER": "true", "PATH": f"{program.parent}{os.pathsep}{os.environ['PATH']}"}
    count = 0
    for kind, value, language, text in BLOCK.findall(page.read_text(encoding="utf-8")):
        if kind == "file":
            (folder / value).write_text(text, encoding="utf-8")
        elif language == "sh":
            done = subprocess.run(["sh", "-ec", text], cwd=folder, env=environment, capture_output=True, text=True)
            expected = int(value) if kind == "exit" else 0
            if done.returncode != expected:
                raise SystemExit(f"{page.name}: exit code {done.returncode} instead of {expected} of\n{text}\n{done.stdout}{done.stderr}")
            count += 1
    return count


def main() -> None:
    """Run the tutorials."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True, help="the program, named `taotie`")
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("TAOTIE_DATA", ROOT.parent / "shared/data")), help="the folder of test data")
    chosen = parser.parse_args()
    for page in sorted((ROOT / "docs/tutorials").glob("*.md")):
        with tempfile.TemporaryDirectory() as folder:
            prepare(Path(folder), chosen.data)
            print(f"{page.name}: {run(page, Path(folder), chosen.program.resolve())} blocks of commands", flush=True)


if __name__ == "__main__":
    main()
