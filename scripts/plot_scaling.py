#!/usr/bin/python3
"""Draws how the servo's cycle grows, with the laws that were fitted.

    plot_scaling.py RUN.json PICTURE.png

The input is what knurl_bench_scaling --json FILE writes. Points are medians of the blocks, bars what half of the blocks
lie between, lines the laws; dotted what there is without any (n = 0). Both axes logarithmic.
"""

import math

import matplotlib.pyplot as plt
from matplotlib.ticker import LogLocator, NullFormatter

from pictures import FAINT, INK, KNURL, METHOD, OTHERS, machine_line, main

COLOURS = [KNURL, *OTHERS]
BAD = METHOD["force"]
TITLES = {
    "clients, looked at": "Clients that say nothing", "clients, taken from": "Clients, a batch of each in every cycle",
    "readers": "Report readers", "representations": "Representations of a claim", "scene": "Spheres in a scene",
    "devices": "Devices", "updates": "Updates", "servo_rate": "The servo's own rate",
}


def panel_of(name):
    first = name.split(".")[0]
    if first != "clients":
        return first
    return "clients, taken from" if "batch" in name or "sending" in name else "clients, looked at"


def law_at(law, n):
    shape = {"O(1)": lambda: 0, "O(log n)": lambda: math.log2(n), "O(n)": lambda: n,
             "O(n log n)": lambda: n * math.log2(n), "O(n^p)": lambda: n ** law["exponent"]}[law["growth"]]()
    return law["base"] + law["factor"] * shape


def short(law):
    """'O(n): 606 + 137 n' without the intervals, which the JSON has."""
    words = law["text"]
    while "[" in words:
        words = words[:words.index("[")].rstrip() + words[words.index("]") + 1:]
    return words + " ns"


def draw_series(axes, series, colour):
    points = [p for p in series["points"] if p["n"] > 0]
    x, y = [p["n"] for p in points], [p["p50"] for p in points]
    bars = [[p["p50"] - p["p25"] for p in points], [p["p75"] - p["p50"] for p in points]]
    label = ", ".join(series["name"].split(".")[1:]).replace("_", " ")
    label = f"{label}: {short(series['law'])}" if label else short(series["law"])
    if series["verdict"].startswith("worse"):
        label += f"; by design {series['design']}"
    axes.errorbar(x, y, yerr=bars, fmt="o", ms=3.4, color=colour, lw=0.8, zorder=4)
    steps = [x[0] * (x[-1] / x[0]) ** (i / 60) for i in range(61)]
    axes.plot(steps, [law_at(series["law"], n) for n in steps], "-", lw=1.4, color=colour, label=label, zorder=3)
    for point in series["points"]:
        if point["n"] == 0:
            axes.axhline(point["p50"], color=colour, lw=0.7, ls=":", zorder=2)


def draw_panel(axes, name, all_series):
    for i, series in enumerate(all_series):
        draw_series(axes, series, COLOURS[i % len(COLOURS)])
    axes.set_xscale("log")
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.set_ylim(low / 1.2, max(high, 10 * low) * 1.35 ** (1 + len(all_series)))  # room for the legend
    axes.yaxis.set_major_locator(LogLocator(numticks=10))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(labelsize=7, colors=FAINT)
    axes.grid(color="#eceff1", lw=0.6, zorder=0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.set_title(TITLES.get(name, name), fontsize=10, fontweight="bold", loc="left", color=INK)
    axes.set_xlabel(" / ".join(dict.fromkeys(s["axis"] for s in all_series)), fontsize=7.5, color=FAINT)
    axes.set_ylabel("ns a cycle", fontsize=7, color=FAINT)
    legend = axes.legend(fontsize=6.3, frameon=False, loc="upper left", borderaxespad=0.1, labelspacing=0.3, handlelength=1.4)
    for text, series in zip(legend.get_texts(), all_series):
        text.set_color(BAD if series["verdict"].startswith("worse") else INK)


def draw_goals(axes, scaling):
    axes.axis("off")
    axes.set_title("Goals", fontsize=10, fontweight="bold", loc="left", color=INK)
    for i, goal in enumerate(scaling["goals"]):
        of, unit = (1e3, "us") if goal["unit"] == "ns" else (1, goal["unit"])
        value = "too few samples" if goal["value"] is None else f"{goal['value'] / of:.1f} {unit}"
        if goal["interval"]:
            value += f" [{goal['interval'][0] / of:.1f}, {goal['interval'][1] / of:.1f}]"
        axes.text(0, 0.93 - 0.12 * i, goal["name"], fontsize=7.5, color=INK, transform=axes.transAxes)
        axes.text(0, 0.88 - 0.12 * i, f"{value}; at most {goal['limit'] / of:g} {unit}: {goal['verdict']}", fontsize=7.5,
                  color=BAD if goal["verdict"] == "worse" else FAINT, transform=axes.transAxes)


def draw(run):
    scaling = run["scaling"]
    panels = {}
    for series in scaling["series"]:
        if series["name"] != "clients.silent.alone":  # what others are beside
            panels.setdefault(panel_of(series["name"]), []).append(series)
    count = len(panels) + (1 if scaling["goals"] else 0)
    rows = (count + 2) // 3
    figure, grid = plt.subplots(rows, 3, figsize=(14, 3.9 * rows), dpi=90, squeeze=False)
    for axes in grid.flat[count:]:
        axes.axis("off")
    for axes, (name, all_series) in zip(grid.flat, panels.items()):
        draw_panel(axes, name, all_series)
    if scaling["goals"]:
        draw_goals(grid.flat[len(panels)], scaling)
    figure.text(0.01, 0.008, f"{scaling['blocks']} blocks by turns, seed {scaling['seed']}; processor time; cycles timed alone have the clock's "
                f"{scaling['clock_pair']:.0f} ns in them. Red: worse than by design. {machine_line(run['machine'])}.",
                fontsize=6.5, color=FAINT)
    figure.tight_layout(rect=(0, 0.02, 1, 1), w_pad=1.5, h_pad=1.5)
    return figure


if __name__ == "__main__":
    main(__doc__, "knurl_bench_scaling --json", draw)
