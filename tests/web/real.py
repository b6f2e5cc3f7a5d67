#!/usr/bin/python3
"""Runs the tests of the page at a real knurl-web, beside a knurld with a simulated hand that can be pulled.

    tests/web/real.py --knurld PROGRAM --knurl-web PROGRAM --client PROGRAM [--node node]

The client is a program that adds a plane. Exit status 77: skipped, one line says what is missing.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent


def first_line_with(pattern, program):
    """Waits for a line of the program's output."""
    said = []
    for line in program.stdout:
        said.append(line)
        found = re.search(pattern, line)
        if found:
            return found.group(0)
    sys.exit("it has ended:\n" + "".join(said))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--knurld", required=True)
    parser.add_argument("--knurl-web", required=True)
    parser.add_argument("--client", required=True)
    parser.add_argument("--node", default="node")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="knurl-web-") as folder:
        hand = os.path.join(folder, "hand")
        os.mkfifo(hand, 0o600)
        environment = os.environ | {"KNURL_RUNTIME_DIR": folder, "KNURL_STATE_DIR": folder, "PYTHONUNBUFFERED": "1"}
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True, "env": environment}
        recordings = os.path.join(folder, "recordings")
        os.mkdir(recordings)
        servo = subprocess.Popen([args.knurld, "--device", f"right=sim:premium15,live={hand}"], **pipes)
        web = None
        try:
            first_line_with("right", servo)
            web = subprocess.Popen([args.knurl_web, "--listen", "127.0.0.1:0", "--no-inverse", "--recordings", recordings], **pipes)
            url = first_line_with(r"http://\S+", web)
            environment |= {"KNURL_WEB_URL": url, "KNURL_WEB_CLIENT": args.client}
            return subprocess.run([args.node, HERE / "run.mjs", "page"], env=environment, check=False).returncode
        finally:
            for program in (web, servo):
                if program:
                    program.terminate()
                    program.wait()


if __name__ == "__main__":
    sys.exit(main())
