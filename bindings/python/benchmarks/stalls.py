#!/usr/bin/env python3
"""stalls.py: what the hand feels while the Python program stands still, for each policy `alive=`.

The hand presses on a plane at rest. The program commits 100 times a second, then stalls: its loop sleeps (other threads
of Python run), or another thread holds the interpreter (nothing of Python runs). A second process observes every cycle.
"""
import argparse
import ctypes
import os
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np
from machine import machine

import knurl

HAND = [(0, 0, 0, 0.005), (0.6, 0, 0, 0.005), (0.8, 0, 0, -0.004), (1e5, 0, 0, -0.004)]  # t (s), x, y, z (m)
POLICIES = ("loop", "interpreter", "always")
STALLS = (0.001, 0.01, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)

_RECORDER = """
import sys, numpy, knurl
with knurl.connect(sys.argv[1]) as client, client.observe() as observer:
    with observer.record() as recording:
        print("recording", flush=True)
        sys.stdin.read()
    assert recording.missed == 0, f"{recording.missed} reports were missed"
numpy.save(sys.argv[2], recording.reports)
"""

_holding_libc = ctypes.PyDLL(None)  # its calls keep the interpreter's lock


def loop_sleeps(seconds):
    """The loop stands still; other threads of Python run."""
    time.sleep(seconds)


def interpreter_held(seconds):
    """Another thread holds the interpreter, as a long regular expression or a big power does: nothing of Python runs."""
    thread = threading.Thread(target=_holding_libc.usleep, args=(int(seconds * 1e6),))
    thread.start()
    thread.join()


KINDS = {"loop sleeps": loop_sleeps, "interpreter held": interpreter_held}


class Watch:
    """Records every cycle in a process of its own."""

    def __init__(self, address):
        self._path = os.path.join(tempfile.mkdtemp(), "reports.npy")
        self._process = subprocess.Popen([sys.executable, "-c", _RECORDER, address, self._path], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        assert self._process.stdout.readline() == b"recording\n"

    def reports(self):
        """Ends it."""
        self._process.communicate()
        assert self._process.returncode == 0
        reports = np.load(self._path)
        os.unlink(self._path)
        os.rmdir(os.path.dirname(self._path))
        return reports


def commit_for(hand, seconds):
    """100 turns a second."""
    first = None
    for report in hand.reports(rate=100):
        first = report.time if first is None else first
        if report.time - first > seconds:
            return report


def wait_for_rest(hand, turns=50):
    """Until the hand has rested on the plane for so many turns, with the whole force."""
    rested, before = 0, 0.0
    for report in hand.reports(rate=100):
        still = report.touching and report.state == knurl.DeviceState.ACTIVE and abs(report.position[2] - before) < 2e-5
        rested, before = rested + 1 if still else 0, report.position[2]
        if rested == turns:
            return


def felt(servo, policy, stall, seconds):
    """(force before, smallest force, largest change within a millisecond) in N, from before the stall to after it.

    Fourth: the longest time between two cycles of the servo (s). After more than 20 ms its force begins anew.
    """
    with servo.connect(hints=False) as client, client.claim(alive=policy) as hand:
        hand.add(knurl.Plane(stiffness=500))
        hand.arm()
        wait_for_rest(hand)
        watch = Watch(servo.address)
        try:
            begin = commit_for(hand, 0.1).cycle
            stall(seconds)
            end = commit_for(hand, 0.4).cycle
        finally:
            reports = watch.reports()
    reports = reports[(reports["cycle"] >= begin) & (reports["cycle"] <= end)]
    force = reports["sent_force"][:, 2]
    # A cycle is a millisecond, but where the servo itself was late, and the hand moved on meanwhile.
    milliseconds = np.maximum(1, np.diff(reports["read_ns"]) * 1e-6)
    return force[0], force.min(), (np.abs(np.diff(force)) / milliseconds).max(), milliseconds.max() * 1e-3


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stalls", type=float, nargs="+", default=STALLS, help="how long (s)")
    said = parser.parse_args()
    print(machine())
    print(f"{'alive=':12} {'stall':17} {'s':>6} {'N before':>9} {'least N':>9} {'N in a ms':>10}")
    with knurl.simulated(hand=HAND) as servo:
        for policy in POLICIES:
            for name, stall in KINDS.items():
                for seconds in said.stalls:
                    before, least, step, _ = felt(servo, policy, stall, seconds)
                    print(f"{policy:12} {name:17} {seconds:6.3f} {before:9.3f} {least:9.3f} {step:10.4f}", flush=True)


if __name__ == "__main__":
    main()
