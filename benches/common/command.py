"""The options and helpers shared by all benchmarks."""

import argparse
import os
import sys

import measure
import npm
import page
import talk

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# Cargo's folder of the timed programs.
PROGRAMS = os.path.join(ROOT, "target/release")


def parser(about, target):
    """A parser with the common options; `target` is the Makefile's."""
    made = argparse.ArgumentParser(description=about)
    made.add_argument("--folder", default=os.path.join(ROOT, "target", target), help="working folder")
    made.add_argument("--page", default=os.path.join(ROOT, "docs/benchmarks.md"), help="the page with the section")
    return made


def part_parser(about, folder):
    """A parser with the options common to the parts of `make bench`."""
    made = argparse.ArgumentParser(description=about)
    made.add_argument("--folder", default=os.path.join(ROOT, "target", folder), help="working folder")
    made.add_argument("--programs", default=PROGRAMS, help="folder of taotie and frames")
    made.add_argument("--report", required=True, help="file for the report, JSON of rows.py")
    made.add_argument("--quick", action="store_true", help="fewer and smaller measurements")
    return made


def part_arguments(made):
    """The arguments of a part; exits with a parser error if they are invalid."""
    args = made.parse_args()
    if args.rounds is not None and args.rounds < 1:
        made.error("--rounds: at least 1")
    args.taotie = os.path.join(args.programs, "taotie")
    check_program(made, args.taotie)
    return args


def models_parser(about, target):
    """`parser` with the options of benchmarks that make assets from third-party models."""
    made = parser(about, target)
    data = os.environ.get("TAOTIE_DATA") or os.path.join(ROOT, "../shared/data")
    node = os.path.join(ROOT, "target/bench-sizes/node")
    made.add_argument("--taotie", default=os.path.join(PROGRAMS, "taotie"), help="the program that bakes and measures")
    made.add_argument("--data", default=data, help="the folder of third-party models")
    made.add_argument("--node", type=npm.Folder, default=npm.Folder(node), help="the folder of npm programs")
    return made


def check_program(made, path):
    """Exits with a parser error unless the path is an executable program."""
    if not os.access(path, os.X_OK):
        made.error(f"{path} is not a program: run `cargo build --release -p taotie-cli`, or specify another")


def say(text):
    """Prints a message to stderr, apart from the output."""
    print(text, file=sys.stderr, flush=True)


def run(main):
    """Calls `main`; expected failures end the program with one line instead of a traceback."""
    try:
        main()
    except (measure.Failed, page.Unmarked, talk.Silent, OSError) as error:
        sys.exit(str(error))
