"""The packages are typed: mypy --strict, where there is mypy; and what a program of a user gets."""

import importlib.util
import os
import re
import subprocess
import sys
import tempfile
import unittest

from support import PACKAGE

import knurl

PROGRAM = """
import numpy as np
import knurl

with knurl.connect() as client, client.claim() as hand:
    floor = hand.add(knurl.Plane(normal=(0, 0, 1), offset=0.005, stiffness=800))
    reveal_type(floor)
    for report in hand.reports(rate=60):
        floor.offset = 0.005 + 0.002 * np.sin(report.time)
        floor.normal = np.array((0, 0, 1))
        reveal_type(report)
    for one in hand.reports():
        reveal_type(one)
    reveal_type(knurl.Box.made_of("rubber"))
    floor.update = "slowly"
    floor.ofset = 1
"""


@unittest.skipUnless(importlib.util.find_spec("mypy"), "mypy is not installed")
class Types(unittest.TestCase):
    def mypy(self, *words):
        with tempfile.TemporaryDirectory() as cache:
            done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--config-file", os.path.join(PACKAGE, "pyproject.toml"),
                                   "--python-version", "3.9", "--cache-dir", cache, *words],
                                  text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  cwd=os.path.dirname(os.path.dirname(knurl.__file__)))
        return done.stdout

    def test_strict(self):
        self.assertRegex(self.mypy("knurl", "lerobot_teleoperator_knurl"), "^Success: no issues found")

    def test_a_program_of_a_user(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "program.py")
            with open(path, "w", encoding="utf-8") as file:
                file.write(PROGRAM)
            said = self.mypy(path)
        self.assertEqual(re.findall(r'Revealed type is "(.*)"', said),
                         ["knurl._kinds.Plane", "knurl._reports.Frame", "knurl._reports.Report", "knurl._kinds.Box"])
        errors = re.findall(r"error: (.*)", said)
        self.assertEqual(len(errors), 2, said)
        self.assertIn("Literal['fade', 'paper', 'last_depth']", errors[0])
        self.assertIn('"Plane" has no attribute "ofset"', errors[1])


if __name__ == "__main__":
    unittest.main()
