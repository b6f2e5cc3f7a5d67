"""The wheel: what is in it, and the first example from it, in a fresh environment without a compiler or a library's path."""

import glob
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import venv
import zipfile

from support import EXAMPLES, PACKAGE

PROGRAM = """
import runpy, signal, sys, threading
import ssl  # Python's own libcrypto and the wheel's do not meet
import knurl
assert knurl.__file__.startswith(sys.prefix), knurl.__file__
maps = open("/proc/self/maps").read()
assert sys.prefix in maps and "knlcrypto" in maps, maps
assert ssl.OPENSSL_VERSION
knurl.Offline().add(knurl.Plane(stiffness=1))

with knurl.simulated(hand=[(0, 0, 0, 0.01), (0.6, 0, 0, 0.01), (0.8, 0, 0, -0.004), (1e5, 0, 0, -0.004)]) as servo:
    with servo.connect() as client, client.observe() as observer:
        knurl.connect = servo.connect  # the example connects to "default"

        def watch():
            for report in observer.reports():
                if report.sent_force[2] > 1:
                    signal.raise_signal(signal.SIGINT)
                    return

        threading.Thread(target=watch, daemon=True).start()
        try:
            runpy.run_path(sys.argv[1])
        except KeyboardInterrupt:
            print("felt")
"""


class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        subprocess.run([sys.executable, os.path.join(PACKAGE, "build_wheel.py"), os.environ["KNURL_BUILD"], cls.folder], check=True,
                       stdout=subprocess.DEVNULL)
        (cls.wheel,) = glob.glob(os.path.join(cls.folder, "knurl-*-py3-none-linux_*.whl"))

    def test_the_record(self):
        with zipfile.ZipFile(self.wheel) as archive:
            names = archive.namelist()
            (record,) = [name for name in names if name.endswith(".dist-info/RECORD")]
            rows = [line.split(",") for line in archive.read(record).decode().splitlines()]
            self.assertEqual([row[0] for row in rows], names)
            self.assertEqual(int(rows[0][2]), len(archive.read(rows[0][0])))
            self.assertTrue(rows[0][1].startswith("sha256="))
            self.assertIn("knurl/_kinds.py", names)
            self.assertIn("knurl/py.typed", names)
            self.assertFalse([name for name in names if "libstdc" in name or "libc.so" in name])

    def test_the_same_again(self):
        again = os.path.join(self.folder, "again")
        subprocess.run([sys.executable, os.path.join(PACKAGE, "build_wheel.py"), os.environ["KNURL_BUILD"], again], check=True, stdout=subprocess.DEVNULL)
        digests = []
        for path in (self.wheel, os.path.join(again, os.path.basename(self.wheel))):
            with open(path, "rb") as file:
                digests.append(hashlib.sha256(file.read()).hexdigest())
        self.assertEqual(*digests)

    def test_a_fresh_environment(self):
        place = os.path.join(self.folder, "venv")
        # NumPy is the system's: nothing is downloaded.
        venv.EnvBuilder(system_site_packages=True, with_pip=True).create(place)
        python = os.path.join(place, "bin", "python")
        clean = {"PATH": "/usr/bin:/bin", "HOME": self.folder}
        subprocess.run([python, "-m", "pip", "install", "--no-index", "--no-deps", "--quiet", "--disable-pip-version-check", self.wheel],
                       check=True, env=clean)
        done = subprocess.run([python, "-c", PROGRAM, os.path.join(EXAMPLES, "01_wall.py")], env=clean, cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120)
        self.assertEqual((done.stdout, done.returncode), ("felt\n", 0), done.stderr)
        typed = subprocess.run([python, "-m", "mypy", "--strict", "-c", "import knurl; knurl.connect().claim().arm()"], env=clean,
                               cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if "No module named mypy" not in typed.stdout:
            self.assertIn("Success", typed.stdout)
        subprocess.run([python, "-m", "pip", "uninstall", "--yes", "--quiet", "knurl"], check=True, env=clean)
        self.assertFalse(glob.glob(os.path.join(place, "lib", "python*", "site-packages", "knurl*")))


if __name__ == "__main__":
    unittest.main()
