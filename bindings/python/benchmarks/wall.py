#!/usr/bin/env python3
"""wall.py [--out wall.png] [--cxx PROGRAM]: the stiffest stable wall from Python: planes 20 times a second, or forces from the loop.

A simulated hand (200 N/m, 3 N s/m) moves 4 mm into a wall and stays there. "plane": the loop sends a knurl.Plane, and the
servo computes the force 1000 times a second. "force": the loop computes k depth from the newest report and sends it as a
knurl.ConstantForce, as programs without Knurl do. A wall is stable where the hand, two seconds later, moves by less
than 0.2 mm from peak to peak, in one of two trials. With --cxx a C++ program does the same on the same servo, judged by the same reports.
"""
import argparse
import subprocess

import numpy as np
from machine import machine

import knurl

HAND = [(0, 0, 0, 0.005), (0.6, 0, 0, 0.005), (0.7, 0, 0, -0.004), (1e5, 0, 0, -0.004)]  # t (s), x, y, z (m)
STIFFNESSES = (50, 100, 150, 175, 200, 225, 250, 300, 400, 500, 800, 1200, 1500, 1800, 2500, 3100)  # N/m
SECONDS = 3.2
CXX = None  # path of the program
STABLE = 2e-4  # m


def plane(hand, stiffness):
    """Sends the wall as it is; returns what to do in each turn."""
    wall = hand.add(knurl.Plane(stiffness=stiffness))

    def turn(report):
        wall.offset = 0.0

    return turn


def force(hand, stiffness):
    """Computes the wall's force; returns what to do in each turn."""
    push = hand.add(knurl.ConstantForce(recovery=0))

    def turn(report):
        push.force = (0.0, 0.0, max(0.0, -stiffness * report.position[2]))

    return turn


def leave_fault(servo):
    """Waits until the hand that a wall threw about is slow, and leaves the fault of the trial before."""
    with servo.connect(hints=False) as client, client.claim() as hand:
        for report in hand.reports(rate=50):
            if report.state != knurl.DeviceState.FAULT:
                return
            if np.linalg.norm(report.velocity) < 0.005:
                hand.reset_fault()


def python(way):
    """The loop of this process; ns of its first and last report."""

    def run(servo, stiffness, rate):
        with servo.connect(hints=False) as client, client.claim(update_interval=1 / rate) as hand:
            turn = (plane if way == "plane" else force)(hand, stiffness)
            hand.arm()
            first = None
            for report in hand.reports(rate=rate):
                first = report.read_ns if first is None else first
                turn(report)
                if report.read_ns - first > SECONDS * 1e9:
                    return first, report.read_ns

    return run


def cxx(way):
    """The same loop in C++ (wall.cpp)."""

    def run(servo, stiffness, rate):
        said = subprocess.run([CXX, "--socket", servo.address, "--way", way, "--stiffness", str(stiffness), "--rate", str(rate),
                               "--seconds", str(SECONDS)], stdout=subprocess.PIPE, text=True, check=True).stdout
        return tuple(map(int, said.split()))

    return run


def movement(servo, loop, stiffness, rate):
    """What the hand still moves from peak to peak (m), and its path (s, m)."""
    leave_fault(servo)
    with servo.connect(hints=False) as client, client.observe() as observer, observer.record() as recording:
        first, last = loop(servo, stiffness, rate)
    reports = recording.reports
    reports = reports[(reports["read_ns"] >= first) & (reports["read_ns"] <= last)]
    time = (reports["read_ns"] - first) * 1e-9
    late = reports["position"][time > time[-1] - 0.6, 2]
    fault = bool((reports["state"] == knurl.DeviceState.FAULT).any())
    return (np.inf if fault else float(np.ptp(late))), time, reports["position"][:, 2]


def sweep(servo, way, rate):
    """Movement of each stiffness, and the largest up to which all are stable (N/m)."""
    moved = []
    for stiffness in STIFFNESSES:
        each = movement(servo, way, stiffness, rate)[0]
        # A loop that the machine has held up moves the hand as well, but not twice.
        moved.append(each if each < STABLE else min(each, movement(servo, way, stiffness, rate)[0]))
    unstable = [index for index, each in enumerate(moved) if not each < STABLE]
    largest = STIFFNESSES[unstable[0] - 1] if unstable and unstable[0] else STIFFNESSES[-1] if not unstable else 0
    return moved, largest


WAYS = [("plane, 20 updates/s", python("plane"), 20), ("force from the loop, 20/s", python("force"), 20),
        ("force from the loop, 60/s", python("force"), 60), ("force from the loop, 500/s", python("force"), 500)]
CXX_WAYS = [("C++: plane, 20 updates/s", cxx("plane"), 20), ("C++: force, 20/s", cxx("force"), 20)]


def draw(path, found, traces):
    """Left: the hand at 500 N/m; right: movement by stiffness."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 3.2), layout="constrained", dpi=80)
    left, right = figure.subplots(1, 2)
    for (name, time, z), width in zip(traces, (2, 1)):
        left.plot(time, z * 1e3, label=name, linewidth=width)
    left.set(xlabel="time (s)", ylabel="height of the hand (mm)", title="a wall of 500 N/m at height 0", xlim=(0.5, 3))
    for name, moved in found:
        right.loglog(STIFFNESSES, np.clip(np.array(moved) * 1e3, 0.02, 30), "o-", label=name, markersize=3)
    right.axhline(STABLE * 1e3, color="0.7", linewidth=1)
    right.set(xlabel="stiffness (N/m)", ylabel="movement at rest (mm)", title="below the line: stable")
    left.legend(fontsize=7, frameon=False)
    right.legend(fontsize=7, frameon=False)
    figure.savefig(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", help="picture to draw (needs matplotlib)")
    parser.add_argument("--cxx", help="knurl_bench_wall of a build: the same from C++, on the same servo and hand")
    said = parser.parse_args()
    global CXX
    CXX = said.cxx
    print(machine())
    found = []
    with knurl.simulated(hand=HAND) as servo:
        for name, way, rate in WAYS + (CXX_WAYS if CXX else []):
            moved, largest = sweep(servo, way, rate)
            found += [(name, moved)] if (name, way, rate) in WAYS else []
            print(f"{name:28} stable up to {largest:5} N/m   " + " ".join(f"{each * 1e3:.2f}" for each in moved), flush=True)
        if said.out:
            traces = [(name, *movement(servo, way, 500, rate)[1:]) for name, way, rate in WAYS[:2]]
            draw(said.out, found, traces)


if __name__ == "__main__":
    main()
