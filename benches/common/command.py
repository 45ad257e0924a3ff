"""What the commands of all benchmarks have in common."""

import argparse
import os
import sys

import measure
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


def say(text):
    """To people, beside the output."""
    print(text, file=sys.stderr, flush=True)


def run(main):
    """Calls `main`; what cannot be done ends the program with a line instead of a trace."""
    try:
        main()
    except (measure.Failed, page.Unmarked, talk.Silent, OSError) as error:
        sys.exit(str(error))
