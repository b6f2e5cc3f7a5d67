#!/usr/bin/python3
"""Is docs/reference/ what the code says?

    reference.py KNURL_REFERENCE SCRATCH

Prints the pages anew and compares them with those that are committed. Then the environment: each variable that a source
reads is in programs.md, and the other way round.
"""

import difflib
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
READS = re.compile(r'(?:\b(?:getenv|environment|variable)\(|\.variable = )"([A-Z][A-Z_]+)"')


def differences(printed, committed):
    for page in sorted(printed.glob("*.md")):
        old = committed / page.name
        before = old.read_text().splitlines() if old.exists() else []
        lines = list(difflib.unified_diff(before, page.read_text().splitlines(), f"docs/reference/{page.name}", "the code", "", "", 0))
        if lines:
            yield "\n".join(lines)


def variables_read():
    return {name for folder in ("apps", "drivers", "reps", "runtime", "shm") for kind in ("*.cpp", "*.hpp")
            for path in (ROOT / folder).rglob(kind) for name in READS.findall(path.read_text())}


def variables_documented(page):
    section = page.read_text().split("## Environment variables", 1)[1].split("\n## ", 1)[0]
    return set(re.findall(r"^\| `([A-Z_]+)` \|", section, re.M))


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    printed, committed = Path(sys.argv[2]), ROOT / "docs" / "reference"
    subprocess.run([sys.argv[1], printed], check=True)
    mistakes = list(differences(printed, committed))
    if mistakes:
        mistakes.append("print them anew: scripts/reference")
    read, documented = variables_read(), variables_documented(printed / "programs.md")
    mistakes += [f"{name} is read by the code and is not in programs.md (apps/reference/main.cpp)" for name in sorted(read - documented)]
    mistakes += [f"{name} is in programs.md, and nothing reads it" for name in sorted(documented - read)]
    print("\n".join(mistakes) if mistakes else f"{len(list(printed.glob('*.md')))} pages, {len(read)} variables: as the code says")
    sys.exit(1 if mistakes else 0)


main()
