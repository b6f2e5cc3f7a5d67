#!/usr/bin/python3
"""Draws run time against error of the delta's forward solution.

    plot_kinematics.py IN.json PICTURE.png

The input is what knurl_bench_kinematics --error writes. Down and to the left is better; the ring is Knurl's.
"""

import matplotlib.pyplot as plt

from pictures import FAINT, KNURL, OTHERS, machine_line, main

COLOURS = {"three spheres": KNURL, "last pose": OTHERS[0], "last pose moved on": OTHERS[1], "centre": OTHERS[4]}


def draw(data):
    speeds = sorted({p["speed"] for p in data["points"]})
    figure, row = plt.subplots(1, len(speeds), figsize=(11, 3.7), dpi=90, sharey=True, squeeze=False)
    for axes, speed in zip(row.flat, speeds):
        for start, colour in COLOURS.items():
            ours = start == "three spheres"  # the others' start by itself is no answer
            line = [p for p in data["points"]
                    if p["start"] == start and p["speed"] == speed and p["steps"] >= (0 if ours else 1)]
            axes.plot([p["ns"] for p in line], [p["worst"] for p in line], "-o", ms=3.2, lw=1.8 if ours else 0.9,
                      color=colour, label="from " + start, zorder=4 if ours else 3)
            for p in line[:5]:
                axes.annotate(str(p["steps"]), (p["ns"], p["worst"]), xytext=(4, 4), textcoords="offset points",
                              fontsize=6, color=colour)
            until = [p for p in data["points"] if p["start"] == start and p["speed"] == speed and p["steps"] < 0]
            for p in until:
                axes.plot(p["ns"], p["worst"], "o", ms=9, mfc="none", mec=colour, mew=1.6 if p["knurl"] else 0.7,
                          zorder=5)
        axes.axhline(1e-9, color=FAINT, lw=0.7, ls=":")
        axes.set_yscale("log")
        axes.set_xlim(left=0)
        axes.set_ylim(1e-17, 1e-1)
        axes.set_title(f"hand at {speed:g} m/s", fontsize=10, fontweight="bold", loc="left")
        axes.set_xlabel("ns a call, with the Jacobian", fontsize=7.5, color=FAINT)
        axes.tick_params(labelsize=7, colors=FAINT)
        axes.grid(color="#eceff1", lw=0.6, zorder=0)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    row.flat[0].set_ylabel("largest error of the position, m", fontsize=7.5, color=FAINT)
    row.flat[0].text(0, 1.3e-9, " the goal", fontsize=6.5, color=FAINT)
    row.flat[-1].legend(fontsize=7, frameon=False, loc="upper right")
    figure.text(0.01, 0.015, "Small figures: Newton steps; 0 from three spheres is the closed form. Rings: until nothing changes; the thick one is Delta::forward. "
                f"Falcon at 1 kHz. {machine_line(data['machine'])}.", fontsize=6, color=FAINT)
    figure.tight_layout(rect=(0, 0.04, 1, 1))
    return figure


if __name__ == "__main__":
    main(__doc__, "knurl_bench_kinematics --error", draw, colours=48)
