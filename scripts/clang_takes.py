#!/usr/bin/env python3
"""Whether Clang takes the libraries and programs too: clang++-14 -fsyntax-only over what build/release compiles, but for the
tests. It instantiates templates and gives its warnings, which are errors; it makes no code.

    scripts/clang_takes.py [BUILD]        build/release, configured

A target's precompiled headers are read once for all of its sources, as in the build. Exit status 1: it takes not all.
"""

import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile

CLANG = "clang++-14"


def flags_of(entry):
    """Of one compilation: the flags that matter to Clang, the header that is precompiled (or None), the source."""
    words = shlex.split(entry["command"])
    words = words[next(i for i, word in enumerate(words) if word.startswith("-")) :]  # after compiler and launcher
    flags, header, source = [], None, None
    i = 0
    while i < len(words):
        word = words[i]
        if word in ("-o", "-MT", "-MF"):
            i += 1
        elif word == "-include":
            i += 1
            header = words[i]
        elif word == "-c":
            i += 1
            source = words[i]
        elif word in ("-MD", "-Winvalid-pch"):
            pass
        else:
            flags.append(word)
        i += 1
    return tuple(flags), header, source


def clang(folder, *words):
    return subprocess.run([CLANG, *words], cwd=folder, capture_output=True, text=True)


def main(build):
    entries = json.loads((pathlib.Path(build) / "compile_commands.json").read_text())
    root = pathlib.Path(__file__).resolve().parent.parent
    work = []
    for entry in entries:
        name = os.path.relpath(entry["file"], root)
        if not name.startswith(("tests/", "build/")):
            work.append((entry["directory"], name, *flags_of(entry)))
    if not work:
        sys.exit(f"clang_takes: no libraries and programs in {build}/compile_commands.json; configure it first")
    failed = 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        wanted = sorted({(directory, flags, header) for directory, _, flags, header, _ in work if header})
        names = {key: os.path.join(folder, f"{i}.pch") for i, key in enumerate(wanted)}

        def precompile(key):
            directory, flags, header = key
            return clang(directory, *flags, "-fpch-instantiate-templates",
                         "-Wno-pragma-system-header-outside-header", "-x", "c++-header", header, "-o", names[key])

        def check(one):
            directory, name, flags, header, source = one
            before = ["-include-pch", names[directory, flags, header]] if header else []
            return name, clang(directory, *flags, "-fsyntax-only", *before, source)

        for result in pool.map(precompile, wanted):
            if result.returncode:
                sys.exit(f"clang_takes: no precompiled headers:\n{result.stderr}")
        for name, result in pool.map(check, work):
            if result.returncode:
                failed += 1
                print(f"{name}:\n{result.stderr}", file=sys.stderr)
    print(f"Clang takes {len(work) - failed} of {len(work)} sources")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:2] or ["build/release"]))
