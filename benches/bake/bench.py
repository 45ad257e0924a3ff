"""Bakes the same jobs with Taotie and Blender in alternation, and reports time and memory: `make bench-bake`."""

import json
import os
import statistics
import sys

import command
import files
import jobs
import machine
import measure
import page
import section
from command import say

TARGET = "bench-bake"


def arguments():
    parser = command.parser(__doc__, TARGET)
    taotie = os.path.join(command.PROGRAMS, "taotie")
    parser.add_argument("--taotie", default=taotie, help="the program to time")
    parser.add_argument("--rounds", type=int, help="rounds per job [default: 3 for scans of 1 M, 1 for larger ones]")
    parser.add_argument("--quick", action="store_true", help="the jobs at 1 M once; prints without writing the page")
    args = parser.parse_args()
    if args.rounds is not None and args.rounds < 1:
        parser.error("--rounds: at least 1")
    command.check_program(parser, args.taotie)
    return args


def script(name, *rest):
    return [sys.executable, os.path.join(jobs.HERE, name), *rest]


def chosen(args):
    """The jobs, each with its number of rounds."""
    some = [job for job in jobs.JOBS if job.scan == "1m" or not args.quick]
    return [(job, args.rounds or (1 if args.quick else job.rounds)) for job in some]


def blender_lacks():
    """Why Blender is unavailable; None if it is available."""
    try:
        measure.run([sys.executable, "-c", "import bpy"])
    except measure.Failed as failed:
        return str(failed).strip().splitlines()[-1]
    return None


def by_taotie(program, job, paths):
    run = measure.run(jobs.taotie(program, job, paths))
    return {"seconds": run.seconds, "mib": run.mib}


def by_blender(job, paths):
    """Its seconds without the import of the module, which a Blender session needs only once."""
    run = measure.run(jobs.blender(job, paths))
    answer = json.loads(run.output.strip().splitlines()[-1])
    seconds = answer["load"] + answer["bake"] + answer["save"]
    return {"seconds": seconds, "mib": run.mib, "import": answer["import"], "version": answer["version"]}


def timed(job, rounds, bakers):
    """Medians of each baker; they alternate, so that a machine that slows down slows both."""
    results = {name: [] for name in bakers}
    for _ in range(rounds):
        for name, bake in bakers.items():
            result = bake(job)
            results[name].append(result)
            say(f"{job.name:12} {name:8} {result['seconds']:8.2f} s {result['mib']:7.0f} MiB")
    return {name: median(rows) for name, rows in results.items()}


def median(rows):
    numbers = [key for key, value in rows[0].items() if isinstance(value, float)]
    return rows[0] | {key: statistics.median(row[key] for row in rows) for key in numbers}


def maps_of(results, paths):
    """The normal maps baked from the scan of 1 M as NAME=PATH; Taotie's are extracted from its assets."""
    named = []
    for job, _, times in results:
        if job.scan != "1m" or job.kind != "normal":
            continue
        samples = f"{job.samples} sample{'s' if job.samples > 1 else ''}"
        if "blender" in times:
            named.append(f"Blender, {samples}={paths.output(job, 'blender', 'png')}")
        path = paths.output(job, "taotie", "png")
        with files.written(path) as file:
            file.write(files.texture_of(paths.output(job, "taotie", "glb"), "normalTexture"))
        named.append(f"Taotie, {samples}={path}")
    return named


def accuracy(results, paths):
    """The output of accuracy.py, run in a separate process; or why it failed."""
    scan = next(paths.scan(job) for job, _, _ in results if job.scan == "1m")
    try:
        run = measure.run(script("accuracy.py", scan, paths.low("npz"), *maps_of(results, paths)))
    except measure.Failed as failed:
        return {"lacks": str(failed).strip().splitlines()[-1]}
    return json.loads(run.output)


def main():
    args = arguments()
    paths, some = jobs.Paths(args.folder), chosen(args)
    if not args.quick:
        page.around(args.page, TARGET)  # fails now rather than after minutes
    measure.run(script("scene.py", args.folder, *dict.fromkeys(job.scan for job, _ in some)))
    lacks = blender_lacks()
    if lacks:
        say(f"Blender is unavailable, measuring only Taotie: {lacks}")
    results = []
    for job, rounds in some:
        measure.read_once(paths.scan(job))
        bakers = {"taotie": lambda job: by_taotie(args.taotie, job, paths)}
        if job.blender and not lacks:
            bakers["blender"] = lambda job: by_blender(job, paths)
        results.append((job, rounds, timed(job, rounds, bakers)))
    text = section.text(machine.described(args.taotie), results, accuracy(results, paths), lacks)
    print(text)
    if not args.quick:
        page.write(args.page, TARGET, text)


if __name__ == "__main__":
    command.run(main)
