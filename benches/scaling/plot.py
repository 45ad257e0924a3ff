"""Draws the times, a panel per axis: plot.py TIMES.JSON PICTURE. The same times produce the same SVG."""

import os
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import results  # noqa: E402
from matplotlib.ticker import LogLocator, NullLocator  # noqa: E402
from pictures import FAINT, INK, style  # noqa: E402

# Colours that everyone can distinguish (Okabe and Ito).
COLORS = {"cook-torrance": "#0072b2", "ggx": "#d55e00"}
PANELS = {
    "triangles": "triangles",
    "pixels": "pixels of the image",
    "lights": "lights",
    "textures": "texels of each map",
    "threads": "threads",
}
# By axis, the power of the amount with which time grows if it is proportional. Textures have none.
POWERS = {"triangles": 1, "pixels": 1, "lights": 1, "threads": -1}
SOLID = {"linewidth": 1.6, "marker": "o", "markersize": 4}
DASHED = {"linewidth": 0.8, "linestyle": (0, (4, 3))}


def panel(axes, name, lines):
    """One axis of the measurements."""
    axes.set(xscale="log", yscale="log", title=PANELS[name])
    labels = {}
    first = next(line for _, line in lines)
    for (shading, line), records in lines.items():
        labels |= {r.amount: r.label for r in records}
        there = [(r.amount, r.median) for r in records if r.median is not None]
        if there:
            draw(axes, name, there, COLORS[shading], line == first)
    axes.set_xticks(list(labels), list(labels.values()))
    axes.minorticks_off()
    axes.grid(axis="y", color=FAINT, linewidth=0.6)
    axes.set_axisbelow(True)


def draw(axes, name, points, color, first):
    """A line, hollow except for an axis's first, and its proportional continuation."""
    x, y = zip(*points)
    if name in POWERS and len(x) > 1:
        # From the end with the most work.
        i = -1 if POWERS[name] > 0 else 0
        straight = [y[i] * (at / x[i]) ** POWERS[name] for at in (x[0], x[-1])]
        axes.plot((x[0], x[-1]), straight, color=color, **DASHED)
    axes.plot(x, y, color=color, **SOLID, markerfacecolor=color if first else "white")


def draw_all(records):
    """A panel per axis; those in a row have the same height per millisecond. The legend takes the cell after them."""
    found = drawn(records)
    plt.rcParams |= style("scaling")
    columns = min(3, len(found) + 1)
    rows = -(-(len(found) + 1) // columns)
    size = (3.6 * columns, 2.9 * rows)
    figure, grid = plt.subplots(rows, columns, figsize=size, sharey="row", squeeze=False, layout="constrained")
    cells = grid.ravel()
    for axes, (name, lines) in zip(cells, found.items()):
        panel(axes, name, lines)
    names = list(found)
    for i, row in enumerate(grid):
        here = names[i * columns : (i + 1) * columns]
        heights(row[0], [r.median for name in here for line in found[name].values() for r in line])
    for axes in cells[len(found) :]:
        axes.axis("off")
    legend(cells[len(found)], list(dict.fromkeys(line for _, line in found.get("threads", {}))))
    return figure


def drawn(records):
    """The lines drawn for each axis: the first of each shading, and all of threads."""
    found = {}
    for name in PANELS:
        lines = results.lines(records, name)
        first = next((line for _, line in lines), "")
        found[name] = {key: line for key, line in lines.items() if key[1] == first or name == "threads"}
    return {name: lines for name, lines in found.items() if lines}


def heights(axes, medians):
    """Proportional lines leave the panel instead of stretching it."""
    axes.set_ylabel("milliseconds per frame")
    medians = [ms for ms in medians if ms is not None]
    if medians:
        low, high = min(medians) / 1.3, max(medians) * 1.3
        axes.set_ylim(low, high)
        axes.yaxis.set_major_locator(LogLocator(subs=(1,) if high > 100 * low else (1, 2, 3, 5)))
    axes.yaxis.set_major_formatter(lambda ms, _: f"{ms:g}")
    axes.yaxis.set_minor_locator(NullLocator())


def legend(axes, lines):
    """The legend, in an empty cell; `lines` are those of the threads."""
    handles = [axes.plot([], [], color=color, **SOLID, label=name)[0] for name, color in COLORS.items()]
    for line in lines[1:]:
        handles.append(axes.plot([], [], color=INK, **SOLID, markerfacecolor="white", label=line)[0])
    handles.append(axes.plot([], [], color=INK, **DASHED, label="proportional")[0])
    axes.legend(handles=handles, loc="center left", frameon=False)


def main(times, picture):
    figure = draw_all(results.load(times))
    os.makedirs(os.path.dirname(picture) or ".", exist_ok=True)
    metadata = {"Date": None} if picture.endswith(".svg") else {}
    figure.savefig(picture, metadata=metadata)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
