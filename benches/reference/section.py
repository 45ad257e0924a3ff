"""The section of docs/benchmarks.md."""

import statistics

import equal
import numpy as np
from page import BUSY, seconds, table, two_digits, wrapped

# Starts, which are subtracted, vary by this much.
LEAST_SECONDS = 0.02


def text(args, results):
    """The section's Markdown."""
    lines = ["## The reference", "", wrapped(ABOUT.format(side=args.side, threads=args.threads)), ""]
    for result in results:
        lines += [*by_paths(result), ""]
    lines += [wrapped(ABOUT_EQUAL), "", *at_equal_error(results), "", wrapped(ABOUT_SLOPES), "", *slopes(results), ""]
    return "\n".join([*lines, wrapped(ABOUT_TRUTHS), "", *truths(results)])


def by_paths(result):
    """Seconds and errors of each program."""
    first = result.curves["taotie"]
    rows = []
    for paths in first.taken:
        cells = []
        for program in result.programs:
            time, error = result.curves[program.name].point(paths)
            shown = BUSY if result.watch.is_busy(program.name) else show(time) if time > LEAST_SECONDS else "–"
            cells += [shown, percent(error)]
        rows.append([str(paths), *cells])
    titles = [cell for program in result.programs for cell in (f"{program.title}, s", "RMSE")]
    return table([f"{result.stage.scene.title}: paths", *titles], rows)


def at_equal_error(results):
    """Seconds to the same error, with the spread of the multiple of Taotie's."""
    rows = []
    for result in results:
        for paths in equal.EQUAL_TO:
            own, error = result.curves["taotie"].point(paths)
            its = equal.of_paths(result, paths)
            title = f"{result.stage.scene.name}, {paths} paths of Taotie's"
            shown = BUSY if result.watch.is_busy("taotie") else show(own)
            rows.append([title, percent(error), shown, *map(equal_cell, its)])
    titles = [f"{program.title}, s" for program in results[0].programs]
    return table(["equal error", "RMSE", *titles], rows)


def equal_cell(row):
    return BUSY if row.is_busy() else f"{show(statistics.median(row.other))} ({row.spread_text()})"


def slopes(results):
    rows = []
    for result in results:
        curves = [result.curves[program.name] for program in result.programs]
        rows.append([result.stage.scene.name, *(f"{curve.slope():.2f}".replace("-", "−") for curve in curves)])
    return table(["slope", *(program.title for program in results[0].programs)], rows)


def truths(results):
    """The differences between the reference images, and the time of programs before the first path."""
    rows = []
    for result in results:
        own, other = result.truths["taotie"], result.truths["mitsuba"]
        apart = np.sqrt(((own - other) ** 2).mean()) / other.mean()
        bias = own.mean() / other.mean() - 1
        lit = other > 0
        middle = np.median(np.abs(own[lit] / other[lit] - 1))
        starts = [show(program.start) if program.start > 0.001 else "–" for program in result.programs]
        rows.append([result.stage.scene.name, percent(apart), f"{bias:+.3%}".replace("-", "−"), percent(middle), *starts])
    starts = [f"{program.title}: start, s" for program in results[0].programs]
    return table(["reference images", "RMSE", "means", "half of the pixels within", *starts], rows)


def show(x):
    return seconds(x) if x >= 0.1 else f"{x:.3f}"


def percent(x):
    return f"{two_digits(100 * x)} %"


ABOUT = (
    "Three scenes by Taotie's path tracer (`--integrator reference`) and Mitsuba's (`path`, `multijitter`), from the "
    "same arrays (`benches/reference/scenes.py`), as images of {side}² on {threads} threads. Seconds are those of the "
    "paths only: without loading, building trees and compiling, and a dash where starts vary by as much. RMSE is in "
    "linear light against the program's own image with 8,192 paths per pixel, relative to its mean."
)

ABOUT_EQUAL = (
    "Time to equal error: the time until a program's error equals that of Taotie's image with the stated paths, "
    "interpolated between the logarithms above; in brackets the least and greatest multiple of Taotie's in a round. "
    "Above 1, Taotie is faster."
)

ABOUT_SLOPES = (
    "Slopes of the error over paths, both as logarithms: independent random paths have −0.5; Taotie's follow Sobol's "
    "sequence, and Mitsuba's sampler stratifies its own."
)

ABOUT_TRUTHS = (
    "Differences between Taotie's and Mitsuba's images with 8,192 paths, by pixels and by their means. Both should "
    "compute the same; the known differences are Smith's masking, which is one term for light and view in Taotie and a "
    "product of two in Mitsuba, and the height at which shadow rays begin. Starts are the times not counted above: "
    "Taotie's tree of triangles, Mitsuba's compilation for a number of paths."
)
