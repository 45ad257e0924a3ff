"""The part `bake` of `make bench`: bakes by Taotie and Blender in alternation, with time and memory."""

import json
import os
import sys

import command
import files
import jobs
import measure
import quiet
import section
from command import say
from rows import Report, Row

# The figures that are compared.
KEYS = ("seconds", "mib")


def arguments():
    parser = command.part_parser(__doc__, "bench-bake")
    parser.add_argument("--rounds", type=int, help="rounds per job [default: 3; 1 for jobs without a peer]")
    parser.add_argument("--job", action="append", choices=[job.name for job in jobs.JOBS], help="only this job")
    return command.part_arguments(parser)


def script(name, *rest):
    return [sys.executable, os.path.join(jobs.HERE, name), *rest]


def chosen(args):
    """The jobs, each with its number of rounds."""
    some = [job for job in jobs.JOBS if (job.name in args.job if args.job else job.scan == "1m" or not args.quick)]
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


def timed(job, rounds, bakers, watch):
    """The results of each baker by round; they alternate, so that a machine that slows down slows both."""
    results = {name: [] for name in bakers}
    for _ in range(rounds):
        for name, bake in bakers.items():
            with watch.turn(name):
                result = bake(job)
            results[name].append(result)
            say(f"{job.name:12} {name:8} {result['seconds']:8.2f} s {result['mib']:7.0f} MiB")
    return results


def compared(job, results, watch):
    """Rows of time and memory."""
    if "blender" not in results:
        return []
    own, other = ({key: [row[key] for row in results[name]] for key in KEYS} for name in ("taotie", "blender"))
    load = watch.share("taotie", "blender")
    case = f"bake, {job.title}"
    return [
        Row(case, "Blender", "s", own["seconds"], other["seconds"], section.TIME_GOAL, load),
        Row(f"{case}: peak memory", "Blender", "MiB", own["mib"], other["mib"], section.MEMORY_GOAL),
    ]


def maps_of(results, paths):
    """The normal maps baked from the scan of 1 M as NAME=PATH; Taotie's are extracted from its assets."""
    named = []
    for job, times, _ in results:
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
    """The output of accuracy.py, run in a separate process; or why there is none."""
    maps = maps_of(results, paths)
    if not maps:
        return {"lacks": "no normals of the 1 M job were baked"}
    try:
        run = measure.run(script("accuracy.py", paths.scan_named("1m"), paths.low("npz"), *maps))
    except measure.Failed as failed:
        return {"lacks": str(failed).strip().splitlines()[-1]}
    return json.loads(run.output)


def main():
    args = arguments()
    paths, some = jobs.Paths(args.folder), chosen(args)
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
        results.append((job, *quiet.undisturbed(lambda watch: timed(job, rounds, bakers, watch))))
    rows = [row for result in results for row in compared(*result)]
    busy = sum(watch.is_busy(*times) for _, times, watch in results)
    versions = {"Blender": f"{one['version']} (`bpy`)" for _, times, _ in results for one in times.get("blender", [])}
    text = section.text(results, accuracy(results, paths), lacks)
    Report(rows, versions, text, busy, len(results)).save(args.report)


if __name__ == "__main__":
    command.run(main)
