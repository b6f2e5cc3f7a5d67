#!/usr/bin/env python3
"""Whether Clang takes the libraries and programs too: clang++-14 -fsyntax-only over what a build compiles, but for the
tests. It instantiates templates and gives its warnings, which are errors; it makes no code.

    scripts/clang_takes.py [--each]
        --each   source by source, not in the batches of the build: also whether each includes what it uses, and whether one of its
                 names hides another

Exit status 1: it takes not all.
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
    """Of one compilation: the flags that matter to Clang, and the source."""
    words = shlex.split(entry["command"])
    words = words[next(i for i, word in enumerate(words) if word.startswith("-")) :]  # after compiler and launcher
    flags, source = [], None
    while words:
        word = words.pop(0)
        if word in ("-o", "-MT", "-MF"):
            words.pop(0)
        elif word == "-c":
            source = words.pop(0)
        elif word not in ("-MD", "-Wno-subobject-linkage"):
            flags.append(word)
    return flags, source


def main(each):
    root = pathlib.Path(__file__).resolve().parent.parent
    with tempfile.TemporaryDirectory() as build, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        configured = subprocess.run(["cmake", "--preset", "release", "-B", build, "-DKNURL_BUILD_TESTS=OFF",
                                     "-DKNURL_BUILD_BENCHMARKS=OFF", f"-DKNURL_BATCHES={'OFF' if each else 'ON'}"],
                                    cwd=root, capture_output=True, text=True)
        if configured.returncode:
            sys.exit(f"clang_takes: cmake cannot configure it:\n{configured.stderr}")
        work = json.loads((pathlib.Path(build) / "compile_commands.json").read_text())

        def check(entry):
            flags, source = flags_of(entry)
            result = subprocess.run([CLANG, *flags, "-fsyntax-only", source], cwd=entry["directory"], capture_output=True, text=True)
            return os.path.relpath(source, build if source.startswith(build) else root), result

        failed = 0
        for name, result in pool.map(check, work):
            if result.returncode:
                failed += 1
                print(f"{name}:\n{result.stderr}", file=sys.stderr)
    print(f"Clang takes {len(work) - failed} of {len(work)} {'sources' if each else 'batches of sources'}")
    return 1 if failed else 0


if __name__ == "__main__":
    if sys.argv[1:] not in ([], ["--each"]):
        sys.exit("usage: scripts/clang_takes.py [--each]")
    sys.exit(main(bool(sys.argv[1:])))
