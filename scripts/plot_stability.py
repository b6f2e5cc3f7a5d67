#!/usr/bin/python3
"""Draws what knurl_stability measured.

    plot_stability.py OUT.json FOLDER        bound.png, methods.png and factors.png in that folder;
                                             network.png, where it is of knurl_stability --network
"""

import json
import os
import sys

import matplotlib.pyplot as plt

from pictures import FAINT, INK, METHOD, machine_line, save

TRUE = "#9aa0a6"
LOOKS = {  # colour, marker
    "force from the application": (METHOD["force"], "x"),
    "planes as they come": (METHOD["planes"], "o"),
    "paper's recovery, 50 ms": (METHOD["paper"], "s"),
    "cross-faded": (METHOD["faded"], "^"),
    "predicted, faded (default)": (METHOD["default"], "D"),
    "cap, predicted, faded": (METHOD["caps"], "*"),
}
FACTORS = [  # table, axis, scale of x, logarithmic
    ("servo_rate", "servo rate, Hz", 1, True), ("recovery", "recovery or fade time, ms", 1e3, True),
    ("encoder", "encoder count, µm", 1e6, False), ("delay", "delay of the device, ms", 1e3, False),
    ("answer", "application answers after, ms", 1e3, True), ("grip", "grip of the hand", 1, False),
    ("update_rate", "application rate, Hz", 1, True), ("mass", "mass of the device, kg", 1, False),
]
NETWORK = [  # table, axis, scale of x
    ("network_wall", "one-way delay, ms (a flat wall, at rest)", 1e3), ("network_delay", "one-way delay, ms", 1e3),
    ("network_swing", "delay that swings between 0 and, ms", 1e3), ("network_loss", "loss, %", 100),
]
FOUND, AT_LEAST, BELOW = 0, 1, 2


def plain(axes):
    axes.tick_params(labelsize=7, colors=FAINT, length=2)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.grid(True, which="major", color="#eceff1", lw=0.6)
    axes.set_axisbelow(True)


def column(table, name):
    i = table["columns"].index(name)
    return [row["values"][i] for row in table["rows"]]


def draw_bound(tables):
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.2, 4.2), gridspec_kw={"width_ratios": [1, 1]})
    bound = tables["bound"]
    x = column(bound, "bound")
    reach = [0.6 * min(x), 1.6 * max(x)]
    left.plot(reach, reach, color=INK, lw=1, label="b / (T/2 + τ)")
    left.fill_between(reach, [0.9 * r for r in reach], [1.1 * r for r in reach], color="#e8eaed", lw=0, label="± 10 %")
    left.plot(x, column(bound, "eigenvalue"), "_", ms=9, color=FAINT, label="eigenvalue of the loop")
    left.plot(x, column(bound, "measured, no dry friction"), "o", ms=4.5, mfc="none", color=METHOD["default"],
              label="measured, no dry friction")
    left.plot(x, column(bound, "measured, 0.05 N"), "^", ms=4, mfc="none", color=METHOD["planes"],
              label="measured, 0.05 N dry friction")
    left.set_xscale("log")
    left.set_yscale("log")
    left.set_xlabel("bound, N/m", fontsize=8, color=FAINT)
    left.set_ylabel("largest stable stiffness of a wall, N/m", fontsize=8, color=FAINT)
    left.legend(fontsize=7, frameon=False, loc="upper left")
    left.set_title("A wall, the hand at rest: every rate, grip, lag, delay, mass", fontsize=9, loc="left")
    plain(left)

    damping = tables["damping"]
    for mass, colour in (("0.15", METHOD["default"]), ("0.05", METHOD["force"])):
        rows = [row for row in damping["rows"] if row["name"].startswith(mass + " kg")]
        pick = lambda name: [row["values"][damping["columns"].index(name)] for row in rows]
        bv = [row["x"] for row in rows]
        right.plot(bv, pick("counted: (b+bv)/(T/2+tau)"), color=colour, lw=0.9, ls="--")
        right.plot(bv, pick("eigenvalue"), color=colour, lw=0.9, ls=":")
        right.plot(bv, pick("measured"), "o-", ms=4, color=colour, lw=1.2, label=f"measured, {mass} kg")
    right.plot([], [], color=FAINT, lw=0.9, ls="--", label="damping counted in full")
    right.plot([], [], color=FAINT, lw=0.9, ls=":", label="eigenvalue of the loop")
    right.axhline(damping["rows"][0]["values"][0], color=INK, lw=0.8)
    right.text(40, damping["rows"][0]["values"][0], "not counted", fontsize=7, ha="right", va="bottom", color=INK)
    right.set_yscale("log")
    right.set_xlabel("virtual damping of the wall, N s/m", fontsize=8, color=FAINT)
    right.legend(fontsize=7, frameon=False, loc="upper left")
    right.set_title("Virtual damping must not simply be counted in", fontsize=9, loc="left")
    plain(right)
    figure.tight_layout(rect=(0, 0.03, 1, 1))
    return figure


def draw_methods(tables):
    figure, panels = plt.subplots(1, 2, figsize=(9.2, 4.2), sharey=True)
    for axes, key, title in ((panels[0], "gentle", "gentle ridge, 0.15 m/s"), (panels[1], "harsh", "harsh ridge, 0.15 m/s")):
        table = tables[key]
        names = [row["name"] for row in table["rows"]]
        both, rise = table["columns"].index("jump and kick"), table["columns"].index("rise")
        base = next(row for row in table["rows"] if row["name"] == "planes as they come")["values"][both]
        for i, row in enumerate(table["rows"]):
            colour = LOOKS.get(row["name"], ("#78909c", ""))[0]
            value, kind = row["values"][both], row["kinds"][both]
            axes.barh(i, value, height=0.62, color=colour, left=0)
            text = f"< {value:.0f}" if kind == BELOW else f"{value:.0f}  ×{value / base:.1f}"
            axes.text(38000, i, text, va="center", ha="right", fontsize=7, color=INK)
            axes.plot(min(row["values"][rise], 6500), i, "|" if row["values"][rise] < 6500 else ">", ms=10, mew=1.6, mfc="none", color=INK)
        axes.set_xscale("log")
        axes.set_xlim(40, 40000)
        axes.set_yticks(range(len(names)), names, fontsize=7.5)
        axes.set_title(title, fontsize=9, loc="left")
        axes.set_xlabel("largest stiffness with jump ≤ 1 N and kick ≤ 0.3 m/s, N/m\n( | or >: rises alone ≤ 1 N, as the paper reads it)",
                        fontsize=7.5, color=FAINT)
        plain(axes)
    panels[0].invert_yaxis()
    figure.tight_layout(rect=(0, 0.03, 1, 1))
    return figure


def draw_factors(tables):
    figure, panels = plt.subplots(3, 3, figsize=(9.2, 8.0))
    panels = panels.flatten()
    for axes, (key, label, scale, logarithmic) in zip(panels, FACTORS):
        table = tables[key]
        for i, name in enumerate(table["columns"]):
            colour, marker = LOOKS[name]
            rows = table["rows"]
            axes.plot([row["x"] * scale for row in rows], [row["values"][i] for row in rows], color=colour, marker=marker,
                      ms=4, lw=1.1)
        axes.set_yscale("log")
        axes.set_ylim(40, 25000)
        if logarithmic:
            axes.set_xscale("log")
            axes.set_xticks([row["x"] * scale for row in table["rows"]],
                            [f"{row['x'] * scale:g}" for row in table["rows"]])
            axes.minorticks_off()
        axes.set_xlabel(label, fontsize=8, color=INK)
        plain(axes)
    axes, error = panels[8], tables["error"]
    for name, look in (("planes", "planes as they come"), ("default", "predicted, faded (default)"), ("cap", "cap, predicted, faded")):
        colour, marker = LOOKS[look]
        rates = [row["x"] for row in error["rows"]]
        axes.plot(rates, column(error, "gentle: " + name), color=colour, marker=marker, ms=4, lw=1.1)
        axes.plot(rates, column(error, "harsh: " + name), color=colour, marker=marker, ms=3, lw=0.9, ls="--")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks(rates, [f"{r:g}" for r in rates])
    axes.minorticks_off()
    axes.set_xlabel("application rate, Hz", fontsize=8)
    axes.set_ylabel("force error, N (dashed: harsh)", fontsize=8, color=FAINT, labelpad=1)
    plain(axes)
    for i in (0, 3, 6):
        panels[i].set_ylabel("stable stiffness, N/m", fontsize=8, color=FAINT)
    handles = [plt.Line2D([], [], color=c, marker=m, ms=5, lw=1.2, label=n) for n, (c, m) in LOOKS.items()]
    figure.legend(handles=handles, ncol=3, fontsize=8, frameon=False, loc="upper center")
    figure.tight_layout(rect=(0, 0.015, 1, 0.94))
    return figure


def draw_network(tables):
    figure, panels = plt.subplots(2, 2, figsize=(8.2, 6.0), sharey=True)
    for axes, (key, label, scale) in zip(panels.flatten(), NETWORK):
        table = tables[key]
        for i, name in enumerate(table["columns"]):
            colour, marker = LOOKS[name]
            axes.plot([row["x"] * scale for row in table["rows"]], [row["values"][i] for row in table["rows"]], color=colour,
                      marker=marker, ms=4, lw=1.1)
        axes.set_yscale("log")
        axes.set_ylim(40, 8000)
        axes.set_xlabel(label, fontsize=8, color=INK)
        plain(axes)
    for axes in panels[:, 0]:
        axes.set_ylabel("stable stiffness, N/m", fontsize=8, color=FAINT)
    shown = {name for key, _, _ in NETWORK for name in tables[key]["columns"]}
    handles = [plt.Line2D([], [], color=c, marker=m, ms=5, lw=1.2, label=n) for n, (c, m) in LOOKS.items() if n in shown]
    figure.legend(handles=handles, ncol=3, fontsize=8, frameon=False, loc="upper center")
    figure.tight_layout(rect=(0, 0.02, 1, 0.91))
    return figure


def main(arguments):
    if len(arguments) != 2:
        sys.exit(__doc__)
    try:
        with open(arguments[0]) as file:
            run = json.load(file)
        tables = {table["key"]: table for table in run["tables"]}
        os.makedirs(arguments[1], exist_ok=True)
        drawings = (("bound", draw_bound), ("methods", draw_methods), ("factors", draw_factors))
        if "network_delay" in tables:
            drawings = (("network", draw_network),)
        for name, draw in drawings:
            path = os.path.join(arguments[1], name + ".png")
            figure = draw(tables)
            figure.text(0.01, 0.004, f"{run['seeds']} seeds on the virtual clock. {machine_line(run['machine'])}.", fontsize=6, color=FAINT)
            save(figure, path, dpi=100)
            print(f"{path}: {os.path.getsize(path) // 1024} KB")
    except FileNotFoundError as error:
        sys.exit(f"plot_stability: {error.filename}: not found; run scripts/stability first")
    except (ValueError, KeyError, StopIteration) as error:
        sys.exit(f"plot_stability: {arguments[0]} is not what knurl_stability --json writes ({error!r}); run it again")
    except OSError as error:
        sys.exit(f"plot_stability: {error.filename}: cannot be written ({error.strerror}); check the folder and the space left")


if __name__ == "__main__":
    main(sys.argv[1:])
