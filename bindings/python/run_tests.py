#!/usr/bin/env python3
"""run_tests.py BUILD [SUITE...]: the tests of the Python package against the libraries and programs of a build.

    bindings/python/run_tests.py build/release                 # all but the slow ones: below a minute
    bindings/python/run_tests.py build/release client offline  # tests/test_client.py, tests/test_offline.py
    bindings/python/run_tests.py build/release --list

Suites run side by side, since most of their time is a servo's: KNURL_TEST_JOBS of them (3).
The package is copied, with its _kinds.py, into a folder of its own: the source tree stays as it is.
"""

import concurrent.futures
import os
import shutil
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
TESTS = os.path.join(HERE, "tests")
SLOW = {"wheel"}


def suites():
    """Names of all suites."""
    return sorted(name[5:-3] for name in os.listdir(TESTS) if name.startswith("test_") and name.endswith(".py"))


def copied_package(build, folder):
    """Copies the packages and writes _kinds.py."""
    for package in ("knurl", "lerobot_teleoperator_knurl"):
        shutil.copytree(os.path.join(HERE, package), os.path.join(folder, package),
                        ignore=shutil.ignore_patterns("__pycache__", "_kinds.py", "*.so*"))
    library = os.path.join(build, "runtime", "capi", "libknurl.so.0")
    subprocess.run([sys.executable, os.path.join(HERE, "generate_kinds.py"), library, os.path.join(folder, "knurl", "_kinds.py")],
                   check=True)


def environment(build, folder):
    """What the tests need to find."""
    # Matplotlib says so, where it has nowhere to keep its list of fonts; making the list anew takes seconds.
    home = os.path.expanduser("~")
    fonts = {} if os.access(home, os.W_OK) or "MPLCONFIGDIR" in os.environ else {"MPLCONFIGDIR": folder}
    return dict(
        os.environ,
        **fonts,
        PYTHONPATH=os.pathsep.join([folder, TESTS]),
        PYTHONDONTWRITEBYTECODE="1",
        KNURL_BUILD=build,
        KNURL_LIBRARY_DIR=os.path.join(build, "runtime", "capi"),
        KNURLD=os.path.join(build, "apps", "knurld", "knurld"),
        KNURL_BRIDGE=os.path.join(build, "apps", "knurl-bridge", "knurl-bridge"),
        KNURL_HINTS="0",
        KNURL_RUNTIME_DIR=folder,  # no test may meet a servo of this machine
    )


def run_suite(name, build, folder):
    """(name, exit code, seconds, output) of a suite."""
    began = time.monotonic()
    work = os.path.join(folder, name)
    os.mkdir(work)
    done = subprocess.run([sys.executable, "-m", "unittest", "test_" + name], env=environment(build, folder), cwd=work,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return name, done.returncode, time.monotonic() - began, done.stdout


def run(chosen, build):
    """1: a suite failed."""
    failed = 0
    with tempfile.TemporaryDirectory(prefix="knurl-tests-") as folder:
        copied_package(build, folder)
        with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("KNURL_TEST_JOBS", "3"))) as pool:
            suites_running = [pool.submit(run_suite, name, build, folder) for name in chosen]
            for suite in concurrent.futures.as_completed(suites_running):
                name, code, seconds, output = suite.result()
                print(f"{name:16} {'failed' if code else 'passed'} {seconds:5.1f} s  {summary(output)}", flush=True)
                if code:
                    failed = 1
                    print(output, flush=True)
    return failed


def summary(output):
    """unittest's own: "Ran 12 tests in 3.210s, OK"."""
    lines = [line for line in output.splitlines() if line.strip()]
    return ", ".join(line for line in lines[-2:] if line.startswith(("Ran ", "OK", "FAILED")))


def main():
    words = [word for word in sys.argv[1:] if word != "--list"]
    if "--list" in sys.argv or not words:
        print(__doc__, "\nSuites:", *(name + (" (slow)" if name in SLOW else "") for name in suites()))
        return 0 if "--list" in sys.argv else 2
    build, chosen = os.path.abspath(words[0]), words[1:] or [name for name in suites() if name not in SLOW]
    unknown = [name for name in chosen if name not in suites()]
    if unknown:
        sys.exit(f"run_tests.py: there is no suite {unknown[0]}; there are {', '.join(suites())}")
    # The longest ones first.
    return run(sorted(chosen, key=lambda name: name not in ("stalls", "life", "examples", "learners")), build)


if __name__ == "__main__":
    sys.exit(main())
