"""Compares Taotie's path tracer with Mitsuba's, by the time to equal error: `make bench-reference`."""

import dataclasses
import os

import command
import machine
import numpy as np
import page
import scenes
import section
from command import say
from curve import Curve
from programs import Mitsuba, Stage, Taotie, read

TARGET = "bench-reference"
# Squares, as Mitsuba's sampler requires.
PATHS = (16, 64, 256, 1024)
VARIANTS = ("llvm_ad_rgb", "scalar_rgb")
# A reference image is the mean of this many images with this many paths each, whose seeds no other image has.
PARTS, PATHS_OF_PART, FIRST_SEED = 4, 4096, 1000


@dataclasses.dataclass
class Result:
    """A stage, the reference images by kind of program, the programs, and their curves by name."""

    stage: Stage
    truths: dict
    programs: list
    curves: dict


def arguments():
    parser = command.parser(__doc__, TARGET)
    parser.add_argument("--taotie", default=os.path.join(command.PROGRAMS, "taotie"), help="the program to time")
    parser.add_argument("--rounds", type=int, default=2, help="images per number of paths")
    parser.add_argument("--side", type=int, default=128, help="side of the images in pixels")
    parser.add_argument("--threads", type=int, default=2, help="threads per program")
    parser.add_argument("--recompute", action="store_true", help="recompute the cached reference images")
    parser.add_argument("--scene", action="append", choices=scenes.SCENES, help="only this scene; without the page")
    args = parser.parse_args()
    if args.rounds < 1:
        parser.error("--rounds: at least 1")
    command.check_program(parser, args.taotie)
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
        result = Result(stage, truths, programs, {program.name: Curve() for program in programs})
        for number in range(args.rounds):
            for paths in PATHS:
                for program in programs:
                    once(result, program, paths, number)
    finally:
        for program in programs:
            program.close()
    return result


def once(result, program, paths, seed):
    """An image, and its error against the reference image."""
    path = result.stage.file(program.name, paths, f"{seed}{program.ending}")
    seconds = program.picture(paths, seed, path)
    error = rmse(read(path), result.truths[program.kind])
    result.curves[program.name].add(paths, seconds, error)
    say(f"{result.stage.scene.name:7} {program.name:12} {paths:5} paths {seconds:8.3f} s, RMSE {error:.3%}")


def rmse(picture, true):
    """The RMSE relative to the mean of the reference image."""
    return float(np.sqrt(((picture - true) ** 2).mean()) / true.mean())


def main():
    args = arguments()
    if not args.scene:
        page.around(args.page, TARGET)  # fails now rather than after minutes
    stages = [Stage(args.folder, scenes.SCENES[name], args.side, args.threads) for name in args.scene or scenes.SCENES]
    results = [measured(stage, args) for stage in stages]
    text = section.text(machine.described(args.taotie), args, results)
    print(text)
    if not args.scene:
        page.write(args.page, TARGET, text)


if __name__ == "__main__":
    command.run(main)
