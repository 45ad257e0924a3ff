"""Times the first image of a scan with Taotie and other packages, in fresh headless processes: `make bench-python`.

The scripts in `first_picture` are what a user would write. Each package has a separate environment, so that its size
on disk, with all dependencies, is known. Processes alternate.
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import sys

import measure

HERE = pathlib.Path(__file__).parent
# The installation of each; pyrender requires an older PyOpenGL, which has no OSMesa contexts with attributes.
PACKAGES = {
    "taotie": [["{wheel}"]],
    "pyrender": [["pyrender==0.1.45"], ["--no-deps", "PyOpenGL==3.1.10"]],
    "mitsuba": [["mitsuba==3.9.1", "numpy==2.4.6"]],
    "open3d": [["open3d==0.20.0"]],
    "pyvista": [["pyvista==0.48.0"]],
    "bpy": [["bpy==5.0.1"]],
}


def install(name, folder, wheel):
    """Creates the environment of a package; returns its interpreter."""
    place = folder / name
    python = place / "bin" / "python"
    if not (place / "ready").exists():
        subprocess.run([sys.executable, "-m", "venv", "--clear", str(place)], check=True)
        for arguments in PACKAGES[name]:
            words = [word.format(wheel=wheel) for word in arguments]
            subprocess.run([str(python), "-m", "pip", "install", "--quiet", *words], check=True)
        (place / "ready").touch()
    return python


def size(python):
    """MiB of the packages of an environment, except for pip."""
    (site,) = (python.parent.parent / "lib").glob("python*/site-packages")
    files = (path for path in site.rglob("*") if path.is_file() and not path.is_symlink())
    own = (path for path in files if path.relative_to(site).parts[0].split("-")[0] not in ("pip", "setuptools", "pkg_resources"))
    return sum(path.stat().st_size for path in own) / 2**20


def lines(script):
    return sum(1 for line in script.read_text().splitlines() if line.strip())


def is_picture(path, python):
    """Whether a file contains a visible image."""
    code = (
        "import sys; from PIL import Image; image = Image.open(sys.argv[1]).convert('L').resize((64, 48));"
        "low, high = image.getextrema(); sys.exit(high - low < 30)"
    )
    return path.is_file() and subprocess.run([python, "-c", code, str(path)], check=False).returncode == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--wheel", required=True, help="Taotie's wheel")
    parser.add_argument("--model", required=True, help="a PLY scan, which all of them read")
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("target/bench-python"), help="working folder")
    parser.add_argument("--only", nargs="*", default=list(PACKAGES), help="packages")
    parser.add_argument("--rounds", type=int, default=5, help="processes per package")
    args = parser.parse_args()
    folder = args.folder.absolute()
    (folder / "pictures").mkdir(parents=True, exist_ok=True)
    measure.read_once(args.model)
    # No display, and nothing else from this machine except the path and the folder of caches.
    around = {"PATH": os.environ["PATH"], "HOME": os.environ["HOME"]}
    pythons = {name: install(name, folder, os.path.abspath(args.wheel)) for name in args.only}
    runs = {name: [] for name in pythons}
    failed = {}
    for _ in range(args.rounds):
        for name, python in pythons.items():
            picture = folder / "pictures" / f"{name}.png"
            picture.unlink(missing_ok=True)
            script = HERE / "first_picture" / f"{name}_picture.py"
            try:
                runs[name].append(measure.run([str(python), str(script), args.model, str(picture)], around))
            except measure.Failed as why:
                failed[name] = str(why).strip().splitlines()[-1]
            if not is_picture(picture, sys.executable):
                failed.setdefault(name, "the image is empty")
    print("| package | seconds to the first image | peak, MiB | installed, MiB | lines | without a display |")
    print("|---|---|---|---|---|---|")
    for name, python in pythons.items():
        seconds = statistics.median(run.seconds for run in runs[name]) if runs[name] else float("nan")
        mib = max((run.mib for run in runs[name]), default=float("nan"))
        works = failed.get(name, "yes")
        script = HERE / "first_picture" / f"{name}_picture.py"
        print(f"| {name} | {seconds:.2f} | {mib:.0f} | {size(python):.0f} | {lines(script)} | {works} |")


if __name__ == "__main__":
    main()
