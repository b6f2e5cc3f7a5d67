"""python3 -m knurl [--profile premium15] [--push N] [--hand motion.csv] COMMAND...

Runs a command with a simulated servo of its own, which knurl.connect() and knurl's programs find as "default":

    python3 -m knurl python3 examples/01_wall.py
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from typing import Any, Dict

from ._errors import Error
from ._simulated import simulated


def main() -> int:
    """Exit code of the command; 2: no servo could be started."""
    parser = argparse.ArgumentParser(prog="python3 -m knurl", description="Runs a command with a simulated servo of its own.")
    parser.add_argument("--profile", default="premium15", help="simulated device (premium15)")
    parser.add_argument("--push", type=float, help="force with which the simulated hand presses along -z (N)")
    parser.add_argument("--hand", help="how the simulated hand moves: CSV t,x,y,z (s, m)")
    parser.add_argument("command", nargs=argparse.REMAINDER, metavar="COMMAND")
    arguments = parser.parse_args()
    if not arguments.command:
        parser.error("a command is needed")
    options: Dict[str, Any] = {} if arguments.push is None else {"push": arguments.push}
    try:
        with simulated(arguments.profile, hand=arguments.hand, name="default", **options) as servo:
            return subprocess.call(arguments.command, env=servo.environment)
    except KeyboardInterrupt:
        return 130
    except Error as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
