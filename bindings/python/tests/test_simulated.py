"""A servo of one's own: profiles, several devices, what cannot be started."""

import os
import subprocess
import sys
import unittest
from unittest import mock

from support import run_python

import knurl


class Simulated(unittest.TestCase):
    def test_profile_rate_and_options(self):
        with knurl.simulated("cartesian3", rate=2000, name="lab", grip=0.5, seed=3) as servo:
            with servo.connect() as client:
                (device,) = client.devices()
            self.assertEqual((device.rate, device.profile, servo.name), (2000.0, "cartesian3", "lab"))
            self.assertIn("grip=0.5", device.address)
            folder = os.path.dirname(servo.address)
        self.assertFalse(os.path.exists(folder))
        servo.close()

    def test_two_hands_move_by_themselves(self):
        motion = {"left": [(0, 0.02, 0, 0), (1, 0.02, 0, 0)], "right": [(0, -0.02, 0, 0), (1, -0.02, 0, 0)]}
        with knurl.simulated({"left": "premium15", "right": "falcon"}, hand=motion) as servo, servo.connect() as client:
            self.assertEqual([device.name for device in client.devices()], ["left", "right"])
            with client.claim("left") as left, client.claim("right") as right:
                self.assertAlmostEqual(left.newest(10).position[0], 0.02, delta=0.005)
                self.assertAlmostEqual(right.newest(10).position[0], -0.02, delta=0.005)

    def test_a_program_that_forgets_it_leaves_nothing(self):
        done = run_python("import knurl; servo = knurl.simulated(); print(servo.pid, servo.address)")
        pid, address = done.stdout.split()
        self.assertEqual(done.stderr, "")
        self.assertFalse(os.path.exists(f"/proc/{pid}") or os.path.exists(os.path.dirname(address)))

    def test_a_fork_s_child_leaves_it_alone(self):
        code = """if True:
            import gc, os, sys, knurl
            servo = knurl.simulated()
            if os.fork() == 0:
                del servo
                gc.collect()
                sys.exit()
            os.wait()
            with servo.connect() as client:
                print(len(client.devices()))"""
        self.assertEqual(run_python(code).stdout, "1\n")

    def test_two_servos_do_not_meet(self):
        with knurl.simulated() as first, knurl.simulated() as second:
            self.assertNotEqual(first.address, second.address)
            self.assertNotEqual(first.pid, second.pid)

    def test_the_environment_stays(self):
        before = dict(os.environ)
        with knurl.simulated():
            self.assertEqual(dict(os.environ), before)

    def test_what_cannot_be_started(self):
        for profile, options, words in (
            ("nonsense", {}, "did not start: .*nonsense"),
            ("premium15", dict(grip=-1), "did not start: .*grip"),
        ):
            with self.assertRaisesRegex(knurl.NoServo, words):
                knurl.simulated(profile, **options)
        with self.assertRaisesRegex(knurl.BadParameters, "rows of t, x, y, z"):
            knurl.simulated(hand=[(0, 0, 0)])
        with mock.patch.dict(os.environ, KNURLD="/nowhere/knurld"), self.assertRaisesRegex(knurl.NoServo, "/nowhere/knurld did not start"):
            knurl.simulated()
        with mock.patch.dict(os.environ, PATH="/nowhere"):
            del os.environ["KNURLD"]
            with self.assertRaisesRegex(knurl.NoServo, "knurld is not in the PATH; install Knurl, or set KNURLD"):
                knurl.simulated()

    def test_a_command_with_a_servo(self):
        code = "import knurl; client = knurl.connect(); print(client.devices()[0].address)"
        done = subprocess.run([sys.executable, "-m", "knurl", "--profile", "falcon", "--push", "1", sys.executable, "-c", code],
                              text=True, stdout=subprocess.PIPE, timeout=60)
        self.assertEqual((done.returncode, done.stdout), (0, "sim:falcon,push=1.0\n"))
        failed = subprocess.run([sys.executable, "-m", "knurl", "--profile", "nonsense", "true"], text=True, stderr=subprocess.PIPE, timeout=60)
        self.assertEqual((failed.returncode, failed.stderr.count("\n")), (2, 1))


if __name__ == "__main__":
    unittest.main()
