"""The part `reference` of `make bench`: path tracing by Taotie and Mitsuba, by the time to equal error."""

import dataclasses
import importlib.metadata
import os

import command
import equal
import numpy as np
import quiet
import scenes
import section
from command import say
from curve import Curve
from programs import Mitsuba, Stage, Taotie, read
from rows import Report

# Squares, as Mitsuba's sampler requires.
PATHS = (16, 64, 256, 1024)
VARIANTS = ("llvm_ad_rgb", "scalar_rgb")
# A reference image is the mean of this many images with this many paths each, whose seeds no other image has.
PARTS, PATHS_OF_PART, FIRST_SEED = 2, 4096, 1000


@dataclasses.dataclass
class Result:
    """A stage, the reference images by kind of program, the programs, their curves by name, and the load of others."""

    stage: Stage
    truths: dict
    programs: list
    curves: dict
    watch: quiet.Watch


def arguments():
    parser = command.part_parser(__doc__, "bench-reference")
    parser.add_argument("--rounds", type=int, default=3, help="images per number of paths")
    parser.add_argument("--side", type=int, default=128, help="side of the images in pixels")
    parser.add_argument("--threads", type=int, default=2, help="threads per program")
    parser.add_argument("--recompute", action="store_true", help="recompute the cached reference images")
    parser.add_argument("--scene", action="append", choices=scenes.SCENES, help="only this scene")
    args = command.part_arguments(parser)
    if args.quick:
        args.scene, args.side = args.scene or ["metal"], min(args.side, 64)
    return args


def truth(program, stage, again):
    """The image to which the program converges."""
    total = 0.0
    for part in range(PARTS):
        path = stage.file(program.kind, "truth", f"{part}{program.ending}")
        if again or not os.path.exists(path):
            say(f"{stage.scene.name}: part {part + 1} of {PARTS} of the reference image by {program.title}")
            started = stage.file(f"started{program.ending}")
            program.picture(PATHS_OF_PART, FIRST_SEED + part, started)
            os.replace(started, path)
        total = total + read(path) / PARTS
    return total


def measured(stage, args):
    """One scene; the programs alternate."""
    stage.make()
    programs = [Taotie(args.taotie, stage), *(Mitsuba(variant, stage) for variant in VARIANTS)]
    try:
        # Both variants of Mitsuba converge to the same image; the first is the faster one.
        truths = {program.kind: truth(program, stage, args.recompute) for program in programs[:2]}
        result = Result(stage, truths, programs, {}, quiet.Watch())
        result.curves, result.watch = quiet.undisturbed(lambda watch: curves(result, args.rounds, watch))
    finally:
        for program in programs:
            program.close()
    return result


def curves(result, rounds, watch):
    """The curves of all programs by name."""
    found = {program.name: Curve() for program in result.programs}
    for number in range(rounds):
        for paths in PATHS:
            for program in result.programs:
                with watch.turn(program.name):
                    point = once(result, program, paths, number)
                found[program.name].add(paths, *point)
    return found


def once(result, program, paths, seed):
    """The seconds of an image, and its error against the reference image."""
    path = result.stage.file(program.name, paths, f"{seed}{program.ending}")
    seconds = program.picture(paths, seed, path)
    error = rmse(read(path), result.truths[program.kind])
    say(f"{result.stage.scene.name:7} {program.name:12} {paths:5} paths {seconds:8.3f} s, RMSE {error:.3%}")
    return seconds, error


def rmse(picture, true):
    """The RMSE relative to the mean of the reference image."""
    return float(np.sqrt(((picture - true) ** 2).mean()) / true.mean())


def main():
    args = arguments()
    stages = [Stage(args.folder, scenes.SCENES[name], args.side, args.threads) for name in args.scene or scenes.SCENES]
    results = [measured(stage, args) for stage in stages]
    versions = {"Mitsuba": importlib.metadata.version("mitsuba")}
    rows = [row for result in results for row in equal.rows(result)]
    busy = sum(result.watch.most() > quiet.LIMIT for result in results)
    Report(rows, versions, section.text(args, results), busy, len(results)).save(args.report)


if __name__ == "__main__":
    command.run(main)
