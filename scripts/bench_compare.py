#!/usr/bin/python3
"""What got slower between two runs of scripts/bench: bench_compare.py OLD.json NEW.json (out/bench/all.json of each).

Each thing is compared as a multiple of the reference that ran interleaved with it, so that a machine that was slower as
a whole is no difference. How sure that is comes from a bootstrap over the run's blocks (repetitions of a function,
pieces of a long measurement), at least 30 in each, and from how much more than that eight stretches of a run differ: what
the machine does between those it does between two runs as well. It is the rule of knurl latency --compare
(runtime/measure/compare.hpp). All verdicts together are wrong for one in twenty pairs of equal runs at most on a steady
machine, and for more where it drifts for about as long as a run takes: one pair in seven in the tests' model of that.
scripts/equal_runs counts yours. Beside a load the promise is void: eleven of 105 pairs of equal runs of knurl latency had one,
two without. Exit status 1: something got slower by more than 5 %, whatever the noise; 2: these are not two such runs.
Two runs of one build differ by a few per cent in where code and data lie, which no block of either run shows; hence
the 5 %."""

import json
import sys

import numpy as np

FORMAT = {"program": "scripts/bench", "version": 1}
LEAST_BLOCKS, LEAST_ABOVE, RESAMPLES, STRETCHES = 30, 10, 4000, 8
FALSE_ALARMS, MARGIN, MOST_MOVED = 0.05, 1.05, 1.3
SHORTEST_REPETITION = 2e6  # ns; scripts/bench asks for 10e6 at least
SMALLEST = 2.0**-10


class Foreign(Exception):
    """A file that cannot be compared: why, and what to do."""


def read(path):
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
    except OSError as error:
        raise Foreign(f"{path}: cannot be read ({error.strerror}); give the all.json of a run of scripts/bench") from error
    except ValueError as error:
        raise Foreign(f"{path} is no JSON ({error}); give the all.json of a run of scripts/bench") from error
    form = data.get("format") if isinstance(data, dict) else None
    if not isinstance(form, dict) or form.get("program") != FORMAT["program"]:
        raise Foreign(f"{path} is not what scripts/bench writes; give the all.json of a run of it")
    if form.get("version") != FORMAT["version"]:
        raise Foreign(f"{path} has version {form.get('version')} of the format, this script reads {FORMAT['version']}; "
                      "run scripts/bench again")
    try:
        for run in data["programs"].values():
            for result in run["results"]:
                result["name"], result["reference"], result["p50"]
        data["machine"]["processor"], data["machine"]["date"]
    except (KeyError, TypeError, AttributeError) as error:
        raise Foreign(f"{path} lacks {error}; run scripts/bench again") from error
    return data


class Median:
    """The median of some blocks of a result, drawn many times at once: weights[i, b] is how often draw i has block b."""

    def __init__(self, result):
        self.samples = np.array(result["samples"], float) if "samples" in result else None
        if self.samples is not None:
            self.blocks = len(self.samples)
            return
        edges = sorted({lower for block in result["blocks"] for lower, _ in block})
        self.lower = np.array(edges)
        place = {lower: i for i, lower in enumerate(edges)}
        self.blocks = len(result["blocks"])
        self.counts = np.zeros((self.blocks, len(edges)))
        for i, block in enumerate(result["blocks"]):
            for lower, count in block:
                self.counts[i, place[lower]] += count
        octave = 2.0 ** np.floor(np.log2(np.maximum(self.lower, SMALLEST)))
        self.width = np.where(self.lower < SMALLEST, 0, octave / 128)

    def of(self, weights):
        if self.samples is not None:
            order = np.argsort(self.samples)
            reached = np.cumsum(weights[:, order], axis=1)
            middle = np.argmax(reached >= reached[:, -1:] / 2, axis=1)
            return self.samples[order][middle]
        sums = weights @ self.counts
        reached = np.cumsum(sums, axis=1)
        rank = np.ceil(reached[:, -1] / 2)
        place = np.argmax(reached >= rank[:, None], axis=1)
        rows = np.arange(len(place))
        inside = (rank - (reached[rows, place] - sums[rows, place]) - 0.5) / np.maximum(sums[rows, place], 1)
        return self.lower[place] + inside * self.width[place]


def interrupted(*results):
    """Google Benchmark counts how many iterations fill a repetition until one took min_time of the CPU, or five times that
    by the clock: where others had the CPU meanwhile, a repetition is a few iterations, cold and little but their timer."""
    return any(r is not None and r.get("repetition_ns", SHORTEST_REPETITION) < SHORTEST_REPETITION for r in results)


def shortage(name, result, reference):
    """Why nothing can be said of this run; empty: something can."""
    if interrupted(result, reference):
        return f"{name} was interrupted while its iterations were counted"
    for what, part in (("", result), (" of its reference", reference)):
        if part is None:
            continue
        blocks = part.get("samples", part.get("blocks"))
        if blocks is None:
            return f"{name} has no blocks{what}"
        if len(blocks) < LEAST_BLOCKS:
            return f"{name} has {len(blocks)} blocks{what}, {LEAST_BLOCKS} are needed"
        if "samples" not in part and part["n"] < 2 * LEAST_ABOVE:
            return f"{name} has {part['n']} samples{what}, {2 * LEAST_ABOVE} are needed"
    return ""


def levels(result, reference, weights):
    """log(median) of these drawings; beside the reference's of the same blocks."""
    level = np.log(np.maximum(Median(result).of(weights), SMALLEST / 2))
    if reference is not None:
        level -= np.log(np.maximum(Median(reference).of(weights), SMALLEST / 2))
    return level


def drawn(random, result, reference):
    """log(median) of the whole run, and of as many drawings; beside the reference's of the same blocks."""
    blocks = Median(result).blocks
    weights = np.vstack([np.ones(blocks), random.multinomial(blocks, np.full(blocks, 1 / blocks), RESAMPLES)])
    level = levels(result, reference, weights)
    return level[0], level[1:], blocks


def student(confidence, freedom):
    """Two-sided, to 1e-6: by bisection of the distribution's integral, which Simpson's rule has of cos^(n-1)."""
    half = np.pi / 2
    # t = sqrt(n) tan(a) turns the density into cos(a)^(n - 1).
    angles = np.linspace(0, half, 20001)
    density = np.cos(angles) ** (freedom - 1)
    steps = (density[:-2:2] + 4 * density[1:-1:2] + density[2::2]) * (angles[1] / 3)
    share = np.concatenate([[0], np.cumsum(steps)])
    return float(np.sqrt(freedom) * np.tan(np.interp(confidence, share / share[-1], angles[::2])))


class Scatter:
    """Of one run: its level, how its blocks say that this scatters, and how much more its stretches differ (the drift)."""

    def __init__(self, result, reference, seed=1):
        self.level, drawings, blocks = drawn(np.random.default_rng(seed), result, reference)
        self.blocks = blocks
        self.variance = np.var(drawings) * blocks / (blocks - 1)
        edges = [i * blocks // STRETCHES for i in range(STRETCHES + 1)]
        weights = np.zeros((STRETCHES, blocks))
        for row, first, end in zip(weights, edges, edges[1:]):
            row[first:end] = 1
        self.drift = np.var(levels(result, reference, weights), ddof=1) - STRETCHES * self.variance


def typical_drift(scatters):
    """What one result shows of the machine's drift can be little by chance."""
    drifts = sorted(s.drift for s in scatters)
    return drifts[len(drifts) // 2] if drifts else 0.0


def verdict_of(was, now, confidence, drift=0.0, moved=0.0):
    """Two Scatters -> (verdict, ratio, low, high)."""
    blocks = student(confidence, min(was.blocks, now.blocks) - 1)
    stretches = student(confidence, STRETCHES - 1)  # few, and neighbours are alike: no more than one run's
    reach = np.sqrt(sum(blocks**2 * s.variance + stretches**2 * max(0.0, s.drift, drift) for s in (was, now)))
    middle = now.level - was.level
    low, high = middle - reach, middle + reach
    verdict = "slower" if low > moved else "faster" if high < -moved else "undecided"
    return verdict, float(np.exp(middle)), float(np.exp(low)), float(np.exp(high))


def compare(old, new, confidence, drift=0.0, moved=0.0):
    """((result, reference) of each run) -> (verdict, ratio, low, high) or (why not, None, None, None)."""
    for name, (result, reference) in (("the old run", old), ("the new run", new)):
        if problem := shortage(name, result, reference):
            return problem, None, None, None
    return verdict_of(Scatter(*old), Scatter(*new), confidence, drift, moved)


def references_apart(pairs):
    """How far apart the references of one program have moved, of the logarithm: beside one or the other a thing that did
    not change would differ by so much."""
    moved = {b["reference"]: np.log(now[1]["p50"] / was[1]["p50"]) for b, was, now in
             ((before[0], before, now) for _, _, before, now in pairs) if was[1]["p50"] and now[1]["p50"]}
    return float(max(moved.values()) - min(moved.values())) if moved else 0.0


def pairs_of(old, new):
    """(program, name, (result, reference) of the old run, of the new run), of what both have and state beside the same."""
    for program, run in new["programs"].items():
        before = {r["name"]: r for r in old["programs"].get(program, {"results": []})["results"]}
        now = {r["name"]: r for r in run["results"]}
        for name, result in now.items():
            reference = result["reference"]
            if name not in before or reference is None or before[name]["reference"] != reference:
                continue
            if reference in before and reference in now:
                yield program, name, (before[name], before[reference]), (result, now[reference])


def main(arguments):
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        if arguments[0] == "--check":  # whether it can be compared with at all
            read(arguments[1])
            return 0
        old, new = (read(path) for path in arguments)
    except Foreign as error:
        print(f"bench_compare: {error}", file=sys.stderr)
        return 2
    pairs = list(pairs_of(old, new))
    if not pairs:
        print("bench_compare: the two runs have nothing in common that has a reference; were both made by scripts/bench?",
              file=sys.stderr)
        return 2
    for key in ("processor", "cpus", "kernel", "build"):
        was, now = old["machine"].get(key), new["machine"].get(key)
        if was != now:
            print(f"bench_compare: not alike: {key} was {was}, is {now}; the difference may be that", file=sys.stderr)
    possible = [p for p in pairs if not shortage("", *p[2]) and not shortage("", *p[3])]
    confidence = 1 - FALSE_ALARMS / max(1, len(possible))
    print(f"\nAgainst the run of {old['machine']['date']}, multiples of references, {len(possible)} comparisons, each at "
          f"{100 * confidence:.2f} %:\n\n| program | what | beside | new to old | |\n|---|---|---|---|---|")
    slower, counts = [], {"slower": 0, "faster": 0, "undecided": 0}
    unsaid = {}
    for program in dict.fromkeys(p[0] for p in pairs):
        of_it = [p for p in pairs if p[0] == program]
        whole = []
        for _, name, before, now in of_it:
            if problem := shortage("the old run", *before) or shortage("the new run", *now):
                unsaid.setdefault((program, problem), []).append(name)
            else:
                whole.append((name, now[0]["reference"], Scatter(*before), Scatter(*now)))
        drift = typical_drift([s for _, _, *both in whole for s in both])
        moved = references_apart([p for p in of_it if any(p[1] == name for name, *_ in whole)])
        if moved > np.log(MOST_MOVED):
            unsaid[(program, f"its references moved {np.exp(moved):.2f} times apart between the runs; measure again on a "
                    "steadier machine")] = [name for name, *_ in whole]
            continue
        for name, reference, was, is_now in whole:
            verdict, ratio, low, high = verdict_of(was, is_now, confidence, drift, moved)
            counts[verdict] += 1
            if verdict == "slower" and low > MARGIN:
                slower.append(f"{program} {name}: {ratio:.2f} times ({low:.2f} to {high:.2f})")
            if verdict != "undecided":
                print(f"| {program} | {name} | {reference} | {ratio:.3f} ({low:.3f} to {high:.3f}) | {verdict} |")
    print(f"\n{counts['slower']} slower, {counts['faster']} faster, {counts['undecided']} within noise.")
    for (program, why), names in unsaid.items():
        print(f"No verdict on {len(names)} of {program}: {why}.")
    for line in slower:
        print(f"bench_compare: slower by more than {100 * (MARGIN - 1):.0f} %: {line}", file=sys.stderr)
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
