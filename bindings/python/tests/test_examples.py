"""Every example runs, on a simulated hand, and the hand felt something."""

import glob
import importlib.util
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

from support import EXAMPLES, PRESS, Bridge, ServoCase, until

import knurl


class Examples(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def printed(self, name, *words):
        done = subprocess.run([sys.executable, os.path.join(EXAMPLES, name), *words], cwd=self.folder, text=True, timeout=120,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        return done.stdout

    def simulated(self, name, seconds, *words):
        return self.printed(name, "--simulated", "--seconds", str(seconds), *words)

    def test_all_are_run_here(self):
        with open(__file__, encoding="utf-8") as file:
            text = file.read()
        for path in glob.glob(os.path.join(EXAMPLES, "[0-9]*")):
            self.assertIn(os.path.basename(path), text)

    def test_02_what_the_hand_did(self):
        said = self.simulated("02_what_the_hand_did.py", 1.6)
        cycles, missed, force = re.search(r"(\d+) cycles, (\d+) missed, largest force ([\d.]+) N", said).groups()
        self.assertGreater(int(cycles), 1200)
        self.assertGreater(float(force), 0.3)
        self.assertTrue(os.path.exists(os.path.join(self.folder, "hand.csv")))

    def test_03_terrain(self):
        said = self.simulated("03_terrain.py", 2)
        self.assertIn("0.0 to 10.0 mm high", said)
        self.assertRegex(said, r"[1-9]\.\d\d N|0\.[1-9]\d N")

    def test_04_moving_mesh(self):
        self.assertRegex(self.simulated("04_moving_mesh.py", 2), r"turned by 5\d degrees; the cube pushed with \[.* [0-9.]*[1-9][0-9.]*\]")

    def test_05_body(self):
        said = self.simulated("05_body.py", 2)
        self.assertGreater(float(re.search(r"([-\d.]+)\) mm", said).group(1)), 10)  # it was lifted

    def test_06_two_hands(self):
        felt = re.search(r"left feels ([\d.]+) N, right feels ([\d.]+) N", self.simulated("06_two_hands.py", 1.8)).groups()
        self.assertGreater(float(felt[0]), 0.05)
        self.assertAlmostEqual(float(felt[0]), float(felt[1]), delta=0.5)

    def test_08_experiment(self):
        said = self.simulated("08_experiment.py", 60, "--trials", "4", "--touch", "0.3")
        self.assertIn("just noticeable", said)
        with open(os.path.join(self.folder, "experiment.tsv"), encoding="ascii") as file:
            head, *rows = [line.rstrip("\n").split("\t") for line in file]
        self.assertEqual(len(rows), 4)
        errors = []
        for row in rows:
            values = dict(zip(head, map(float, row)))
            self.assertGreater(values["end_ns"] - values["start_ns"], 0.55e9)
            harder = values["felt_first"] if values["first_is_harder"] else values["felt_second"]
            errors.append(abs(harder - 500 - values["difference_N_per_m"]))
        # One of four may be spoilt: where the machine holds up the servo its force begins anew.
        self.assertLess(sorted(errors)[2], 50, errors)

    def executed(self, notebook):
        """What the cells of a notebook print, run by nbconvert in a kernel of its own."""
        ran = subprocess.run([sys.executable, "-m", "nbconvert", "--execute", "--to", "notebook", "--output-dir", self.folder, notebook],
                             timeout=100, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(ran.returncode, 0, ran.stdout)
        with open(os.path.join(self.folder, os.path.basename(notebook)), encoding="utf-8") as file:
            outputs = [output for cell in json.load(file)["cells"] for output in cell.get("outputs", ())]
        self.assertIn("image/png", [kind for output in outputs for kind in output.get("data", ())], "the plot is shown")
        return "\n".join("".join(output.get("text", output.get("data", {}).get("text/plain", ""))) for output in outputs)

    def test_09_notebook(self):
        path = os.path.join(EXAMPLES, "09_notebook.ipynb")
        there = all(importlib.util.find_spec(name) for name in ("nbconvert", "ipykernel"))
        said = self.executed(path) if there else self.printed("run_notebook.py", path)
        self.assertRegex(said, r"3\d\d\d cycles, 0 missed")

    def test_10_learning(self):
        self.assertRegex(self.printed("10_learning.py", "--episodes", "3"), r"the force is off by 0\.0\d\d N")


class WithAServo(ServoCase):
    """The examples that are written for a servo that runs already."""

    HAND = PRESS

    @classmethod
    def setUpClass(cls):
        cls.servo = knurl.simulated(hand=PRESS, name="default")
        cls.addClassCleanup(cls.servo.close)

    def test_01_wall(self):
        """Ctrl-C ends it; the hand was held before, and is free afterwards."""
        with open(os.path.join(EXAMPLES, "01_wall.py"), encoding="utf-8") as file:
            lines = [line for line in file.read().splitlines()[1:] if line and "import" not in line]
        self.assertEqual(len(lines), 5)  # and a line of imports: six
        program = subprocess.Popen([sys.executable, os.path.join(EXAMPLES, "01_wall.py")], env=self.servo.environment, stderr=subprocess.PIPE, text=True)
        with self.connected().observe() as observer:
            until(observer, lambda report: report.state == 4 and report.sent_force[2] > 1, 30000)
        program.send_signal(signal.SIGINT)
        self.assertTrue(program.communicate(timeout=30)[1].endswith("KeyboardInterrupt\n"))
        self.claimed().close()

    def test_07_remote(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        bridge = Bridge(self.servo, folder, with_key=True)
        self.addCleanup(bridge.close)
        said = subprocess.run([sys.executable, os.path.join(EXAMPLES, "07_remote.py"), "--servo", bridge.address, "--key", bridge.key_file,
                               "--seconds", "1"], text=True, stdout=subprocess.PIPE, timeout=60, check=True).stdout
        self.assertIn("encrypted: True", said)


if __name__ == "__main__":
    unittest.main()
