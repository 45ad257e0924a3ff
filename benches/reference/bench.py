"""Taotie's path tracer beside Mitsuba's, by the time to equal error: `make bench-reference`."""

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
# Squares, as Mitsuba's sampler wants them.
PATHS = (16, 64, 256, 1024)
VARIANTS = ("llvm_ad_rgb", "scalar_rgb")
# A truth is the mean of so many pictures of so many paths, whose seeds no other picture has.
PARTS, PATHS_OF_PART, FIRST_SEED = 4, 4096, 1000


@dataclasses.dataclass
class Result:
    """A stage, the truths by kind of program, the programs, and their curves by name."""

    stage: Stage
    truths: dict
    programs: list
    curves: dict


def arguments():
    parser = command.parser(__doc__, TARGET)
    parser.add_argument("--taotie", default=os.path.join(command.PROGRAMS, "taotie"), help="the program to time")
    parser.add_argument("--rounds", type=int, default=2, help="pictures of each number of paths")
    parser.add_argument("--side", type=int, default=128, help="of the pictures, pixels")
    parser.add_argument("--threads", type=int, default=2, help="of each program")
    parser.add_argument("--anew", action="store_true", help="the truths too, which are kept from run to run")
    parser.add_argument("--scene", action="append", choices=scenes.SCENES, help="this alone; the page is left alone")
    args = parser.parse_args()
    if args.rounds < 1:
        parser.error("--rounds: at least 1")
    command.check_program(parser, args.taotie)
    return args


def truth(program, stage, anew):
    """The picture to which the program's tend."""
    total = 0.0
    for part in range(PARTS):
        path = stage.file(program.kind, "truth", f"{part}{program.ending}")
        if anew or not os.path.exists(path):
            say(f"{stage.scene.name}: part {part + 1} of {PARTS} of the truth by {program.title}")
            started = stage.file(f"started{program.ending}")
            program.picture(PATHS_OF_PART, FIRST_SEED + part, started)
            os.replace(started, path)
        total = total + read(path) / PARTS
    return total


def measured(stage, args):
    """One scene; all take turns."""
    stage.make()
    programs = [Taotie(args.taotie, stage), *(Mitsuba(variant, stage) for variant in VARIANTS)]
    try:
        # Both variants of Mitsuba tend to the same picture; the first is the faster one.
        truths = {program.kind: truth(program, stage, args.anew) for program in programs[:2]}
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
    """A picture, and how far it is from the truth."""
    path = result.stage.file(program.name, paths, f"{seed}{program.ending}")
    seconds = program.picture(paths, seed, path)
    error = rmse(read(path), result.truths[program.kind])
    result.curves[program.name].add(paths, seconds, error)
    say(f"{result.stage.scene.name:7} {program.name:12} {paths:5} paths {seconds:8.3f} s, RMSE {error:.3%}")


def rmse(picture, true):
    """In parts of the truth's mean."""
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
