#!/usr/bin/python3
"""scripts/bench_compare.py: finds what got slower, calls equal runs equal, and refuses what is none of ours."""

import contextlib
import io
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "scripts"))
import bench_compare as bc  # noqa: E402

SEED = random.randrange(2**32)
MACHINE = {"processor": "p", "cpus": 2, "kernel": "6", "build": "gcc", "date": "today"}


def function(rng, name, level, reference=None, repetitions=30):
    samples = [level * rng.lognormvariate(0, 0.02) for _ in range(repetitions)]
    return {"name": name, "unit": "ns", "n": repetitions, "p50": sorted(samples)[repetitions // 2],
            "reference": reference, "samples": samples}


def process(rng, name, level, reference=None, blocks=40):
    """As knurl latency's: histograms of 128 buckets to an octave."""
    made = []
    for _ in range(blocks):
        counts = {}
        for _ in range(40):
            value = level * rng.lognormvariate(0, 0.3)
            octave = bc.SMALLEST
            while octave * 2 <= value:
                octave *= 2
            lower = octave + int((value - octave) / (octave / 128)) * octave / 128
            counts[lower] = counts.get(lower, 0) + 1
        made.append(sorted(counts.items()))
    return {"name": name, "unit": "us", "n": 40 * blocks, "p50": level, "reference": reference, "blocks": made}


def run(rng, machine=1.0, scene=1.0, wake=1.0, repetitions=30):
    return {"format": bc.FORMAT, "machine": MACHINE, "programs": {
        "scene": {"results": [function(rng, "sum", 100 * machine, None, repetitions),
                              function(rng, "solve", 300 * machine * scene, "sum", repetitions)]},
        "latency": {"results": [process(rng, "floor", 40 * machine), process(rng, "wake", 60 * machine * wake, "floor")]}}}


class BenchCompare(unittest.TestCase):
    def setUp(self):
        self.rng = random.Random(7)  # a fixed seed, since one pair of equal runs in twenty differs by chance
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def compare(self, old, new):
        paths = []
        for name, data in (("old", old), ("new", new)):
            path = pathlib.Path(self.folder.name) / f"{name}.json"
            path.write_text(data if isinstance(data, str) else json.dumps(data))
            paths.append(str(path))
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = bc.main(paths)
        return code, out.getvalue(), err.getvalue()

    def test_a_slower_machine_is_no_difference(self):
        code, out, err = self.compare(run(self.rng), run(self.rng, machine=2.0))
        self.assertEqual(code, 0, err)
        self.assertIn("2 within noise", out)

    def test_what_got_slower_is_named_and_fails(self):
        code, out, err = self.compare(run(self.rng), run(self.rng, machine=0.7, scene=1.15))
        self.assertEqual(code, 1)
        self.assertRegex(err, r"slower by more than 5 %: scene solve: 1\.1\d times")
        self.assertIn("1 slower, 0 faster, 1 within noise", out)
        code, _, err = self.compare(run(self.rng), run(self.rng, wake=1.3))
        self.assertEqual(code, 1)
        self.assertIn("latency wake", err)

    def test_a_little_slower_is_said_and_faster_too_and_neither_fails(self):
        code, out, _ = self.compare(run(self.rng), run(self.rng, scene=1.05))
        self.assertEqual(code, 0)
        self.assertIn("1 slower", out)
        code, out, _ = self.compare(run(self.rng), run(self.rng, scene=0.8))
        self.assertEqual(code, 0)
        self.assertIn("1 faster", out)

    def test_equal_runs_are_called_different_as_seldom_as_promised(self):
        wrong = 0
        self.addCleanup(setattr, bc, "RESAMPLES", bc.RESAMPLES)
        bc.RESAMPLES = 500
        self.rng = random.Random(SEED)
        for _ in range(100):
            old, new = (run(self.rng)["programs"]["scene"]["results"] for _ in range(2))
            verdict, *_ = bc.compare((old[1], old[0]), (new[1], new[0]), 0.95)
            wrong += verdict != "undecided"
        self.assertLess(wrong, 5 + 11, "of 100 at 95 %, five standard deviations")

    def test_a_machine_that_drifts_is_no_difference_and_a_doubling_is_one(self):
        """Blocks that are like their neighbours: what they scatter by in a run says little of the next run."""
        self.addCleanup(setattr, bc, "RESAMPLES", bc.RESAMPLES)
        bc.RESAMPLES = 150
        rng, blocks, figures, pairs = random.Random(SEED), 30, 6, 40
        wrong = by_blocks_alone = found = 0
        for _ in range(pairs):
            runs = [[], []]
            for _ in range(figures):
                level, memory = rng.gauss(0, 0.1), 0.935  # correlated over 15 blocks
                levels = []
                for _ in range(2 * blocks):
                    level = memory * level + rng.gauss(0, 0.1 * (1 - memory**2) ** 0.5)
                    levels.append(100 * 2.718281828**(level + rng.gauss(0, 0.03)))
                for run, part in zip(runs, (levels[:blocks], levels[blocks:])):
                    run.append(bc.Scatter({"samples": part}, None))
            drift = bc.typical_drift(runs[0] + runs[1])
            confidence = 1 - bc.FALSE_ALARMS / figures

            def any_verdict(drift):
                return any(bc.verdict_of(was, now, confidence, drift)[0] != "undecided" for was, now in zip(*runs))

            wrong += any_verdict(drift)
            runs[1][0].level += 0.6931
            found += bc.verdict_of(runs[0][0], runs[1][0], confidence, drift)[0] == "slower"
            runs[1][0].level -= 0.6931
            for scatter in runs[0] + runs[1]:
                scatter.drift = 0.0
            by_blocks_alone += any_verdict(0.0)
        # One pair in seven, over many seeds. One in twenty is promised for a steady machine only.
        self.assertLess(wrong, pairs / 7 + 11, "five standard deviations")
        self.assertGreater(by_blocks_alone, pairs / 2, "a rule that knows nothing of drift")
        self.assertGreater(found, 0.7 * pairs)

    def test_references_that_moved_apart_are_no_verdict(self):
        old, new = run(self.rng), run(self.rng, scene=1.5)
        for data, other in ((old, 100), (new, 180)):
            results = data["programs"]["scene"]["results"]
            results.append(function(self.rng, "product", other))
            results.append(function(self.rng, "invert", 3 * other, "product"))
        code, out, err = self.compare(old, new)
        self.assertEqual(code, 0, err)
        self.assertRegex(out, r"No verdict on 2 of scene: its references moved 1\.\d\d times apart")

    def test_too_few_repetitions_are_no_verdict(self):
        code, out, _ = self.compare(run(self.rng), run(self.rng, scene=3, repetitions=29))
        self.assertEqual(code, 0)
        self.assertIn("No verdict on 1 of scene: the new run has 29 blocks, 30 are needed", out)

    def test_what_is_none_of_ours_is_one_line(self):
        fine = run(self.rng)
        for bad, says in (("{", "is no JSON"), ("[1]", "is not what scripts/bench writes"),
                          ({"format": {"program": "scripts/bench", "version": 9}}, "has version 9"),
                          ({"format": bc.FORMAT}, "lacks 'programs'"),
                          (dict(fine, programs={}), "nothing in common")):
            code, _, err = self.compare(bad, fine)
            self.assertEqual((code, err.count("\n")), (2, 1), err)
            self.assertIn(says, err)
        self.assertIn("processor was q, is p", self.compare(dict(fine, machine=dict(MACHINE, processor="q")), fine)[2])

    def test_the_students_quantile_is_the_tables(self):
        for confidence, freedom, table in ((0.95, 29, 2.045), (0.99, 39, 2.708), (0.999, 30, 3.646)):
            self.assertAlmostEqual(bc.student(confidence, freedom), table, delta=0.004)

    def test_both_programs_agree(self):
        """knurl latency --compare is the same computation, written anew."""
        if len(PROGRAM) == 0:
            self.skipTest("no knurl given")
        machine = dict(MACHINE, load="", idle="")
        shown = {}
        for name, wake in (("old", 1), ("new", 1.2)):
            data = run(self.rng, wake=wake)["programs"]["latency"]
            for result in data["results"]:
                result.update(p99=None, p999=None, max=1.0, ratio=1.5 if result["reference"] else None)
            data.update(format={"program": "knurl latency", "version": 1}, machine=machine, setting={}, bounds=[])
            shown[name] = data
            (pathlib.Path(self.folder.name) / f"{name}.json").write_text(json.dumps(data))
        said = subprocess.run([*PROGRAM, "latency", "--compare", f"{self.folder.name}/old.json", "--measured",
                               f"{self.folder.name}/new.json", "--json"], capture_output=True, text=True, check=True)
        all_of_it = json.loads(said.stdout)
        theirs = next(p for p in all_of_it["paths"] if p["name"] == "wake" and p["percentile"] == 50)
        old, new = ((data["results"][1], data["results"][0]) for data in shown.values())
        drift = bc.typical_drift([bc.Scatter(*of) for a_run in (old, new) for of in (a_run, (a_run[1], None))])
        verdict, ratio, low, high = bc.compare(old, new, all_of_it["confidence"], drift)
        self.assertEqual((verdict, theirs["verdict"]), ("slower", "worse"))
        for ours, other in ((ratio, theirs["ratio"]), (low, theirs["low"]), (high, theirs["high"])):
            self.assertAlmostEqual(ours, other, delta=0.03)


if __name__ == "__main__":
    PROGRAM = sys.argv[1:2]
    print("seed", SEED)
    unittest.main(argv=sys.argv[:1])
