"""Compares the files written by bakes on different kinds of machines: `make same-bytes`.

Each program is run on the same models with several numbers of threads. All files must equal those of the first
program, except for the times in the report.
"""

import argparse
import hashlib
import json
import os
import shlex
import sys
import tempfile
import time

import command
import measure

# Searches of a shape without textures, of a model with textures, and with levels of detail; textures in each format
# by hand.
JOBS = {
    "shape": ("odedstein-meshes/spot/spot_low_resolution.obj", ""),
    "textures": ("khronos-gltf-sample-assets/TwoSidedPlane/glTF/TwoSidedPlane.gltf", "--error 1"),
    "map": ("odedstein-meshes/koala/koala_low_resolution.obj", "--triangles 2000 --size 256 --images jpeg:90/webp:90/webp --meshopt"),
    "blocks": ("odedstein-meshes/koala/koala_low_resolution.obj", "--triangles 500 --size 64 --images ktx2:2"),
    "levels": ("odedstein-meshes/koala/koala_low_resolution.obj", "--error 2 --lods 128px"),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+", metavar="NAME=COMMAND", help="programs, such as 'arm64=qemu-aarch64 taotie'")
    parser.add_argument("--data", default=os.environ.get("TAOTIE_DATA") or os.path.join(command.ROOT, "../shared/data"))
    parser.add_argument("--threads", nargs="+", type=int, default=[2], help="numbers of threads [default: 2]")
    args = parser.parse_args()
    programs = [program.split("=", 1) for program in args.programs]
    differing = [name for name, (model, options) in JOBS.items() if differs(name, (args, programs), (model, options))]
    if differing:
        sys.exit(f"These differ: {', '.join(differing)}")


def differs(name, machines, job):
    """Runs a job on all machines; returns true if some file differs from that of the first."""
    args, programs = machines
    first, is_differing = None, False
    for machine, program in programs:
        for threads in args.threads:
            start = time.monotonic()
            found = files(shlex.split(program), os.path.join(args.data, job[0]), f"{job[1]} --threads {threads}")
            first = first or found
            wrong = sorted(file for file in first.keys() | found.keys() if found.get(file) != first.get(file))
            is_differing |= bool(wrong)
            verdict = f"DIFFERENT: {', '.join(wrong)}" if wrong else f"equal, GLB {first['out.glb'][:12]}"
            print(f"{name:9} {machine:12} {threads} threads {time.monotonic() - start:6.1f} s  {verdict}", flush=True)
    return is_differing


def files(program, model, options):
    """The hash of each file written by a bake."""
    with tempfile.TemporaryDirectory() as folder:
        measure.run([*program, "bake", model, "-o", os.path.join(folder, "out.glb"), "-q", *shlex.split(options)])
        names = [name for name in os.listdir(folder) if not name.endswith(".html")]
        return {name: hashlib.sha256(content(os.path.join(folder, name))).hexdigest() for name in names}


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
