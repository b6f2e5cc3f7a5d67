#!/usr/bin/python3
"""Draws what knurl-surface measured.

    plot_surface.py OUT.json OUT.csv RELIEF.asc PICTURE.png

The three inputs are knurl-surface's --json, --csv and --relief.
"""

import csv
import json
import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LightSource, LinearSegmentedColormap

import pictures
from pictures import FAINT, INK, METHOD, machine_line

COLOURS = METHOD | {"knurl": METHOD["default"], "field": METHOD["heights"]}
NAMES = {  # a title, and what is special about it
    "force": ("Force from the application", "held until the next one comes"),
    "planes": ("Planes, as they come", "the surface's tangent plane at the hand"),
    "paper": ("Planes, the paper's recovery", "lowered to the hand, raised over 50 ms"),
    "knurl": ("Planes, Knurl's default", "for where the hand will be, cross-faded"),
    "caps": ("Caps, likewise", "curved as the surface is there"),
    "mesh": ("The whole relief, sent once", "as triangles, which the servo walks on"),
    "field": ("The whole relief as heights", "a height field: 2 bytes a triangle"),
}
TIMES = {1: "once", 2: "twice", 3: "three times", 4: "four times", 5: "five times", 6: "six times",
         7: "seven times"}
TRUE = "#9aa0a6"
GOOD, BAD = "#00796b", "#b3261e"
LAND = LinearSegmentedColormap.from_list(
    "land", ["#6d8f86", "#9db38f", "#d3cfa4", "#cdb083", "#b08d6a", "#e9e4da", "#ffffff"])


def fail(text):
    sys.exit(f"plot_surface: {text}")


def read_cycles(path):
    """Arrays by column, per way, in the file's order."""
    with open(path, newline="") as file:
        rows = csv.reader(file)
        names = next(rows)
        ways = {}
        for row in rows:
            ways.setdefault(row[0], []).append(row[1:])
    return {way: dict(zip(names[1:], np.asarray(values, dtype=float).T)) for way, values in ways.items()}


def read_relief(path):
    """Heights (mm, row 0 in the north) and the extent (mm) of an ESRI ASCII grid."""
    with open(path) as file:
        head = dict(next(file).split() for _ in range(6))
        heights = np.loadtxt(file)
    cell = float(head["cellsize"])
    west, south = float(head["xllcenter"]), float(head["yllcenter"])
    rows, columns = heights.shape
    return heights, cell, (west - cell / 2, west + (columns - 0.5) * cell, south - cell / 2, south + (rows - 0.5) * cell)


def size(c, what):
    return np.sqrt(c[what + "x"] ** 2 + c[what + "y"] ** 2 + c[what + "z"] ** 2)


class Page:
    """A figure measured in inches from its upper left corner."""

    def __init__(self, width, height):
        self.width, self.height = width, height
        self.figure = plt.figure(figsize=(width, height), dpi=110, facecolor="white")

    def axes(self, left, top, width, height):
        return self.figure.add_axes([left / self.width, 1 - (top + height) / self.height, width / self.width,
                                     height / self.height])

    def text(self, x, top, words, **style):
        return self.figure.text(x / self.width, 1 - top / self.height, words, va="top", **style)

    def rule(self, left, right, top):
        self.figure.add_artist(plt.Line2D([left / self.width, right / self.width], [1 - top / self.height] * 2,
                                          color="#dadce0", lw=0.8))

    def save(self, path):
        pictures.save(self.figure, path, 256)


def draw_relief(axes, relief, cycles, reach):
    heights, cell, extent = relief
    shade = LightSource(azdeg=315, altdeg=40).shade(heights, cmap=LAND, blend_mode="soft", dx=cell, dy=cell)
    axes.imshow(shade, extent=extent, interpolation="bilinear")
    axes.set_xlim(max(extent[0], -reach), min(extent[1], reach))
    axes.set_ylim(max(extent[2], -reach), min(extent[3], reach))
    best = cycles["knurl"] if "knurl" in cycles else list(cycles.values())[-1]
    x, y = best["x"] * 1e3, best["y"] * 1e3
    axes.plot(x, y, color="white", lw=3.0, alpha=0.8, solid_capstyle="round")
    axes.plot(x, y, color=INK, lw=1.2, solid_capstyle="round")
    axes.plot(x[0], y[0], "o", ms=6, mfc="white", mec=INK)
    axes.plot(x[-1], y[-1], "s", ms=5.5, mfc=INK, mec="white")
    axes.tick_params(labelsize=7, colors=FAINT, length=2)
    axes.set_xlabel("mm under the hand", fontsize=7.5, color=FAINT, labelpad=1)
    for spine in axes.spines.values():
        spine.set_visible(False)


def row_height(strokes):
    return max(0.42, min(0.59, 2.36 / len(strokes)))


def draw_table(page, left, right, top, strokes):
    heads = [(2.90, "largest\nforce jump", "\u2264 1 N"), (3.55, "off the true\nsurface", "RMS"),
             (4.15, "off what\nwas sent", "RMS"), (4.85, "speed off\nthe surface", "\u2264 0.3 m/s"),
             (5.54, "limit cycle\nat rest", "< 0.1 mm")]
    for x, name, bound in heads:
        page.text(left + x, top, name, fontsize=7.5, color=FAINT, ha="right", linespacing=1.2)
        page.text(left + x, top + 0.29, bound, fontsize=7, color=TRUE, ha="right")
    row = row_height(strokes)
    for i, s in enumerate(strokes):
        y = top + 0.56 + i * row
        page.rule(left, right, y - 0.10)
        title, detail = NAMES[s["way"]]
        page.text(left, y, str(i + 1), fontsize=16, color=COLOURS[s["way"]], fontweight="bold")
        page.text(left + 0.25, y - 0.02, title, fontsize=9, fontweight="bold")
        page.text(left + 0.25, y + 0.16, detail, fontsize=7.5, color=FAINT)
        faulted = s["fault_at_s"] is not None
        sent = s["own_force_error"]
        cells = [(f"{s['jump']:.2f} N", s["jump"] > 1), (f"{s['force_error']:.2f} N", None),
                 ("" if sent is None else f"{sent:.2f} N", None),
                 (f"{s['kick']:.2f} m/s", s["kick"] > 0.3),
                 ("", None) if s["limit_cycle"] is None else
                 (f"{s['limit_cycle'] * 1e3:.2f} mm", s["limit_cycle"] >= 1e-4)]
        for (x, _, _), (value, broken) in zip(heads, cells):
            page.text(left + x, y + 0.07, value, fontsize=9, ha="right",
                      color=INK if broken is None else BAD if broken else GOOD)
        verdict = f"faulted at {s['fault_at_s']:.2f} s" if faulted else "no verdict" if s["stable"] is None else "stable" if s["stable"] else "not stable"
        page.text(right, y + 0.07, verdict, fontsize=9, ha="right", fontweight="bold", color=GOOD if s["stable"] else BAD)


def plain(axes, labelled):
    axes.tick_params(labelsize=7, colors=FAINT, length=2)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    if not labelled:
        axes.set_xticklabels([])


def draw_way(page, top, number, s, c, end, window, force_top, heights, last):
    colour = COLOURS[s["way"]]
    whole, close, height = (page.axes(0.5, top, 4.35, 1.05), page.axes(5.1, top, 1.75, 1.05),
                            page.axes(7.2, top, 3.5, 1.05))
    title, _ = NAMES[s["way"]]
    page.text(0.5, top - 0.22, f"{number}   {title}", fontsize=9, fontweight="bold", color=colour)
    if s["fault_at_s"] is not None:
        window = (max(0, s["fault_at_s"] - (window[1] - window[0])), s["fault_at_s"])
    for axes in (whole, close):
        axes.plot(c["t"], size(c, "true_f"), color=TRUE, lw=1.5)
        axes.plot(c["t"], size(c, "f"), color=colour, lw=0.8 if axes is whole else 1.1)
        if axes is close:
            axes.plot(c["t"], size(c, "sent_f"), color=INK, lw=0.9, ls=(0, (1.2, 1.6)))
        axes.set_ylim(0, force_top)
    whole.axvspan(*window, color="#e8eaed", lw=0, zorder=0)
    close.set_facecolor("#f1f3f4")
    height.fill_between(c["t"], c["surface_z"] * 1e3, -100, color="#e4ddd0", lw=0)
    height.plot(c["t"], c["surface_z"] * 1e3, color="#a89f8d", lw=0.8)
    height.plot(c["t"], c["z"] * 1e3, color=colour, lw=0.9)
    height.set_ylim(*heights)
    height.locator_params(axis="y", nbins=4, integer=True)
    whole.set_xlim(0, end)
    height.set_xlim(0, end)
    close.set_xlim(*window)
    plain(whole, last)
    plain(height, last)
    plain(close, True)
    close.set_yticklabels([])
    close.locator_params(axis="x", nbins=3)
    if s["fault_at_s"] is not None:
        for axes in (whole, height):
            axes.axvspan(s["fault_at_s"], end, facecolor="white", edgecolor="#e8eaed", hatch="////", lw=0, zorder=3)
        whole.text((s["fault_at_s"] + end) / 2, force_top / 2, s["verdict"].replace(" (", "\n(") + "\nthe servo let go",
                   fontsize=8, color=BAD, ha="center", va="center", zorder=4, linespacing=1.4,
                   bbox={"facecolor": "white", "edgecolor": "none", "pad": 4})


def draw(outcome, cycles, relief, path):
    strokes = [s for s in outcome["strokes"] if s["way"] in cycles]
    run, machine = outcome["run"], outcome["machine"]
    plt.rcParams.update({"axes.linewidth": 0.8, "hatch.linewidth": 0.6})
    # The table is longer than the relief is high when there are many.
    more = max(0, len(strokes) * row_height(strokes) - 2.36)
    page = Page(11, 5.30 + more + 1.42 * len(strokes))
    page.text(0.35, 0.20, f"Hills felt through an application that manages {run['application_rate']:g} Hz", fontsize=16,
              fontweight="bold")
    page.text(0.35, 0.57, f"One hand strokes one relief {TIMES.get(len(strokes), f'{len(strokes)} times')} at {strokes[0]['stiffness']:.0f} N/m: servo "
              f"{run['servo_rate']:g} Hz; the application answers {run['think_s'] * 1e3:g} ms after it has read the hand.",
              fontsize=9, color=FAINT)
    draw_relief(page.axes(0.55, 0.98, 3.5, 2.85), relief, cycles, 100)
    draw_table(page, 4.25, 10.7, 0.98, strokes)
    page.text(4.25, 3.93 + more, "Stable: no jump, no kick and no limit cycle above these bounds. Forces are those before the "
              "servo's safety gate.", fontsize=7.5, color=FAINT)

    top = 4.30 + more
    page.text(0.5, top, "force on the hand, N   (grey: what the true surface would push)", fontsize=8, color=FAINT)
    page.text(5.1, top, "0.6 s; dots: what was sent", fontsize=8, color=FAINT)
    page.text(7.2, top, "height of the hand over the relief, mm", fontsize=8, color=FAINT)
    end = max(c["t"][-1] for c in cycles.values())
    rough = next((s for s in strokes if s["way"] == "planes" and s["fault_at_s"] is None), strokes[-1])
    window = (max(0, rough["jump_at_s"] - 0.3), max(0, rough["jump_at_s"] - 0.3) + 0.6)
    unfaulted = [cycles[s["way"]] for s in strokes if s["fault_at_s"] is None] or list(cycles.values())
    force_top = min(9.0, 1.05 * max(size(c, "f").max() for c in cycles.values()))
    ground = np.concatenate([c["surface_z"] for c in unfaulted]) * 1e3
    heights = (ground.min() - 2.5, ground.max() + 2.5)
    for i, s in enumerate(strokes):
        draw_way(page, top + 0.48 + i * 1.42, i + 1, s, cycles[s["way"]], end, window, force_top, heights,
                 i + 1 == len(strokes))
    foot = page.height - 0.40
    for x in (0.5, 7.2):
        page.text(x, foot - 0.24, "s since the hand began", fontsize=7, color=FAINT)
    page.text(0.35, foot + 0.02, f"Relief: {run['model']}, {run['scale']}.", fontsize=7, color=FAINT)
    page.text(0.35, foot + 0.18, f"Device {run['device']}. {machine_line(machine)}.", fontsize=7,
              color=FAINT)
    page.save(path)


def main(arguments):
    if len(arguments) != 4:
        sys.exit(__doc__)
    try:
        with open(arguments[0]) as file:
            outcome = json.load(file)
        cycles = read_cycles(arguments[1])
        relief = read_relief(arguments[2])
    except FileNotFoundError as error:
        fail(f"{error.filename}: not found; run knurl-surface with --json, --csv and --relief first")
    except (ValueError, KeyError, StopIteration, OSError) as error:
        fail(f"one of {', '.join(arguments[:3])} is not what knurl-surface writes ({error}); run it again")
    if not any(s["way"] in cycles for s in outcome.get("strokes", [])):
        fail(f"{arguments[1]}: holds no stroke of {arguments[0]}; run knurl-surface again")
    try:
        draw(outcome, cycles, relief, arguments[3])
    except OSError as error:
        fail(f"{arguments[3]}: cannot be written ({error.strerror}); check the folder and the space left")


if __name__ == "__main__":
    main(sys.argv[1:])
