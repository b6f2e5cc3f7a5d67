#!/usr/bin/python3
"""Turns an elevation model in a NumPy archive into a 16-bit greyscale PNG that states its own scale.

    dem_to_png.py [MODEL.npz] OUT.png

Without MODEL.npz: the Jacksboro fault model of Debian's python-matplotlib-data (344 x 403 heights, 3 arc seconds
apart, whole metres; public domain, USGS). The archive must hold `elevation` (m, rows from the north) and `dx`, `dy`
(degrees), `ymin`, `ymax` (degrees of latitude).
"""

import math
import sys

import numpy as np
from PIL import Image, PngImagePlugin

DEFAULT = "/usr/share/matplotlib/mpl-data/sample_data/jacksboro_fault_dem.npz"
METRES_PER_DEGREE = 6371000 * math.pi / 180  # of a great circle on the mean sphere
COUNTS_PER_METRE = (64, 32, 16, 8, 4, 2, 1)  # the finest that fits 16 bits: whole metres stay exact


def fail(text):
    sys.exit(f"dem_to_png: {text}")


def main(arguments):
    if len(arguments) not in (1, 2) or arguments[0] in ("-h", "--help"):
        sys.exit(__doc__)
    source, target = ([DEFAULT] + arguments)[-2:]
    try:
        archive = np.load(source)
        elevation = np.asarray(archive["elevation"], dtype=float)
        dx, dy = abs(float(archive["dx"])), abs(float(archive["dy"]))
        latitude = (float(archive["ymin"]) + float(archive["ymax"])) / 2
    except FileNotFoundError:
        fail(f"{source}: not found; apt-get install python-matplotlib-data, or name another model")
    except (KeyError, ValueError, OSError) as error:
        fail(f"{source}: is no elevation archive ({error})")
    if not np.isfinite(elevation).all():
        row, column = np.argwhere(~np.isfinite(elevation))[0]
        fail(f"{source}: row {row + 1}, column {column + 1} has no height; fill the gaps first")

    # A cell is dy by dx cos(latitude); the square cell of equal area stands for it.
    north_south = dy * METRES_PER_DEGREE
    east_west = dx * METRES_PER_DEGREE * math.cos(math.radians(latitude))
    cell = math.sqrt(north_south * east_west)

    low, high = elevation.min(), elevation.max()
    per_metre = next((c for c in COUNTS_PER_METRE if (high - low) * c < 65536), None)
    if per_metre is None:
        fail(f"{source}: {high - low:.0f} m of height do not fit 16 bits at a metre a count")
    counts = np.rint((elevation - low) * per_metre).astype(np.uint16)

    text = PngImagePlugin.PngInfo()
    text.add_text("knurl:metres_per_count", repr(1 / per_metre))
    text.add_text("knurl:metres_at_zero", repr(float(low)))
    text.add_text("knurl:metres_per_cell", f"{cell:.6g}")
    try:
        Image.fromarray(counts).save(target, format="PNG", pnginfo=text)
    except OSError as error:
        fail(f"{target}: cannot be written ({error.strerror}); check the folder and the space left")
    rows, columns = counts.shape
    print(f"{target}: {rows} x {columns} heights, {low:.0f} to {high:.0f} m, 1/{per_metre} m a count; "
          f"a cell is {east_west:.1f} m (east-west) x {north_south:.1f} m, taken as {cell:.1f} m square")


if __name__ == "__main__":
    main(sys.argv[1:])
