#!/usr/bin/python3
"""Draws what a hand did and felt: place and force over time, of what `knurl replay RUN.mcap --csv RUN.csv` writes.

    plot_recording.py RUN.csv [OTHER.csv ...] PICTURE.png [--axis x|y|z] [--from S] [--to S]

Each recording is a column, named as its file; all have the same scales. Above the place of the tip along the axis (z), below
the force of the scenes along it, before the supervisor, and what the servo sent. Time counts from the moment at which the
device became active.
"""

import argparse
import os
import sys

import matplotlib.pyplot as plt
import numpy

from pictures import FAINT, INK, KNURL, OTHERS, save

ACTIVE = 4  # DeviceState::active (runtime/protocol/include/knurl/protocol/report.hpp)
PLACE, SENT = INK, OTHERS[0]


def read(path):
    with open(path, encoding="utf-8") as file:
        lines = [line for line in file if not line.startswith("#")]
    names = lines[0].strip().split(",")
    rows = numpy.array([[float(word) for word in line.split(",")] for line in lines[1:]])
    if len(rows) < 2 or "scene_fz" not in names:
        raise ValueError("no table of reports")
    table = dict(zip(names, rows.T))
    active = numpy.flatnonzero(table["state"] == ACTIVE)
    table["t"] = (table["read_ns"] - table["read_ns"][active[0] if len(active) else 0]) * 1e-9
    return table


def draw(runs, axis, begin, end):
    figure, panels = plt.subplots(2, len(runs), figsize=(1.5 + 3.4 * len(runs), 3.6), dpi=90, sharex=True, sharey="row",
                                  squeeze=False)
    for (name, run), (place, force) in zip(runs, panels.T):
        shown = (run["t"] >= begin) & (run["t"] <= end)
        t = run["t"][shown]
        place.plot(t, 1e3 * run[axis][shown], color=PLACE, lw=1)
        force.plot(t, run["scene_f" + axis][shown], color=KNURL, lw=1, label="of the scene")
        force.plot(t, run["sent_f" + axis][shown], color=SENT, lw=0.8, ls="--", label="sent to the motors")
        place.set_title(name, fontsize=9, fontweight="bold", loc="left", color=INK)
        force.set_xlabel("time, s", fontsize=8, color=FAINT)
        for panel in (place, force):
            panel.tick_params(labelsize=7.5, colors=FAINT)
            panel.grid(color="#eceff1", lw=0.6, zorder=0)
            for side in ("top", "right"):
                panel.spines[side].set_visible(False)
    panels[0][0].set_ylabel(f"{axis} of the tip, mm", fontsize=8, color=FAINT)
    panels[1][0].set_ylabel(f"force along {axis}, N", fontsize=8, color=FAINT)
    panels[1][0].legend(fontsize=7, frameon=False)
    figure.tight_layout()
    return figure


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("files", nargs="+", metavar="FILE", help="recordings as CSV, and last the picture")
    words.add_argument("--axis", choices=["x", "y", "z"], default="z")
    words.add_argument("--from", dest="begin", type=float, default=-0.5, metavar="S")
    words.add_argument("--to", dest="end", type=float, default=1e9, metavar="S")
    given = words.parse_args()
    *tables, picture = given.files
    if not tables or not picture.endswith(".png"):
        words.error("give one recording (CSV) or more, and a PNG last")
    runs = []
    for path in tables:
        try:
            runs.append((os.path.splitext(os.path.basename(path))[0], read(path)))
        except (OSError, ValueError, IndexError) as error:
            sys.exit(f"plot_recording: {path} is not what `knurl replay --csv` writes ({error})")
    try:
        save(draw(runs, given.axis, given.begin, given.end), picture, colours=32)
    except (OSError, ValueError) as error:
        sys.exit(f"plot_recording: {picture}: cannot be written ({error}); give a PNG in a folder that is there")


if __name__ == "__main__":
    main()
