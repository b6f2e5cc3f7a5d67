"""What all of Knurl's pictures share: colours, type, the machine's line, PNGs of few colours, and a main for those of a run."""

import io
import json
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from PIL import Image

INK, FAINT, KNURL = "#202124", "#5f6368", "#00796b"
plt.rcParams.update({"font.family": "DejaVu Sans", "axes.edgecolor": "#c4c7c5", "text.color": INK})


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
    picture.quantize(colors=colours, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(path, optimize=True)


def main(usage, command, draw, check=lambda run: None, most=1, colours=64):
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
