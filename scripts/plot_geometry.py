#!/usr/bin/python3
"""Draws run time against error of what may be felt of one relief: walk, active set, Embree's point query, height field, and
what an application tells at 20 to 1000 Hz.

    plot_geometry.py RUN.json PICTURE.png

The input is what knurl_bench_geometry --json FILE writes. Left the medians, right what 99 % keep within. Down and to the left
is better.
"""

import math

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from pictures import FAINT, INK, KNURL, METHOD, OTHERS, machine_line, main

# method: (colour, marker, what the legend says)
METHODS = {
    "walk": (KNURL, "o", "walk"),
    "height field": (METHOD["heights"], "s", "height field, the same walk"),
    "active set": (OTHERS[1], "o", "active set (god-object by planes)"),
    "Embree point query": (OTHERS[6], "o", "Embree's nearest point (no proxy: it jumps)"),
    "mesh in a scene": (METHOD["mesh"], "*", "the mesh in the servo's scene, whatever the application's rate"),
    "plane": (METHOD["planes"], "v", "planes from an application"),
    "cap": ("#8ab6d6", "^", "caps from an application"),
}
PREDICTED = {"plane": METHOD["default"], "cap": METHOD["caps"]}
LEAST = 3e-11  # m: what errs less is drawn here


def colour_of(point):
    if point["predicted"]:
        return PREDICTED[point["method"]]
    return METHODS[point["method"]][0]


def size_of(point):
    """Marker size, pt: of the triangles; all that a scene has is of one size."""
    if point["hz"] or point["method"] == "mesh in a scene":
        return 6.5 if point["method"] == "mesh in a scene" else 5
    return 1.6 + 1.9 * math.log10(point["triangles"] / 300)


def draw_panel(axes, points, share, title):
    for warm in (False, True):
        lines = {}
        for point in points:
            ns = point[("warm" if warm else "cold") + share]
            if ns is not None:
                key = (point["method"], point["predicted"])
                lines.setdefault(key, []).append((ns, max(point["error" + share], LEAST), point))
        for (method, _), line in lines.items():
            colour = colour_of(line[0][2])
            axes.plot([x for x, _, _ in line], [y for _, y, _ in line], "-" if warm else ":", lw=0.8, color=colour, zorder=3)
            for x, y, point in line:
                axes.plot(x, y, METHODS[method][1], ms=size_of(point), color=colour, mfc=colour if warm else "white", mew=0.9,
                          zorder=4)
                # Where the rates lie is the same for all: said beside the leftmost.
                if warm and point["hz"] and method == "plane" and not point["predicted"]:
                    below = share == "_p50" and point["hz"] == 1000
                    axes.annotate(f"{point['hz']:g} Hz", (x, y), xytext=(0, -10) if below else (-6, 0),
                                  textcoords="offset points", fontsize=6.5, color=FAINT, ha="center" if below else "right",
                                  va="center")
    axes.axhspan(LEAST / 3, 1e-7, color="#e6f4f1", lw=0, zorder=0)
    axes.text(0.99, 1e-7, "no hand feels that ", transform=axes.get_yaxis_transform(), fontsize=7, color=KNURL, ha="right",
              va="top")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(25, 2e5)
    axes.set_ylim(LEAST / 3, 3e-2)
    axes.yaxis.set_major_locator(LogLocator(numticks=12))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(NullFormatter())
    axes.tick_params(labelsize=7.5, colors=FAINT)
    axes.grid(color="#eceff1", lw=0.6, zorder=0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.set_title(title, fontsize=10, fontweight="bold", loc="left", color=INK)
    axes.set_xlabel("ns a cycle", fontsize=8, color=FAINT)
    axes.set_ylabel("m from where the reference holds the hand", fontsize=8, color=FAINT)


def legend_of(points):
    handles = []
    for method, (colour, marker, text) in METHODS.items():
        if any(p["method"] == method for p in points):
            handles.append(Line2D([], [], color=colour, marker=marker, ms=7 if marker == "*" else 5, lw=0.8, label=text))
            if method in PREDICTED:
                handles.append(Line2D([], [], color=PREDICTED[method], marker=marker, ms=5, lw=0.8,
                                      label=text.replace(" from", ", predicted, from")))
    return handles


def draw(run):
    points = run["geometry"]["points"]
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 5.7), dpi=90)
    draw_panel(left, points, "_p50", "Medians")
    draw_panel(right, points, "_p99", "99 % of cycles, 99 % of errors")
    figure.legend(handles=legend_of(points), loc="lower left", bbox_to_anchor=(0.045, 0.045), ncols=3, fontsize=7.5,
                  frameon=False, columnspacing=1.6, handlelength=1.8)
    whole = sorted({p["triangles"] for p in points if not p["hz"]})
    figure.text(0.05, 0.028, f"Filled: warm; open: 48 MiB written before the cycle. Larger marks: more triangles "
                f"({whole[0]:,} to {whole[-1]:,}). What an application says is felt one period later.", fontsize=7.5, color=INK)
    figure.text(0.05, 0.006, machine_line(run["machine"]), fontsize=6.5, color=FAINT)
    figure.tight_layout(rect=(0, 0.16, 1, 1), w_pad=2)
    return figure


if __name__ == "__main__":
    main(__doc__, "knurl_bench_geometry --json", draw)
