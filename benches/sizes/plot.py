"""Draws bytes against degrees, a panel per model. The same points produce the same plot."""

import os

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator  # noqa: E402
from pictures import FAINT, style  # noqa: E402
from point import frontier  # noqa: E402

# Colours that everyone can distinguish (Okabe and Ito).
COLORS = {"gltf-transform": "#009e73", "gltfpack": "#0072b2", "Taotie": "#d55e00"}
COLUMNS = 3
LEGEND_WIDTH = 7.6
# The range of degrees shown, and its labels.
RANGE = (0.2, 8)
TICKS = (0.3, 0.5, 1, 2, 4, 8)
DASHED = {"linewidth": 1, "linestyle": (0, (4, 3))}


def save(found, path):
    """Writes a plot of all models; the extension decides between SVG and PNG."""
    plt.rcParams |= style("sizes")
    columns = min(COLUMNS, len(found))
    rows = -(-len(found) // columns)
    size = (max(3.8 * columns, LEGEND_WIDTH), 3.1 * rows + 0.4)
    figure, grid = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained")
    cells = list(grid.ravel())
    for axes, one in zip(cells, found, strict=False):
        panel(axes, one)
    for axes in cells[len(found) :]:
        axes.axis("off")
    handles = {label: handle for axes in cells for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(handles.values(), handles, loc="outside upper left", ncols=len(handles), frameon=False)
    figure.supxlabel("mean angle between normals at the same pixel, degrees", fontsize=10)
    figure.supylabel("kB without metadata", fontsize=10)
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    figure.savefig(path, dpi=150, metadata={"Date": None} if path.endswith(".svg") else {})
    plt.close(figure)


def panel(axes, one):
    """The points and frontiers of one model."""
    axes.set(xscale="log", yscale="log", title=one.name)
    draw(axes, "gltf-transform", one.gltf_transform)
    draw(axes, "gltfpack", one.gltfpack)
    draw_same_color(axes, one)
    draw(axes, "Taotie", one.taotie)
    axes.grid(color=FAINT, linewidth=0.6)
    axes.set_axisbelow(True)
    scale(axes, [point for some in (one.gltf_transform, one.gltfpack, one.taotie) for point in frontier(some)])


def draw(axes, name, points):
    """Draws all points faintly and the frontier as a line, for Taotie with markers."""
    is_marked = name == "Taotie"
    axes.scatter(*coordinates(points), s=7, color=COLORS[name], alpha=0.3, linewidths=0, rasterized=len(points) > 50)
    mark = {"marker": "o", "markersize": 4.5} if is_marked else {}
    width = 1.8 if is_marked else 1.3
    axes.plot(*coordinates(frontier(points)), color=COLORS[name], linewidth=width, label=name, **mark)


def draw_same_color(axes, one):
    """Draws gltfpack's frontier of assets whose ΔE is at most the highest on Taotie's frontier."""
    worst = max(frontier(one.taotie), key=lambda p: p.color, default=None)
    same = [p for p in one.gltfpack if worst and p.is_no_worse_in_color(worst)]
    label = "gltfpack, ΔE no worse than Taotie's"
    axes.plot(*coordinates(frontier(same)), color=COLORS["gltfpack"], **DASHED, label=label)


def coordinates(points):
    return [p.degrees for p in points], [p.bytes / 1000 for p in points]


def scale(axes, points):
    """The same degrees for all panels, and the bytes of the frontiers there; points outside are not shown."""
    seen = [p.bytes / 1000 for p in points if RANGE[0] <= p.degrees <= RANGE[1]]
    axes.set_xlim(*RANGE)
    axes.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
    axes.xaxis.set_minor_locator(NullLocator())
    low, high = min(seen, default=1) / 1.3, max(seen, default=1) * 1.3
    axes.set_ylim(low, high)
    axes.yaxis.set_major_locator(LogLocator(subs=(1,) if high > 200 * low else (1, 2, 5)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda kb, _: f"{kb:,g}"))
    axes.yaxis.set_minor_locator(NullLocator())
