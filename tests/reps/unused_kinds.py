#!/usr/bin/env python3
"""Kinds that nobody uses cost nothing: the same scene takes the same number of instructions in Scene::evaluate in a
build with all kinds and in one with only those that it uses. Usage: unused_kinds.py PROGRAM_WITH_ALL PROGRAM_WITH_FEW"""

import os
import re
import shutil
import subprocess
import sys
import tempfile


def instructions(program, cycles):
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            ["valgrind", "--tool=callgrind", "--toggle-collect=knurl::Scene::evaluate*",
             f"--callgrind-out-file={os.path.join(folder, 'out')}", program, str(cycles)],
            capture_output=True, text=True, check=True)
    found = re.search(r"Collected : (\d+)", run.stderr)
    if not found:
        sys.exit(f"callgrind said nothing about {program}:\n{run.stderr}")
    return int(found[1]), run.stdout.strip()


def per_thousand(program):
    """Of cycles in which nothing is added: 2000 less 1000."""
    (few, _), (many, said) = instructions(program, 1000), instructions(program, 2000)
    print(f"{said}: {many - few} instructions in 1000 cycles")
    return many - few


if not shutil.which("valgrind"):
    sys.exit("valgrind is not installed: apt install valgrind")
every, few = per_thousand(sys.argv[1]), per_thousand(sys.argv[2])
if every == 0 or every != few:
    sys.exit(f"kinds that this scene does not use cost {every - few} instructions in 1000 cycles; they must cost none")
