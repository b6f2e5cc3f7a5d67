#!/usr/bin/python3
"""Does bash complete each verb and each option that --help names? The words of --help are read here by other means.

    completions.py PROGRAM...

bash is given a line and asked for what may follow, as it asks itself. zsh's file is looked through for the same words, and
its syntax checked where zsh is installed.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "help_pages.py"


def help_of(program, words):
    return subprocess.run([program, *words, "--help"], check=True, capture_output=True, text=True).stdout


def named(text):
    """The verbs and the long options, by nothing but where they stand."""
    after = text.split("Subcommands:\n", 1)
    verbs = [line.split()[0] for line in after[1].split("\n\n")[0].splitlines() if line.startswith("  ") and line[2] != " "] if after[1:] else []
    options = re.findall(r"^ {2,6}(?:-\w,)?(--[a-z][a-z-]*)", text, re.M)
    return verbs, options


def completed(script, program, words, now):
    """What bash offers after `program words now`."""
    line = " ".join(f"'{word}'" for word in [program.name, *words, now])
    ask = f"source {script}; COMP_WORDS=({line}); COMP_CWORD={len(words) + 1}; _{re.sub(r'[^a-z]', '_', program.name)}; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    return subprocess.run(["bash", "-c", ask], check=True, capture_output=True, text=True).stdout.split()


def mistakes_of(program, words, bash, zsh):
    verbs, options = named(help_of(program, words))
    for word in verbs:
        if word not in completed(bash, program, words, word[:2]):
            yield f"{program.name} {' '.join(words)}: bash does not complete the verb {word}"
    for word in options:
        if word not in completed(bash, program, words, "--"):
            yield f"{program.name} {' '.join(words)}: bash does not complete {word}"
    for word in verbs + options:
        if word not in zsh:
            yield f"{program.name} {' '.join(words)}: zsh does not know {word}"
    if "--help" not in options:
        yield f"{program.name} {' '.join(words)}: no options were found in its --help"
    for verb in verbs:
        yield from mistakes_of(program, [*words, verb], bash, zsh)


def main():
    mistakes = []
    with tempfile.TemporaryDirectory(prefix="knurl-completions-") as scratch:
        subprocess.run([SCRIPT, "completions", scratch, *sys.argv[1:]], check=True)
        for program in map(Path, sys.argv[1:]):
            bash, zsh = Path(scratch) / "bash" / program.name, Path(scratch) / "zsh" / f"_{program.name}"
            mistakes += mistakes_of(program, [], bash, zsh.read_text())
            if shutil.which("zsh"):
                subprocess.run(["zsh", "-n", zsh], check=True)
        # A choice of words is completed after its option.
        knurl = next((Path(word) for word in sys.argv[1:] if Path(word).name == "knurl"), None)
        if knurl and completed(Path(scratch) / "bash" / "knurl", knurl, ["trace", "--around"], "l") != ["last", "late"]:
            mistakes.append("knurl trace --around: the choices are not completed")
    print("\n".join(mistakes) if mistakes else "every verb and option is completed")
    sys.exit(1 if mistakes else 0)


main()
