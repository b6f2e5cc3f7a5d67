"""What all of Knurl's pictures share: colours, type, the machine's line, and PNGs of few colours."""

import io

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
