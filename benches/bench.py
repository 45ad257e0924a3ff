"""Compares Taotie with other programs: `make bench`.

Measures each part with the program of its folder, and writes the summary and the sections of docs/benchmarks.md. A part
that is not measured must have been, by an earlier run of the same programs. If other programs disturbed
more than a tenth of the measurements of a part, the page is not written and the exit code is not 0.
"""

import argparse
import contextlib
import datetime
import hashlib
import os
import shutil
import subprocess
import sys
import time

import command
import machine
import measured
import page
import quiet
import rows
import summary
from command import ROOT, say

PARTS = ("bake", "render", "reference", "scaling")
# How long a run waits for a processor that others leave idle, in seconds.
PATIENCE = 30.0
PLOT = "scaling.svg"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default=",".join(PARTS), metavar="PARTS", help="these parts [default: %(default)s]")
    parser.add_argument("--quick", action="store_true", help="few measurements, in minutes; does not write the page")
    parser.add_argument("--programs", default=command.PROGRAMS, help="folder of taotie and frames")
    parser.add_argument("--folder", default=os.path.join(ROOT, "target/bench"), help="folder of the reports")
    parser.add_argument("--page", default=os.path.join(ROOT, "docs/benchmarks.md"), help="the page with the sections")
    options = "after `--`, options of the only part, such as `--only render -- --help`; does not write the page"
    parser.add_argument("options", nargs="*", help=options)
    args = parser.parse_args()
    args.only = args.only.split(",")
    unknown = sorted({*args.only} - {*PARTS})
    if unknown:
        parser.error(f"--only: unknown part `{unknown[0]}`; expected some of {','.join(PARTS)}")
    if args.options and len(args.only) > 1:
        parser.error("options of a part need --only PART")
    for program in (os.path.join(args.programs, "taotie"), measured.frames(args.programs)):
        if not os.access(program, os.X_OK):
            parser.error(f"{program} is not a program; `make bench` builds it")
    args.is_whole = not (args.quick or args.options)
    args.folder = os.path.join(args.folder, "whole" if args.is_whole else "some")
    return args


def report_path(args, part):
    return os.path.join(args.folder, f"{part}.json")


def measure(args, part):
    """Runs the program of a part; its report. Ends if there is none, as with the part's `--help`."""
    venv = os.path.join("target", f"bench-{part}", "venv")
    subprocess.run(["make", "--no-print-directory", f"{venv}/ready"], cwd=ROOT, check=True, stdout=sys.stderr)
    run = [os.path.join(ROOT, venv, "bin/python"), os.path.join(ROOT, "benches", part, "bench.py")]
    run += ["--programs", args.programs, "--report", report_path(args, part), *args.options]
    run += ["--quick"] if args.quick else []
    say(f"{part}: measuring")
    start = time.monotonic()
    with contextlib.suppress(FileNotFoundError):
        os.remove(report_path(args, part))
    subprocess.run(run, check=True, env=os.environ | {"PYTHONPATH": os.path.join(ROOT, "benches/common")})
    if not os.path.exists(report_path(args, part)):
        sys.exit()
    say(f"{part}: measured in {(time.monotonic() - start) / 60:.1f} minutes")
    return rows.load(report_path(args, part))


def renewed(args, part):
    """The report of a part, measured now."""
    report = measure(args, part)
    with open(programs_path(args, part), "w", encoding="utf-8") as file:
        file.write(digest(args.programs))
    return report


def earlier(args, part):
    """The report of an earlier run of the same programs; None without one."""
    with contextlib.suppress(FileNotFoundError), open(programs_path(args, part), encoding="utf-8") as file:
        if file.read() == digest(args.programs):
            return rows.load(report_path(args, part))
    return None


def programs_path(args, part):
    """The file with the digest of the programs that a report is about."""
    return os.path.join(args.folder, f"{part}.programs")


def digest(programs):
    """The SHA-256 of both programs, one after the other."""
    both = hashlib.sha256()
    for path in (os.path.join(programs, "taotie"), measured.frames(programs)):
        with open(path, "rb") as file:
            both.update(file.read())
    return both.hexdigest()


def dates(args, parts):
    """The days on which the parts were measured, as a phrase."""
    days = sorted({datetime.date.fromtimestamp(os.path.getmtime(report_path(args, part))) for part in parts})
    return " and ".join(f"{day:%-d %B %Y}" for day in days)


def write(args, text, reports):
    """The page, and its plot."""
    page.write(args.page, "bench", text)
    for part, report in reports.items():
        page.write(args.page, mark(part), report.section)
    images = os.path.join(os.path.dirname(args.page), "images")
    os.makedirs(images, exist_ok=True)
    shutil.copy(os.path.join(args.folder, PLOT), os.path.join(images, PLOT))


def mark(part):
    return f"bench, {part}"


def require_quiet():
    share = quiet.settle(PATIENCE)
    if share > quiet.LIMIT:
        sys.exit(f"other programs use {100 * share:.0f} % of the processor: stop them, and start again")


def main():
    args = arguments()
    os.makedirs(args.folder, exist_ok=True)
    if args.is_whole:
        for target in ("bench", *map(mark, PARTS)):
            page.around(args.page, target)  # fails now rather than after half an hour
        require_quiet()
    new = {part: renewed(args, part) for part in PARTS if part in args.only}
    reports = {part: new.get(part) or (earlier(args, part) if args.is_whole else None) for part in PARTS}
    reports = {part: report for part, report in reports.items() if report}
    here = machine.described(os.path.join(args.programs, "taotie"))
    text = summary.text(here, dates(args, reports), [*reports.values()])
    print("\n\n".join([text, *(report.section for report in new.values())]))
    refused = ",".join(part for part, report in reports.items() if summary.is_refused(report))
    if refused:
        sys.exit(f"no conclusions: other programs disturbed too many measurements; repeat with --only {refused}")
    lacking = [part for part in PARTS if part not in reports]
    if args.is_whole and lacking:
        say(f"no page yet: not measured with these programs: {', '.join(lacking)}")
    elif args.is_whole:
        write(args, text, reports)


if __name__ == "__main__":
    try:
        command.run(main)
    except subprocess.CalledProcessError as failed:
        sys.exit(f"`{' '.join(map(str, failed.cmd))}` ended with {failed.returncode}")
