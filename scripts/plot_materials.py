#!/usr/bin/python3
"""Draws what each material by name (reps/, presets) does to a hand that strokes it there and back.

    plot_materials.py KNURL PICTURE.png

KNURL is the program `knurl` (build/release/apps/knurl/knurl): its `eval` strokes a plane of each material 40 mm
there and back, pressed in until it pushes with 1 N.
"""

import csv
import os
import subprocess
import sys
import tempfile

import matplotlib.pyplot as plt
import numpy as np

from pictures import FAINT, KNURL, OTHERS, save

NAMES = {  # in the manual's order, and what to look for
    "concrete": "grains 1-3 mm apart hold and knock",
    "sand": "fine grains give way one by one",
    "rubber": "pulled 2 mm before it slips, springs back",
    "skin": "clings softly, no sudden slip",
    "cloth": "light friction, the weave as a ripple",
    "ice": "next to nothing",
    "sandpaper": "grit every 0.4 mm: a buzz",
}
STROKE, SPEED, PRESS = 40.0, 0.05, 1.0  # mm, m/s, N
THERE, BACK = KNURL, OTHERS[0]


def fail(text):
    sys.exit(f"plot_materials: {text}")


def evaluate(knurl, folder, scene, motion):
    """Columns by name of what `knurl eval` says."""
    paths = {name: os.path.join(folder, name) for name in ("scene.toml", "motion.csv", "forces.csv")}
    with open(paths["scene.toml"], "w") as file:
        file.write(scene)
    with open(paths["motion.csv"], "w") as file:
        file.write("t,x,y,z\n" + "".join(",".join(f"{v:.12g}" for v in row) + "\n" for row in motion))
    done = subprocess.run([knurl, "eval", "--scene", paths["scene.toml"], "--motion", paths["motion.csv"], "--out",
                           paths["forces.csv"]], capture_output=True, text=True)
    if done.returncode != 0:
        fail(done.stderr.strip())
    with open(paths["forces.csv"], newline="") as file:
        rows = csv.reader(file)
        names = next(rows)
        return dict(zip(names, np.asarray(list(rows), dtype=float).T))


def stroke(knurl, folder, material):
    """Position (mm) and the force against the way there (N), of the way there and of the way back."""
    smooth = evaluate(knurl, folder, f'[[plane]]\nmaterial = "{material}"\ntexture.amplitude = 0\ndamping = 0\n',
                      [(0, 0, 0, -1e-3), (0.01, 0, 0, -1e-3)])
    depth = PRESS / (smooth["fz"][-1] / 1e-3)
    length, time = STROKE * 1e-3, STROKE * 1e-3 / SPEED
    c = evaluate(knurl, folder, f'[[plane]]\nmaterial = "{material}"\n',
                 [(0, 0, 0, -depth), (time, length, 0, -depth), (2 * time, 0, 0, -depth)])
    there, back = c["t"] <= time, c["t"] >= time
    return [(c["x"][part] * 1e3, -c["fx"][part]) for part in (there, back)]


def draw(strokes, path):
    figure, grid = plt.subplots(4, 2, figsize=(10, 8.6), dpi=100, sharex=True, sharey=True)
    figure.subplots_adjust(left=0.065, right=0.985, top=0.93, bottom=0.055, hspace=0.42, wspace=0.06)
    figure.text(0.02, 0.975, f"Materials by name: {STROKE:g} mm there and back at {SPEED * 100:g} cm/s, pressed with "
                f"{PRESS:g} N", fontsize=13, fontweight="bold")
    panels = list(grid.flat)
    for axes, (name, parts) in zip(panels, strokes.items()):
        axes.axhline(0, color="#dadce0", lw=0.8)
        for (x, force), colour in zip(parts, (THERE, BACK)):
            axes.plot(x, force, color=colour, lw=0.9)
        axes.set_title(name, loc="left", fontsize=10, fontweight="bold", pad=4)
        axes.set_title(NAMES[name], loc="right", fontsize=8, color=FAINT, pad=4)
        axes.tick_params(labelsize=7.5, colors=FAINT, length=2)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    panels[0].set_xlim(0, STROKE)
    panels[0].set_ylim(-1.3, 1.3)
    for axes in (panels[5], panels[6]):
        axes.tick_params(labelbottom=True)
        axes.set_xlabel("mm", fontsize=8, color=FAINT, labelpad=1)
    legend = panels[7]
    legend.set_axis_off()
    for y, colour, words in ((0.85, THERE, "there, to the right"), (0.66, BACK, "and back, to the left")):
        legend.plot([0.02, 0.09], [y, y], color=colour, lw=2, transform=legend.transAxes)
        legend.text(0.11, y, words, va="center", fontsize=9, transform=legend.transAxes)
    legend.text(0.02, 0.48, "Up: the force against the way there, N.\nOn turning back the anchor's spring lets go of what it\n"
                "holds before it is stretched the other way.\nConcrete, ice and sandpaper are as hard as the device\n"
                "allows; here, without one, 1000 N/m.", va="top", fontsize=8.5, color=FAINT, linespacing=1.5,
                transform=legend.transAxes)
    for axes in grid[:, 0]:
        axes.set_ylabel("N", fontsize=8, color=FAINT, labelpad=1)
    save(figure, path, 64)


def main(arguments):
    if len(arguments) != 2:
        sys.exit(__doc__)
    knurl, picture = arguments
    with tempfile.TemporaryDirectory() as folder:
        try:
            strokes = {name: stroke(knurl, folder, name) for name in NAMES}
        except (FileNotFoundError, PermissionError):
            fail(f"{knurl}: cannot be run; build it first (cmake --build --preset release --target knurl)")
    try:
        draw(strokes, picture)
    except OSError as error:
        fail(f"{picture}: cannot be written ({error.strerror}); check the folder and the space left")


if __name__ == "__main__":
    main(sys.argv[1:])
