"""Compares the files written by programs for different kinds of machines: `make same-bytes`.

Each program is run on the same models with several numbers of threads. All files must equal those of the first
program, except for the times in the report; a model that one program refuses, all must refuse with the same words.
"""

import argparse
import hashlib
import json
import os
import shlex
import subprocess
import sys
import tempfile
import time

import command
import inspected
import measure

# Searches of a shape without textures, of a model with textures, and with levels of detail; textures in each format
# by hand.
JOBS = {
    "shape": ("odedstein-meshes/spot/spot_low_resolution.obj", "bake -o out.glb"),
    "textures": ("khronos-gltf-sample-assets/TwoSidedPlane/glTF/TwoSidedPlane.gltf", "bake -o out.glb --error 1"),
    "map": ("odedstein-meshes/koala/koala_low_resolution.obj",
            "bake -o out.glb --triangles 2000 --size 256 --images jpeg:90/webp:90/webp --meshopt"),
    "blocks": ("odedstein-meshes/koala/koala_low_resolution.obj", "bake -o out.glb --triangles 500 --size 64 --images ktx2:2"),
    "levels": ("odedstein-meshes/koala/koala_low_resolution.obj", "bake -o out.glb --error 2 --lods 128px"),
}
# Of every model.
ASSET = "bake -o out.glb --triangles 1000 --size 256"
PICTURE = "render -o out.png --size 320x240 --env studio --shadows"
SCANS = (".glb", ".gltf", ".obj", ".ply", ".stl")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+", metavar="NAME=COMMAND", help="programs, such as 'arm64=qemu-aarch64 taotie'")
    parser.add_argument("--data", default=os.environ.get("TAOTIE_DATA") or os.path.join(command.ROOT, "../shared/data"))
    parser.add_argument("--threads", nargs="+", type=int, default=[2], help="numbers of threads [default: 2]")
    parser.add_argument("--models", type=int, metavar="TRIANGLES", help="instead of a few models, bake and draw all with at most this number of triangles")
    args = parser.parse_args()
    programs = [program.split("=", 1) for program in args.programs]
    # Commands run in temporary folders.
    programs = [(name, [os.path.abspath(word) if os.path.exists(word) else word for word in shlex.split(words)]) for name, words in programs]
    jobs = JOBS if args.models is None else all_models(programs[0][1], args)
    differing = [name for name, job in jobs.items() if differs(name, (args, programs), job)]
    if differing:
        sys.exit(f"These differ: {', '.join(differing)}")
    print(f"{len(jobs)} jobs, all equal")


def all_models(program, args):
    """A bake and a picture of every model that the program reads and that is small enough."""
    jobs = {}
    for folder, _, names in sorted(os.walk(args.data)):
        for name in sorted(name for name in names if name.lower().endswith(SCANS)):
            model = os.path.relpath(os.path.join(folder, name), args.data)
            try:
                triangles = inspected.report(program, os.path.join(folder, name))["counts"]["triangles_drawn"]
            except measure.Failed:
                triangles = 0
            if triangles <= args.models:
                jobs |= {f"{model} asset": (model, ASSET), f"{model} picture": (model, PICTURE)}
    return jobs


def differs(name, machines, job):
    """Runs a job on all machines; returns true if some file differs from that of the first."""
    args, programs = machines
    first, is_differing = None, False
    for machine, program in programs:
        for threads in args.threads:
            start = time.monotonic()
            found = files(program, os.path.join(args.data, job[0]), f"{job[1]} --threads {threads}")
            first = first or found
            wrong = sorted(file for file in first.keys() | found.keys() if found.get(file) != first.get(file))
            is_differing |= bool(wrong)
            verdict = f"DIFFERENT: {', '.join(wrong)}" if wrong else f"equal, {', '.join(first)}"
            print(f"{name:9} {machine:12} {threads} threads {time.monotonic() - start:6.1f} s  {verdict}", flush=True)
    return is_differing


def files(program, model, options):
    """The hash of each file that a command writes, or the error with which it ends."""
    with tempfile.TemporaryDirectory() as folder:
        subcommand, *options = shlex.split(options)
        line = [*program, subcommand, os.path.abspath(model), "-q", *options]
        done = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 2):
            raise measure.Failed(f"{shlex.join(line)}\nended with {done.returncode}:\n{done.stderr[-2000:]}")
        names = sorted(name for name in os.listdir(folder) if not name.endswith(".html"))
        found = {name: hashlib.sha256(content(os.path.join(folder, name))).hexdigest() for name in names}
        # Programs may know the model's folder by another name.
        return found if done.returncode == 0 else {"refused": done.stderr.partition(os.path.basename(model))[2]}


def content(path):
    """The bytes of a file, without the times of a report."""
    with open(path, "rb") as file:
        read = file.read()
    if not path.endswith(".json"):
        return read
    report = json.loads(read)
    del report["stages"]
    return json.dumps(report, sort_keys=True).encode()


if __name__ == "__main__":
    command.run(main)
