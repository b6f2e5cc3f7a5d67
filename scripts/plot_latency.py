#!/usr/bin/python3
"""Draws how late cycles and reports were, and how old updates were when they were used.

    plot_latency.py RUN.json [EARLIER.json] PICTURE.png

The input is what knurl latency --json FILE writes. An earlier run is drawn dashed. Left: the share of samples that
took longer, both axes logarithmic; a curve ends where ten samples are left. Right: age at use, in cycles; at a random
phase it is even from 0 to 1.
"""

import matplotlib.pyplot as plt

from pictures import FAINT, KNURL, OTHERS, machine_line, main

LEFT = {  # colour
    "servo.lateness": KNURL, "floor.bare_loop_lateness": "#9aa0a6", "report.blocking": OTHERS[3],
    "floor.eventfd_wake": "#b0bec5", "report.spinning": OTHERS[0], "command.less_cycle_wait": OTHERS[1],
    "report.blocking_after_write": OTHERS[2], "floor.wake_and_udp": "#d7ccc8",
}
RIGHT = "update.age_at_use_cycles"
SMALLEST = 2.0**-10
LEAST_ABOVE = 10


def upper_edge(lower):
    """Of the bucket that begins there: 128 of them to an octave."""
    if lower < SMALLEST:
        return SMALLEST
    octave = SMALLEST
    while octave * 2 <= lower:
        octave *= 2
    return lower + octave / 128


def exceeding(histogram):
    """Points (value, share of samples above it)."""
    total = left = sum(count for _, count in histogram)
    points = []
    for lower, count in histogram:
        left -= count
        if left < LEAST_ABOVE:
            break
        points.append((upper_edge(lower), left / total))
    return points


def draw_exceeding(axes, run, dashed):
    for result in run["results"]:
        if result["name"] not in LEFT or result["n"] < 2 * LEAST_ABOVE:
            continue
        points = exceeding(result["histogram"])
        axes.plot([p[0] for p in points], [p[1] for p in points], "--" if dashed else "-", lw=0.8 if dashed else 1.5,
                  color=LEFT[result["name"]], label=None if dashed else f"{result['name']}, n = {result['n']}")


def draw_age(axes, run, dashed):
    result = next((r for r in run["results"] if r["name"] == RIGHT and r["n"] > 0), None)
    if result is None:
        return
    total, seen, points = result["n"], 0, [(0, 0)]
    for lower, count in result["histogram"]:
        seen += count
        points.append((upper_edge(lower), seen / total))
    axes.plot([p[0] for p in points], [p[1] for p in points], "--" if dashed else "-", lw=0.8 if dashed else 1.5,
              color=KNURL, label=None if dashed else f"n = {total}, at most {result['max']:.2f} cycles")


def draw(*runs):
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2), dpi=90, width_ratios=(1.6, 1))
    for index, run in enumerate(runs):
        draw_exceeding(left, run, index > 0)
        draw_age(right, run, index > 0)
    left.set_xscale("log")
    left.set_yscale("log")
    left.set_xlim(left=0.1)
    left.set_xlabel("us", fontsize=7.5, color=FAINT)
    left.set_title("share that took longer", fontsize=10, fontweight="bold", loc="left")
    right.plot([0, 1], [0, 1], color=FAINT, lw=0.7, ls=":", label="even from 0 to 1")
    right.set_xlim(0, 2)
    right.set_ylim(0, 1.02)
    right.set_xlabel("cycles from commit to use", fontsize=7.5, color=FAINT)
    right.set_title("share that was used by then", fontsize=10, fontweight="bold", loc="left")
    for axes in (left, right):
        axes.tick_params(labelsize=7, colors=FAINT)
        axes.grid(color="#eceff1", lw=0.6, zorder=0)
        axes.legend(fontsize=6.5, frameon=False, loc="lower left" if axes is left else "lower right")
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    now = runs[0]
    setting = now["setting"]
    text = (f"{setting['servo']} servo at {setting['rate']:g} Hz, client's priority {setting['priority'] or 'ordinary'}, "
            f"load: {setting['load']}. {machine_line(now['machine'])}.")
    if len(runs) > 1:
        text += f" Dashed: the run of {runs[1]['machine']['date']}, load {runs[1]['setting']['load']}."
    figure.text(0.01, 0.015, text, fontsize=6, color=FAINT)
    figure.tight_layout(rect=(0, 0.04, 1, 1))
    return figure


def check(run):
    if run["format"]["program"] != "knurl latency":
        raise ValueError("another program's")
    run["results"][0]["histogram"]


if __name__ == "__main__":
    main(__doc__, "knurl latency --json", draw, check, most=2)
