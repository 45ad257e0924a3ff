"""Draws the times, a panel an axis: plot.py TIMES.JSON PICTURE. The same times make the same SVG."""

import os
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import results  # noqa: E402

# Colours that are told apart by everyone (Okabe and Ito).
COLORS = {"cook-torrance": "#0072b2", "ggx": "#d55e00"}
INK, FAINT = "#333333", "#dddddd"
PANELS = {
    "triangles": "triangles",
    "pixels": "pixels of the picture",
    "lights": "lights",
    "textures": "texels of each map",
    "threads": "threads",
}
# By axis, how time goes where it is in proportion: the power of the amount. Textures have none.
POWERS = {"triangles": 1, "pixels": 1, "lights": 1, "threads": -1}
STYLE = {
    "svg.fonttype": "none",
    "svg.hashsalt": "scaling",
    "font.family": "sans-serif",
    "font.size": 10,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.minor.size": 0,
    "ytick.minor.size": 0,
}


def panel(axes, name, lines):
    """One axis of what was measured."""
    axes.set(xscale="log", yscale="log", title=PANELS[name])
    labels = {}
    for (shading, line), records in lines.items():
        there = [(r.amount, r.median) for r in records if r.median is not None]
        labels |= {r.amount: r.label for r in records}
        if there:
            first = line == next(line for _, line in lines)
            draw(axes, name, there, COLORS[shading], first)
            if line:
                axes.annotate(
                    line, there[0], (4, 5), textcoords="offset points", fontsize=8, color=COLORS[shading]
                )
    axes.set_xticks(list(labels), list(labels.values()))
    axes.minorticks_off()
    axes.grid(axis="y", color=FAINT, linewidth=0.6)
    axes.set_axisbelow(True)


def draw(axes, name, points, color, first):
    """A line, hollow but for an axis's first, and where it would go in proportion."""
    x, y = zip(*points)
    if name in POWERS and len(x) > 1:
        # From the end that has most to do.
        i = -1 if POWERS[name] > 0 else 0
        straight = [y[i] * (at / x[i]) ** POWERS[name] for at in (x[0], x[-1])]
        axes.plot((x[0], x[-1]), straight, color=color, linewidth=0.8, linestyle=(0, (4, 3)), alpha=0.7)
    axes.plot(x, y, color=color, linewidth=1.6, marker="o", markersize=4, markerfacecolor=color if first else "white")


def draw_all(records):
    names = [name for name in PANELS if results.lines(records, name)]
    plt.rcParams |= STYLE
    columns = min(3, len(names) + 1)
    rows = -(-(len(names) + 1) // columns)
    figure, grid = plt.subplots(
        rows, columns, figsize=(3.6 * columns, 2.9 * rows), sharey=True, squeeze=False, layout="constrained"
    )
    cells = grid.ravel()
    for axes, name in zip(cells, names):
        panel(axes, name, results.lines(records, name))
    bounds(cells[0], [record.median for record in records if record.median is not None])
    for row in grid:
        row[0].set_ylabel("milliseconds a frame")
    for axes in cells[len(names) :]:
        axes.axis("off")
    legend(cells[len(names)])
    return figure


def bounds(axes, medians):
    """Whatever is in proportion leaves the panel rather than stretch it."""
    if medians:
        axes.set_ylim(min(medians) / 1.6, max(medians) * 1.6)
    axes.yaxis.set_major_formatter(lambda ms, _: f"{ms:g}")


def legend(axes):
    """What the lines are, in the cell that is left."""
    handles = [axes.plot([], [], color=color, marker="o", label=name)[0] for name, color in COLORS.items()]
    dashed = {"color": INK, "linewidth": 0.8, "linestyle": (0, (4, 3))}
    handles.append(axes.plot([], [], label="in proportion", **dashed)[0])
    axes.legend(handles=handles, loc="center left", frameon=False)


def main(times, picture):
    figure = draw_all(results.load(times))
    os.makedirs(os.path.dirname(picture) or ".", exist_ok=True)
    metadata = {"Date": None} if picture.endswith(".svg") else {}
    figure.savefig(picture, metadata=metadata)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
