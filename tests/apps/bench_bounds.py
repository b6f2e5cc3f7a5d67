#!/usr/bin/python3
"""scripts/bench_bounds.py: what is too slow beyond doubt fails, what noise may explain does not, and bounds that bound
nothing are found out."""

import contextlib
import io
import json
import pathlib
import random
import re
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))
import bench_bounds as bb  # noqa: E402

SEED = random.randrange(2**32)
BOUNDS = {"factor": 1.5, "ratios": [{"program": "scene", "what": "solve", "beside": "sum", "bound": 3},
                                    {"program": "rings", "what": "publish", "beside": "copy", "bound": 2}]}


def google(rng, levels, noise, moods, repetitions=30, iterations=100_000):
    """As Google Benchmark writes it; repetition i of all has the machine's mood i."""
    mood = [rng.lognormvariate(0, moods) for _ in range(repetitions)]
    return {"context": {"date": "today"}, "benchmarks": [
        {"name": name, "run_type": "iteration", "iterations": iterations, "cpu_time": level * mood[i] * rng.lognormvariate(0, noise)}
        for name, level in levels.items() for i in range(repetitions)]}


def rings(rng, publish):
    """As knurl_bench_rings writes it."""
    def blocks(level):
        return [[[level * (1 + rng.randrange(3) / 128), 20]] for _ in range(30)]
    return {"machine": {}, "results": [{"name": name, "unit": "ns", "n": 600, "reference": None, "blocks": blocks(level)}
                                       for name, level in (("copy", 16.0), ("publish", 16.0 * publish))]}


class BenchBounds(unittest.TestCase):
    def setUp(self):
        self.rng = random.Random(SEED)

    def judge(self, solve=2.9, noise=0.02, moods=0.0, publish=1.5, bounds=BOUNDS, repetitions=30, with_rings=True,
              iterations=100_000):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name) / "run"
            folder.mkdir()
            levels = {"sum": 100, "solve": 100 * solve}
            (folder / "scene.google.json").write_text(json.dumps(google(self.rng, levels, noise, moods, repetitions,
                                                                         iterations)))
            if with_rings:
                (folder / "rings.json").write_text(json.dumps(rings(self.rng, publish)))
            file = pathlib.Path(name) / "bounds.json"
            file.write_text(bounds if isinstance(bounds, str) else json.dumps(bounds))
            out, err = io.StringIO(), io.StringIO()
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                code = bb.main([str(file), str(folder)])
        return code, out.getvalue(), err.getvalue()

    def test_what_lies_within_passes(self):
        code, out, err = self.judge()
        self.assertEqual((code, err), (0, ""))
        self.assertEqual(out.count("| within |"), 2, out)

    def test_three_times_slower_fails_and_is_named(self):
        code, _, err = self.judge(solve=3 * 2.9)
        self.assertEqual((code, err.count("\n")), (1, 1), err)
        self.assertRegex(err, r"scene solve takes 8\.\d+ \(.*\) times sum; at most 4\.5 is explained")
        code, _, err = self.judge(publish=6)
        self.assertEqual(code, 1)
        self.assertIn("rings publish", err)

    def test_a_noisy_machine_does_not_fail(self):
        for _ in range(30):
            code, _, err = self.judge(noise=0.8, moods=0.8)
            self.assertEqual(code, 0, err)

    def test_on_a_noisy_machine_what_is_far_too_slow_fails_all_the_same(self):
        self.assertEqual(self.judge(solve=10 * 2.9, noise=0.4, moods=0.8)[0], 1)

    def test_a_goal_has_a_factor_of_its_own(self):
        goal = dict(BOUNDS, ratios=[dict(BOUNDS["ratios"][0], factor=1)] + BOUNDS["ratios"][1:])
        self.assertEqual(self.judge(solve=3.6)[0], 0)
        self.assertEqual(self.judge(solve=3.6, bounds=goal)[0], 1)
        self.assertEqual(self.judge(solve=2.8, bounds=goal)[0], 0)

    def test_above_the_bound_but_not_beyond_the_factor_is_said_alone(self):
        code, out, err = self.judge(solve=3.6)
        self.assertEqual((code, err), (0, ""))
        self.assertIn("above, not beyond doubt", out)

    def test_what_the_machine_does_to_both_alike_makes_no_doubt(self):
        code, _, err = self.judge(solve=3 * 2.9, noise=0.02, moods=1.5)
        self.assertEqual(code, 1, err)

    def test_repetitions_of_a_few_iterations_are_no_verdict(self):
        code, out, _ = self.judge(solve=30, iterations=10)
        self.assertEqual(code, 0)
        self.assertIn("interrupted while", out)

    def test_a_program_that_did_not_run_is_said(self):
        code, out, _ = self.judge(with_rings=False)
        self.assertEqual(code, 0)
        self.assertIn("did not run", out)

    def test_bounds_that_do_not_belong_to_the_run_are_one_line(self):
        gone = dict(BOUNDS, ratios=[dict(BOUNDS["ratios"][0], what="solved")])
        none = dict(BOUNDS, ratios=[])
        for bad, says in (("{", "see scripts/bench_bounds.json"), ({"factor": 2}, "lacks 'ratios'"), (none, "it needs ratios"),
                          (dict(BOUNDS, factor=0.5), "a factor of 1 or more"), (gone, 'has no "solved" any more')):
            code, _, err = self.judge(bounds=bad)
            self.assertEqual((code, err.count("\n")), (2, 1), err)
            self.assertIn(says, err)
        code, _, err = self.judge(repetitions=0)  # as if a filter had matched nothing
        self.assertEqual(code, 2, err)
        code, _, err = self.judge(repetitions=29)
        self.assertEqual(code, 2)
        self.assertIn("30 are needed", err)

    def test_the_committed_bounds_are_read_and_every_one_says_why(self):
        bounds = bb.read_bounds(SCRIPTS / "bench_bounds.json")
        for ratio in json.loads((SCRIPTS / "bench_bounds.json").read_text())["ratios"]:
            self.assertTrue(ratio["why"], ratio)
        chosen = re.compile(bb.filter_for(bounds, "scene"))
        for name, is_one in (("empty", True), ("one_plane", True), ("springs/6", True), ("springs/64", False)):
            self.assertEqual(bool(chosen.search(name)), is_one, name)


if __name__ == "__main__":
    print("seed", SEED)
    unittest.main()
