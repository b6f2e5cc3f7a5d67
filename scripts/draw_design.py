#!/usr/bin/python3
"""Draws the two pictures of docs/design: which processes there are, and which frames.

    draw_design.py [FOLDER]      docs/design: writes processes.svg and frames.svg there
"""

import math
import sys
from pathlib import Path

INK, FAINT, LINE = "#202124", "#5f6368", "#80868b"
# Okabe and Ito: told apart by the colour-blind.
APPLICATION, SERVO, SAFETY, DEVICE = "#d7ecf9", "#d5efe6", "#fbe3d3", "#f3f3f3"


class Picture:
    def __init__(self, width, height):
        self.size, self.parts = (width, height), []

    def box(self, x, y, width, height, fill, title, *lines):
        self.parts.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="6" fill="{fill}" stroke="{LINE}"/>')
        self.text(x + width / 2, y + 20, title, anchor="middle", weight="bold")
        for i, line in enumerate(lines):
            self.text(x + width / 2, y + 38 + 15 * i, line, anchor="middle", size=11, colour=FAINT)

    def text(self, x, y, words, anchor="start", size=13, colour=INK, weight="normal"):
        self.parts.append(f'<text x="{x}" y="{y}" text-anchor="{anchor}" font-size="{size}" fill="{colour}" '
                          f'font-weight="{weight}">{words}</text>')

    def arrow(self, x1, y1, x2, y2, colour=INK, both=False, dashed=False):
        start = ' marker-start="url(#tip)"' if both else ""
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        self.parts.append(f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" stroke="{colour}" stroke-width="1.5" '
                          f'marker-end="url(#tip)"{start}{dash}/>')

    def axes(self, x, y, length, names, angles):
        """Three axes from a point; angles as (dx, dy) of unit length on the page."""
        for name, (dx, dy) in zip(names, angles):
            self.arrow(x, y, x + length * dx, y + length * dy)
            self.text(x + (length + 11) * dx, y + (length + 11) * dy + 4, name, anchor="middle", size=12)

    def write(self, path, title):
        width, height = self.size
        path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
                        f'font-family="DejaVu Sans, sans-serif" role="img"><title>{title}</title>\n'
                        '<defs><marker id="tip" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" '
                        f'orient="auto-start-reverse"><path d="M0 0L10 5L0 10z" fill="{INK}"/></marker></defs>\n'
                        '<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(self.parts) + "\n</svg>\n")


def processes():
    picture = Picture(760, 330)
    picture.box(20, 20, 150, 62, APPLICATION, "application A", "1 to 1000 Hz")
    picture.box(20, 105, 150, 62, APPLICATION, "application B", "1 to 1000 Hz")
    picture.box(20, 190, 150, 62, APPLICATION, "knurl-bridge", "a client, for its peers")
    picture.box(20, 275, 150, 46, APPLICATION, "other hosts")
    picture.arrow(95, 275, 95, 254, both=True)
    picture.text(104, 269, "TLS, sealed datagrams", size=11, colour=FAINT)
    picture.box(370, 20, 190, 232, SERVO, "knurld", "SCHED_FIFO 80, pinned", "500 Hz to 20 kHz", "", "read the joints", "take commands, batches",
                "evaluate the scenes", "hold the budget", "supervise", "write the efforts", "publish the report")
    for y in (44, 129, 214):
        picture.arrow(172, y, 368, y)
        picture.arrow(368, y + 16, 172, y + 16)
    picture.text(270, 38, "representations", anchor="middle", size=11, colour=FAINT)
    picture.text(270, 75, "reports, feedback", anchor="middle", size=11, colour=FAINT)
    picture.text(270, 100, "rings in shared memory,", anchor="middle", size=11, colour=FAINT)
    picture.text(270, 114, "a segment for each claim", anchor="middle", size=11, colour=FAINT)
    picture.box(630, 20, 110, 62, DEVICE, "device", "driver, motors")
    picture.arrow(562, 51, 628, 51, both=True)
    picture.box(630, 120, 110, 77, SAFETY, "guardian", "own process,", "SCHED_FIFO 85")
    picture.arrow(628, 150, 562, 150, dashed=True)
    picture.text(597, 143, "watches", anchor="middle", size=11, colour=FAINT)
    picture.arrow(685, 118, 685, 84)
    picture.text(692, 105, "zero", size=11, colour=FAINT)
    picture.box(370, 270, 190, 51, DEVICE, "builder", "meshes; SCHED_IDLE")
    picture.arrow(465, 268, 465, 254)
    return picture


def turned(axes, degrees):
    """On the page, so that right-handed axes stay so."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [(c * x - s * y, s * x + c * y) for x, y in axes]


def frames():
    picture = Picture(760, 300)
    flat = [(0.82, 0.42), (0.82, -0.42), (0, -1)]
    picture.text(30, 28, "device frame", weight="bold")
    picture.text(30, 45, "origin: the middle of the workspace; x away from the base, z up", size=11, colour=FAINT)
    picture.parts.append(f'<ellipse cx="160" cy="180" rx="105" ry="92" fill="{DEVICE}" stroke="{LINE}" stroke-dasharray="4 4"/>')
    picture.box(14, 70, 62, 32, "white", "base")  # behind, against x
    picture.axes(160, 180, 70, "xyz", flat)
    picture.text(160, 290, "workspace", anchor="middle", size=11, colour=FAINT)
    picture.text(430, 28, "world of a claim", weight="bold")
    picture.text(430, 45, "ClaimOptions: workspace_centre, workspace_radius", size=11, colour=FAINT)
    picture.axes(450, 240, 60, "xyz", flat)
    picture.arrow(172, 176, 440, 232, colour=FAINT, dashed=True)
    picture.text(345, 192, "shifted and scaled,", anchor="middle", size=11, colour=FAINT)
    picture.text(345, 240, "never turned", anchor="middle", size=11, colour=FAINT)
    picture.axes(548, 172, 34, "xyz", turned(flat, -25))
    picture.text(585, 205, "asset", size=12, weight="bold")
    picture.text(585, 220, "Shape::position,", size=11, colour=FAINT)
    picture.text(585, 234, "orientation", size=11, colour=FAINT)
    picture.arrow(462, 234, 542, 178, colour=FAINT, dashed=True)
    picture.parts.append(f'<circle cx="680" cy="95" r="12" fill="{SERVO}" stroke="{LINE}"/>')
    picture.axes(680, 95, 30, "xyz", turned(flat, 35))
    picture.text(712, 130, "probe", size=12, weight="bold")
    picture.text(752, 146, "on the hand, at its offset", anchor="end", size=11, colour=FAINT)
    return picture


def main():
    if len(sys.argv) > 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1]) if len(sys.argv) == 2 else Path(__file__).resolve().parents[1] / "docs" / "design"
    processes().write(folder / "processes.svg", "Applications, servo, guardian, device")
    frames().write(folder / "frames.svg", "Frames of device, claim, probe and asset")


main()
