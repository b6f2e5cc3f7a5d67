#!/usr/bin/python3
"""Whether what ran beside each other stays within bounds: bench_bounds.py BOUNDS.json FOLDER (scripts/bench_bounds.json,
and the folder that scripts/bench --short wrote).

The bounds are the largest multiples of its reference that a function took on the machines where they were set. How sure a
multiple is comes from a bootstrap over the repetitions, drawn together with the reference's of the same moments. It fails
only if the whole interval lies above the bound times the factor (the file's, or the ratio's own: 1 where the bound is a
goal): neither noise nor another processor explains that. All ratios together fail one in a thousand times where nothing is wrong, by what repetitions show. Exit status 1:
something is too slow; 2: bounds and run do not belong together.

bench_bounds.py --filter BOUNDS.json PROGRAM prints what of a Google Benchmark program the bounds need."""

import json
import math
import pathlib
import re
import sys

import bench_compare as bc
import bench_table

FALSE_ALARMS = 0.001


def read_bounds(path):
    """[(program, what, beside, bound, factor)]"""
    try:
        data = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        factor = float(data["factor"])
        bounds = [(b["program"], b["what"], b["beside"], float(b["bound"]), float(b.get("factor", factor)))
                  for b in data["ratios"]]
        if not bounds or not all(math.isfinite(times) and times >= 1 for times in [factor] + [b[4] for b in bounds]):
            raise ValueError("it needs ratios, and a factor of 1 or more")
        for program, what, _, bound, _ in bounds:
            if not (math.isfinite(bound) and bound > 0):
                raise ValueError(f"the bound of {program} {what} is {bound}")
    except OSError as error:
        raise bc.Foreign(f"{path}: cannot be read ({error.strerror})") from error
    except KeyError as error:
        raise bc.Foreign(f"{path} lacks {error}; see scripts/bench_bounds.json") from error
    except (ValueError, TypeError) as error:
        raise bc.Foreign(f"{path}: {error}; see scripts/bench_bounds.json") from error
    return bounds


def filter_for(bounds, program):
    names = {name for where, what, beside, _, _ in bounds if where == program for name in (what, beside)}
    return "^(" + "|".join(re.escape(name) for name in sorted(names)) + ")$"


def interval(result, reference, confidence, seed=1):
    """(ratio, low, high) of the medians."""
    import numpy as np

    level, drawn, blocks = bc.drawn(np.random.default_rng(seed), result, reference)
    spread = np.std(drawn) * np.sqrt(blocks / (blocks - 1))
    reach = bc.student(confidence, blocks - 1) * spread
    return tuple(float(np.exp(level + by)) for by in (0, -reach, reach))


def judge(bounds, programs):
    """Prints a table; returns the lines of what fails. A program that did not run is left to the caller."""
    failed = []
    confidence = 1 - FALSE_ALARMS / len(bounds)
    print("| program | what | beside | ratio | bound, times its factor | |\n|---|---|---|---|---|---|")
    for program, what, beside, bound, factor in bounds:
        if program not in programs:
            print(f"| {program} | {what} | {beside} | | | did not run |")
            continue
        results = {r["name"]: r for r in programs[program]["results"]}
        for name in (what, beside):
            if name not in results:
                raise bc.Foreign(f"{program} has no \"{name}\" any more; change the bounds with what they bound")
        if bc.interrupted(results[what], results[beside]):
            print(f"| {program} | {what} | {beside} | | | interrupted while its iterations were counted: no verdict |")
            continue
        if problem := bc.shortage(f"{program} {what}", results[what], results[beside]):
            raise bc.Foreign(problem)
        ratio, low, high = interval(results[what], results[beside], confidence)
        verdict = "too slow" if low > bound * factor else "above, not beyond doubt" if ratio > bound else "within"
        line = f"{ratio:.2f} ({low:.2f} to {high:.2f})"
        print(f"| {program} | {what} | {beside} | {line} | {bound:g}, {bound * factor:.3g} | {verdict} |")
        if verdict == "too slow":
            failed.append(f"{program} {what} takes {line} times {beside}; at most {bound * factor:.3g} is explained by "
                          "noise or another machine")
    return failed


def main(arguments):
    try:
        if len(arguments) == 3 and arguments[0] == "--filter":
            print(filter_for(read_bounds(arguments[1]), arguments[2]))
            return 0
        if len(arguments) != 2 or not pathlib.Path(arguments[1]).is_dir():
            print(__doc__, file=sys.stderr)
            return 2
        bounds = read_bounds(arguments[0])
        folder = pathlib.Path(arguments[1])
        try:
            programs = bench_table.programs_of(folder, bench_table.this_machine(folder))
        except (ValueError, KeyError) as error:
            raise bc.Foreign(f"{folder} holds no results of scripts/bench --short ({error}); run it again") from error
        failed = judge(bounds, programs)
    except bc.Foreign as error:
        print(f"bench_bounds: {error}", file=sys.stderr)
        return 2
    for line in failed:
        print(f"bench_bounds: {line}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
