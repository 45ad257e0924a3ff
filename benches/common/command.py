"""What the commands of all benchmarks have in common."""

import argparse
import os
import sys

import measure
import npm
import page
import talk

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# Where cargo puts what is timed.
PROGRAMS = os.path.join(ROOT, "target/release")


def parser(about, target):
    """With the options that all have; `target` is the Makefile's."""
    made = argparse.ArgumentParser(description=about)
    made.add_argument("--folder", default=os.path.join(ROOT, "target", target), help="for what is made")
    made.add_argument("--page", default=os.path.join(ROOT, "docs/benchmarks.md"), help="whose section is written")
    return made


def models_parser(about, target):
    """`parser` with the options of benchmarks that make assets of models by others."""
    made = parser(about, target)
    data = os.environ.get("TAOTIE_DATA") or os.path.join(ROOT, "../shared/data")
    node = os.path.join(ROOT, "target/bench-sizes/node")
    made.add_argument("--taotie", default=os.path.join(PROGRAMS, "taotie"), help="the program that bakes and measures")
    made.add_argument("--data", default=data, help="the folder of models by others")
    made.add_argument("--node", type=npm.Folder, default=npm.Folder(node), help="where npm installed the others")
    return made


def check_program(made, path):
    """Ends with an error of the parser unless the path is an executable program."""
    if not os.access(path, os.X_OK):
        made.error(f"{path} is not a program: run `cargo build --release -p taotie-cli`, or name another")


def say(text):
    """To people, beside the output."""
    print(text, file=sys.stderr, flush=True)


def run(main):
    """Calls `main`; what cannot be done ends the program with a line instead of a trace."""
    try:
        main()
    except (measure.Failed, page.Unmarked, talk.Silent, OSError) as error:
        sys.exit(str(error))
