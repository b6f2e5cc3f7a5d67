#!/usr/bin/python3
"""Draws run time against error of every implementation.

    plot_error.py IN.json PICTURE.png

The input is knurl_bench_error's --json. Down and to the left is better; a ring marks what Knurl uses.
"""

import matplotlib.pyplot as plt
from matplotlib.ticker import LogLocator, NullFormatter

from pictures import FAINT, INK, KNURL, METHOD, OTHERS, machine_line, main

WAYS = {"force held": METHOD["force"], "plane": METHOD["planes"], "plane, predicted": METHOD["default"], "cap": "#8ab6d6",
        "cap, predicted": METHOD["caps"], "true surface in the servo": METHOD["mesh"]}
TITLES = {
    "planes": "Planes: several at once",
    "curved": "Curved surfaces: where several meet",
    "surfaces": "Surfaces: sent at 1 to 1000 Hz",
    "friction": "Friction: a held tip",
    "springs": "Springs: several on one probe",
}
HOW = """Down and to the left is better.

Rings: what Knurl does unless told otherwise.
Crosses: ruled out by something else (a force that is held is stable
up to a few N/m alone; the paper's snags give energy; ...).
Open points, dotted: in float.
Lines go through all sizes of one implementation; the last has its size beside it."""
SIZES = {"planes": "planes", "curved": "rounds", "surfaces": "Hz", "springs": "springs"}


def panels_of(data):
    """One panel a picture; surfaces by surface ('gentle, 20 Hz' belongs to 'gentle')."""
    for panel in data["panels"]:
        families = []
        for point in panel["points"]:
            family = point["scene"].split(",")[0] if "," in point["scene"] else ""
            if family not in families:
                families.append(family)
        for family in families:
            points = [p for p in panel["points"] if not family or p["scene"].startswith(family + ",")]
            yield panel, family, points


def in_float(name):
    return name.endswith(", float")


def draw_panel(axes, panel, family, points):
    names = list(dict.fromkeys(p["implementation"] for p in points))
    colour_of = {}
    for name in names:
        base = name.removesuffix(", float")
        if base in colour_of:
            continue
        own = any(p["knurl"] for p in points if p["implementation"] == base)
        taken = {*colour_of.values(), *(WAYS.values() if panel["name"] == "surfaces" else ())}
        free = [c for c in OTHERS if c not in taken] or OTHERS
        colour_of[base] = WAYS[base] if panel["name"] == "surfaces" and base in WAYS else KNURL if own else free[0]
    exact = panel["exact"]
    floor = exact / 10 if exact > 0 else min(p["error"] for p in points) / 3
    top = max(p["error"] for p in points) * 4
    for name in names:
        line = [p for p in points if p["implementation"] == name]
        colour, small = colour_of[name.removesuffix(", float")], in_float(name)
        ours = any(p["knurl"] for p in line)
        x, y = [p["ns"] for p in line], [max(p["error"], floor) for p in line]
        axes.plot(x, y, ":" if small else "-", marker="o", ms=3.2, lw=1.8 if ours else 0.9, color=colour, mew=0.8,
                  mfc="white" if small else colour, zorder=4 if ours else 3,
                  label=name + (" \u2190 Knurl" if ours else ""))
        for p in line:
            if p["knurl"]:
                axes.plot(p["ns"], max(p["error"], floor), "o", ms=9, mfc="none", mec=KNURL, mew=1.6, zorder=5)
            if p["flaw"]:
                axes.plot(p["ns"], max(p["error"], floor), "x", ms=6, color=INK, mew=0.8, zorder=5)
            if len(line) > 1 and not small and (ours or p is line[-1]):
                axes.annotate(f"{p['size']:g}", (p["ns"], max(p["error"], floor)), xytext=(4, 6 if ours else -9),
                              textcoords="offset points", fontsize=6, color=colour)
    if exact > 0:
        axes.axhspan(floor / 10, exact, color="#e6f4f1", lw=0, zorder=0)
        axes.text(0.99, exact, "no error worth a name ", transform=axes.get_yaxis_transform(), fontsize=6.5,
                  color=KNURL, ha="right", va="top")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(floor / 3, top)
    axes.xaxis.set_major_locator(LogLocator(numticks=10))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(labelsize=7, colors=FAINT)
    axes.grid(color="#eceff1", lw=0.6, zorder=0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    title = TITLES.get(panel["name"], panel["name"]) + (f", {family}" if family else "")
    axes.set_title(title, fontsize=10, fontweight="bold", loc="left", color=INK)
    axes.set_xlabel("ns a call" + (f"; small figures: {SIZES[panel['name']]}" if panel["name"] in SIZES else ""),
                    fontsize=7.5, color=FAINT)
    axes.set_ylabel(f"{panel['error_meaning']}, {panel['error_unit']}", fontsize=7, color=FAINT)
    axes.legend(fontsize=6, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2,
                labelspacing=0.35, handlelength=1.8)


def draw(data):
    panels = list(panels_of(data))
    rows = (len(panels) + 1) // 2
    figure, grid = plt.subplots(rows, 2, figsize=(13, 3.5 * rows), dpi=90, squeeze=False)
    for axes in grid.flat[len(panels):]:
        axes.axis("off")
        axes.text(0, 0.95, HOW, fontsize=9, color=FAINT, va="top", linespacing=1.7)
    for axes, panel in zip(grid.flat, panels):
        draw_panel(axes, *panel)
    samples = sorted({p["n"] for panel in data["panels"] for p in panel["points"]})
    figure.text(0.01, 0.006, f"{machine_line(data['machine'])}; medians of {samples[0]} interleaved blocks.", fontsize=6.5, color=FAINT)
    figure.tight_layout(rect=(0, 0.02, 1, 1), w_pad=2, h_pad=2)
    return figure


if __name__ == "__main__":
    main(__doc__, "knurl_bench_error --json", draw)
