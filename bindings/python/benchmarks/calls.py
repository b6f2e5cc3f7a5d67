#!/usr/bin/env python3
"""calls.py [--seconds 60]: what the package costs: a call, reports into NumPy, an update, a 1 kHz loop, import, Offline."""
import argparse
import ctypes
import statistics
import subprocess
import sys
import time

import numpy as np
from machine import machine

import knurl
from knurl._library import lib


def microseconds(call, count=20000, rounds=7):
    """Median over rounds of the mean time of a call (us)."""
    found = []
    for _ in range(rounds):
        began = time.perf_counter()
        for _ in range(count):
            call()
        found.append((time.perf_counter() - began) / count * 1e6)
    return statistics.median(found)


def empty():
    """The loop itself."""


def line(what, value, unit, goal=None):
    """Prints a row of the table."""
    print(f"{what:58} {value:12.2f} {unit:10} {'' if goal is None else f'goal {goal}'}")


def reports_into_numpy(servo, rounds=7):
    """us for 1000 reports: hand.drain(), and into an array that is there already; and a memcpy of as many bytes."""
    with servo.connect(hints=False) as client, client.observe() as observer:
        drained, filled = [], []
        room = np.empty(4096, knurl._reports.report_dtype())
        for _ in range(rounds):
            for call, times in ((lambda: len(observer.drain()), drained), (lambda: observer._drain_into(room), filled)):
                time.sleep(1.0)
                began = time.perf_counter()
                count = call()
                times.append((time.perf_counter() - began) / count * 1000 * 1e6)
    size = 1000 * room.dtype.itemsize
    source, target = np.random.bytes(size), ctypes.create_string_buffer(size)
    copied = microseconds(lambda: ctypes.memmove(target, source, size), 200)
    return statistics.median(drained), statistics.median(filled), copied


def loop_at_1_khz(servo, seconds):
    """Reports of a loop that takes every one and moves a plane: (turns, missed, late, worst age when it ended in ms)."""
    with servo.connect(hints=False) as client, client.claim() as hand:
        floor = hand.add(knurl.Plane(stiffness=500))
        hand.arm()
        turns, late, worst = 0, 0, 0.0
        for report in hand.reports():
            floor.offset = 1e-4 * np.sin(report.time)
            turns += 1
            late += report.unread > 0
            worst = max(worst, report.unread)
            if report.time > seconds:
                return turns, hand.missed, late, worst


def import_time():
    """ms of `import knurl` by -X importtime, and of an interpreter that does nothing else (both medians of 7)."""
    found = []
    for _ in range(7):
        said = subprocess.run([sys.executable, "-X", "importtime", "-c", "import knurl"], stderr=subprocess.PIPE, text=True, check=True)
        found.append(int(said.stderr.strip().splitlines()[-1].split("|")[1]) / 1000)
    return statistics.median(found)


def offline():
    """Cycles a second of step() and of run(), with a plane that is touched."""
    servo = knurl.Offline()
    servo.add(knurl.Plane(stiffness=800))
    path = np.zeros((200000, 3))
    path[:, 2] = -0.001
    runs = []
    for _ in range(5):
        began = time.perf_counter()
        servo.run(path)
        runs.append(len(path) / (time.perf_counter() - began))
    place = (0.0, 0.0, -0.001)
    return 1e6 / microseconds(lambda: servo.step(place)), statistics.median(runs)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60, help="of the 1 kHz loop")
    said = parser.parse_args()
    print(machine())
    floor_of_loop = microseconds(empty)
    line("ctypes call (knurl_version)", microseconds(lib.knurl_version) - floor_of_loop, "us", 0.5)
    line("import knurl, without NumPy", import_time(), "ms", 100)
    with knurl.simulated() as servo:
        with servo.connect(hints=False) as client, client.claim() as hand:
            floor = hand.add(knurl.Plane(stiffness=500))
            handle = hand._handle
            line("ctypes call with a handle (knurl_progress)", microseconds(lambda: lib.knurl_progress(handle)) - floor_of_loop, "us")

            def update():
                floor.offset = 0.001
                hand.commit()

            line("assignment to a bound plane", microseconds(lambda: setattr(floor, "offset", 0.001)), "us")
            hand.commit()
            line("commit() alone", microseconds(hand.commit, 5000), "us")
            line("assignment + commit() of one plane", microseconds(update, 5000), "us", 10)
        drained, filled, copied = reports_into_numpy(servo)
        line("1000 reports by drain()", drained, "us", 5)
        line("1000 reports into an array that is there", filled, "us")
        line("memcpy of their 400000 bytes", copied, "us")
        turns, missed, late, worst = loop_at_1_khz(servo, said.seconds)
        line(f"loop over every report for {said.seconds:.0f} s: turns", turns, "")
        line("  reports missed", missed, "", 0)
        line("  turns that found a newer report there", late, f"worst {worst:.0f}")
    step, run = offline()
    line("Offline.step()", step, "cycles/s")
    line("Offline.run()", run, "cycles/s", "1e6, its order")


if __name__ == "__main__":
    main()
