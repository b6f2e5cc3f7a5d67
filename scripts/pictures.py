"""What all of Knurl's pictures share: colours, type, the machine's line, PNGs of few colours, and a main for those of a run."""

import io
import json
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import matplotlib.scale
from matplotlib.ticker import MaxNLocator
from PIL import Image

INK, FAINT, KNURL = "#202124", "#5f6368", "#00796b"
# One colour for one way to send a surface, in all pictures. Those of Okabe and Ito (2008), which the colour-blind tell apart.
METHOD = {"force": "#d55e00", "planes": "#e69f00", "paper": "#cc79a7", "faded": "#56b4e9", "default": KNURL, "caps": "#0072b2",
          "mesh": "#202124", "heights": "#8d6e63"}
# What has no way of its own, in this order.
OTHERS = ["#e69f00", "#cc79a7", "#d55e00", "#0072b2", "#9aa0a6", "#8d6e63", "#56b4e9", "#5f7d1c", "#455a64", "#7a4fa3"]
plt.rcParams.update({"font.family": "DejaVu Sans", "axes.edgecolor": "#c4c7c5", "text.color": INK})


class RoundSteps(MaxNLocator):
    """Ticks in steps of 1, 2 or 5 times a power of ten; Matplotlib's own also takes 2.5."""

    def __init__(self):
        super().__init__(nbins="auto", steps=[1, 2, 5, 10])


matplotlib.scale.AutoLocator = RoundSteps  # what a linear axis takes


def machine_line(machine):
    """From the `machine` object that every benchmark's JSON has."""
    return (f"{machine['processor']}, {machine['cpus']} CPUs, Linux {machine['kernel']}, load {machine['load']}; "
            f"{machine['build']}; {machine['date']}")


def save(figure, path, colours=128, **how):
    """As a PNG of so many colours: a third of the size."""
    pixels = io.BytesIO()
    figure.savefig(pixels, facecolor="white", **how)
    plt.close(figure)
    picture = Image.open(pixels).convert("RGB")
    picture.quantize(colors=colours, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(path, optimize=True)


def main(usage, command, draw, check=lambda run: None, most=1, colours=160):
    """All of `plot_X.py RUN.json PICTURE.png`: draw(run) makes the figure of what `command FILE` wrote.

    check(run) may raise first, for what drawing would not notice. Up to `most` runs go to draw, the first first.
    """
    name = os.path.splitext(os.path.basename(sys.argv[0]))[0]
    if not 2 <= len(sys.argv) - 1 <= most + 1:
        sys.exit(usage)
    *files, picture = sys.argv[1:]
    runs, path = [], ""
    try:
        for path in files:
            with open(path, encoding="utf-8") as file:
                runs.append(json.load(file))
            check(runs[-1])
        path = " or ".join(files)
        figure = draw(*runs)
    except OSError as error:
        sys.exit(f"{name}: {path}: cannot be read ({error.strerror}); run {command} {path} first")
    except (AttributeError, LookupError, TypeError, ValueError) as error:
        sys.exit(f"{name}: {path} is not what {command} writes ({error!r}); run it again")
    try:
        save(figure, picture, colours)
    except (OSError, ValueError) as error:
        sys.exit(f"{name}: {picture}: cannot be written ({error}); give a PNG in a folder that is there")
