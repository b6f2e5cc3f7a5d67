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


def line(what, value, unit, beside=None, word="goal "):
    """Prints a row of the table."""
    print(f"{what:58} {value:12.2f} {unit:10} {'' if beside is None else f'{word}{beside}'}", flush=True)


def servo_memory():
    """Address of the end of a mapping that the reports come in (/proc/self/maps)."""
    found = []
    with open("/proc/self/maps", encoding="utf-8") as file:
        for row in file:
            place, rights = row.split()[:2]
            begin, end = (int(word, 16) for word in place.split("-"))
            if rights == "r--s" and end - begin > RING:
                found.append(end)
    assert found, "no mapping looks like a servo's reports"
    return found[0]


RING = 4096 * 384  # bytes of the servo's reports


def reports_into_numpy(servo, rounds=9):
    """us for 1000 reports in each way; every second another one, so that for each of them the reports are new to this CPU."""
    kept, count = [], 1000
    room, target = np.zeros(4096, knurl.report_dtype()), np.ones(384 * count, np.uint8)
    # The keeper has memory of its own, which it uses up.
    with servo.connect(hints=False) as client, client.observe() as observer, client.observe() as keeper:
        begin = servo_memory() - RING - 4096  # within a page: what is copied does not matter here

        def copied():
            at = (observer.latest().cycle - count) % 4096
            began = time.perf_counter()
            first = min(count, 4096 - at)
            ctypes.memmove(target.ctypes.data, begin + 384 * at, 384 * first)
            ctypes.memmove(target.ctypes.data + 384 * first, begin, 384 * (count - first))
            return time.perf_counter() - began

        def timed(call):
            began = time.perf_counter()
            found = len(call())
            return (time.perf_counter() - began) * count / found

        ways = {
            "1000 reports by drain()": lambda: timed(observer.drain),
            "... every array kept": lambda: timed(lambda: kept.append(keeper.drain()) or kept[-1]),
            "... drain(out=room)": lambda: timed(lambda: observer.drain(out=room)),
            "... memcpy of them out of the servo's memory": copied,
        }
        times = {name: [] for name in ways}
        for name, way in list(ways.items()) * (rounds + 1):
            observer.latest(), keeper.latest()
            time.sleep(1.0)
            times[name].append(way() * 1e6)
    source = np.random.bytes(400 * count)
    target = ctypes.create_string_buffer(len(source))
    times["... memcpy of their 400000 bytes, in the cache"] = [microseconds(lambda: ctypes.memmove(target, source, len(source)), 200)]
    return {name: found[1:] or found for name, found in times.items()}  # the first one made its memory


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
        for name, found in reports_into_numpy(servo).items():
            line(name, statistics.median(found), "us", f"least {min(found):.0f}, most {max(found):.0f}", "")
        turns, missed, late, worst = loop_at_1_khz(servo, said.seconds)
        line(f"loop over every report for {said.seconds:.0f} s: turns", turns, "")
        line("  reports missed", missed, "", 0)
        line("  turns that found a newer report there", late, f"worst {worst:.0f}")
    step, run = offline()
    line("Offline.step()", step, "cycles/s")
    line("Offline.run()", run, "cycles/s", "1e6, its order")


if __name__ == "__main__":
    main()
