#!/usr/bin/env python3
"""What the hand does not feel costs next to nothing, of any kind: so many instructions a cycle more than in a scene with
nothing in it. Usage: far_kinds.py PROGRAM"""

import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile

CYCLES = 100
# Felt wherever the hand is: by how they are meant, or since nothing bounds where they act (taylor's edge `fade` does).
FELT = {"constant_force far", "spring far", "constraint far"}


def counts(program, n):
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            ["valgrind", "--tool=callgrind", "--toggle-collect=counted_cycles", "--dump-after=counted_cycles",
             f"--callgrind-out-file={os.path.join(folder, 'out')}", program, str(n)],
            capture_output=True, text=True, check=True)
        parts = sorted(glob.glob(os.path.join(folder, "out.*[0-9]")), key=lambda name: int(name.rsplit(".", 1)[1]))
        totals = [int(re.search(r"^(?:totals|summary): (\d+)", open(part).read(), re.M)[1]) for part in parts]
    names = run.stdout.split("\n")[:-1]
    if len(totals) < len(names):
        sys.exit(f"callgrind counted {len(totals)} of {len(names)}:\n{run.stderr}")
    return {name.strip(): total / CYCLES for name, total in zip(names, totals)}


if not shutil.which("valgrind"):
    sys.exit("valgrind is not installed: apt install valgrind")
bad = []
for n in (100, 1000):
    found = counts(sys.argv[1], n)
    none = found.pop("none")
    print(f"{n} of each; none: {none:.0f} instructions a cycle")
    for name, total in found.items():
        above = total - none
        most = 150 + 0.5 * n
        print(f"  {name}: {above:+.0f}")
        if name not in FELT and above > most:
            bad.append(f"{n} of {name}: {above:.0f} instructions a cycle, at most {most:.0f}")
if bad:
    sys.exit("\n".join(bad))
