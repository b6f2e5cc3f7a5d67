#!/usr/bin/env python3
"""What it costs that somebody watches the scenes, counted: instructions of Servo::step with a watcher and without, in
contact with a plane that changes 20 times a second. Usage: watched_cycles.py PROGRAM"""

import os
import re
import shutil
import subprocess
import sys
import tempfile

GOAL = 1.0  # percent


def instructions(program, mode, cycles):
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            ["valgrind", "--tool=callgrind", "--toggle-collect=knurl::servo::Servo::step*",
             f"--callgrind-out-file={os.path.join(folder, 'out')}", program, mode, str(cycles)],
            capture_output=True, text=True, check=True)
    found = re.search(r"Collected : (\d+)", run.stderr)
    if not found:
        sys.exit(f"callgrind said nothing about {program}:\n{run.stderr}")
    return int(found[1])


if not shutil.which("valgrind"):
    sys.exit("valgrind is not installed: apt install valgrind")
# What the first cycles do (a watcher is shown everything) is not counted: 4000 less 2000.
plain, watched = (instructions(sys.argv[1], mode, 4000) - instructions(sys.argv[1], mode, 2000)
                  for mode in ("plain", "watched"))
more = 100 * (watched / plain - 1)
print(f"{plain / 2000:.0f} instructions a cycle, {watched / 2000:.0f} while somebody watches: {more:.2f} % more")
if plain == 0 or watched <= plain:
    sys.exit("nothing was shown: this test measures nothing")
if more > GOAL:
    sys.exit(f"watching costs {more:.2f} % of a cycle; at most {GOAL} %")
