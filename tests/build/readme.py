#!/usr/bin/python3
"""The code blocks of every README, and the example at the head of client.hpp: taken from there to be compiled and run.

    readme.py extract FOLDER                  ends with 0; writes the blocks there: NAME.inc, NAME.toml, ..., and whole programs
    readme.py run FOLDER PROGRAMS...          runs the blocks that are commands or files; PROGRAMS are folders of programs

What a fence says decides what becomes of its block; what says nothing is a mistake, so that no block is skipped silently:

    ```text                                   a drawing, or what a program printed: no code
    ```cpp with a main()                      a program: built with the installed Knurl and run beside a servo (install.cmake)
    ```sh                                     its programs, scripts and options must be there
    <!-- example: NAME --> above any other    readme/*.cpp that includes "NAME.inc", or readme/NAME.sh with $BLOCK, or
                                              install.cmake takes it and says around it what the text takes for granted
"""

import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TAKERS = Path(__file__).resolve().parent / "readme"
HEAD = "runtime/client/include/knurl/client/client.hpp"
NOT_OURS = {"cd", "mkdir", "export", "cmake", "cpack", "apt", "systemctl", "gmx", "npm", "ctest", "git", "cp", "install", "chown", "g++", "python3",
            "head", "ls", "setcap", "cpupower", "usermod"}


class Block:
    def __init__(self, file, line, language, name, text):
        self.where, self.language, self.name, self.text = f"{file}:{line}", language, name, text


def fences(path):
    """Of each fenced block in a file of Markdown: its line, its language, the last line with words above it, its text."""
    fence, above, text = None, "", []
    for number, line in enumerate((ROOT / path).read_text().splitlines(), 1):
        edge = re.match(r"\s*(```+)\s*(\S*)\s*$", line)
        if fence is None and edge:
            fence, text = (number, edge[2]), []
        elif fence is not None and edge and not edge[2]:
            yield fence[0], fence[1], above, "".join(f"{each}\n" for each in text)
            fence, above = None, ""
        elif fence is not None:
            text.append(line)
        elif line.strip():
            above = line


def blocks():
    found = []
    for file in sorted(ROOT.rglob("README.md")):
        path = file.relative_to(ROOT)
        if {"build", "out", "docs"} & set(path.parts[:1]) or "node_modules" in path.parts:  # docs: pages.py
            continue
        for line, language, above, text in fences(path):
            mark = re.match(r"\s*<!-- example: (\w+) -->\s*$", above)
            found.append(Block(path, line, language, mark[1] if mark else "", text))
    text, first = [], 0
    for number, line in enumerate((ROOT / HEAD).read_text().splitlines(), 1):
        if text and not line.startswith("///     "):
            break
        if line.startswith("///     "):
            first = first or number
            text.append(line[8:])
    found.append(Block(HEAD, first - 1, "cpp", "client_head", "\n".join(text) + "\n"))
    return found


def takers():
    """Which names somebody takes: the including sources, the scripts, and what install.cmake names."""
    names = {script.stem for script in TAKERS.glob("*.sh")}
    for source in TAKERS.glob("*.cpp"):
        names |= set(re.findall(r'#include "(\w+)\.inc"', source.read_text()))
    return names | set(re.findall(r"\$\{README\}/(\w+)\.cmake", (TAKERS.parent / "install.cmake").read_text()))


def problem(block, taken):
    if block.language == "text":
        return f"{block.name} marks a block that is no code" if block.name else ""
    if block.name:
        return "" if block.name in taken else f"nothing in tests/build takes the example {block.name}"
    if block.language == "cpp" and re.search(r"\bint main\(", block.text) or block.language == "sh":
        return ""
    if not block.language:
        return "a fence that does not say what is in it: ```text for what is no code, else ```cpp, ```sh, ..."
    return f"nobody tries this {block.language}: name it by <!-- example: NAME --> above, and have tests/build/readme take it"


def write(path, text):
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def extract(folder):
    folder.mkdir(parents=True, exist_ok=True)
    found, taken, mistakes, kept = blocks(), takers(), [], set()
    names = [block.name for block in found if block.name]
    for block in found:
        if why := problem(block, taken):
            mistakes.append(f"{block.where}: {why}")
        elif names.count(block.name) > 1:
            mistakes.append(f"{block.where}: the example {block.name} is there twice")
        elif block.language != "text" and (block.name or block.language == "cpp"):
            suffix = "inc" if block.language == "cpp" else block.language
            name = f"{block.name}.{suffix}" if block.name else f"program_{block.where.replace('/', '_').replace(':', '_')}.cpp"
            lines = block.text if suffix != "inc" else f'#line {int(block.where.split(":")[1]) + 1} "{block.where.split(":")[0]}"\n{block.text}'
            write(folder / name, lines)
            kept.add(name)
    mistakes += [f"tests/build: the example {name} is in no README" for name in sorted(taken - set(names))]
    for file in folder.iterdir():
        if file.name not in kept:
            file.unlink()
    return mistakes


def known_options(words, programs):
    """The text in which the options of the command must stand; None if there is no such program."""
    program = words[0]
    if program.startswith("scripts/"):
        script = ROOT / program
        if not os.access(script, os.X_OK):
            return None
        text = script.read_text()
        passed_on = re.findall(r"options of (knurl[\w-]*)", text)
        return text + "".join(known_options([other], programs) or "" for other in passed_on)
    for folder in programs:
        if os.access(folder / program, os.X_OK) and (folder / program).is_file():
            verbs = [word for word in words[1:3] if re.fullmatch(r"[a-z]+", word)] if program in ("knurl", "knurl-bridge") else []
            for n in range(len(verbs), -1, -1):
                asked = subprocess.run([folder / program, *verbs[:n], "--help"], capture_output=True, text=True)
                if asked.returncode == 0:
                    return asked.stdout
            return None
    # Tests and benchmarks need not be built: their text is the target and the sources beside it.
    name = os.path.basename(program)
    fuzzer = re.fullmatch("knurl_fuzz_(.*)", name)
    wanted = rf"\w*fuzz\w*\({fuzzer[1]}" if fuzzer else re.escape(name)
    for lists in ROOT.rglob("CMakeLists.txt"):
        if lists.relative_to(ROOT).parts[0] not in ("build", "out") and re.search(rf"\b{wanted}\b", lists.read_text()):
            if name.startswith("knurl") or name[:2].isdigit():
                return "".join(file.read_text() for file in lists.parent.rglob("*.?pp")) + "--benchmark_ -max_total_time"
    return None


def wrong_words(text, programs):
    for line in text.replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        commands = [[]]
        for word in words:
            if word in ("&&", "||", "|", ";", "&"):
                commands.append([])
            else:
                commands[-1].append(word.rstrip(";"))
        for command in commands:
            while command and (command[0] == "sudo" or re.match(r"\w+=", command[0])):
                command = command[1:]
            if not command or command[0] in NOT_OURS:
                continue
            options = known_options(command, programs)
            if options is None:
                yield f"there is no program {' '.join(command[:2])}"
                continue
            for option in (word.split("=")[0] for word in command[1:] if re.match(r"--?[a-z]", word)):
                if option not in options:
                    yield f"{command[0]} has no option {option}"


def run(folder, programs):
    mistakes = extract(folder)
    environment = dict(os.environ, PATH=":".join(map(str, programs)) + ":" + os.environ["PATH"], REPOSITORY=str(ROOT))
    for block in blocks():
        if block.language == "sh" and not block.name:
            mistakes += [f"{block.where}: {why}" for why in wrong_words(block.text, programs)]
        script = TAKERS / f"{block.name}.sh"
        if not block.name or not script.exists():
            continue
        with tempfile.TemporaryDirectory(prefix="knurl-readme-") as scratch:
            environment |= {"BLOCK": str(folder / f"{block.name}.{block.language}"), "KNURL_RUNTIME_DIR": scratch,
                            "KNURL_STATE_DIR": f"{scratch}/state", "HOME": scratch}
            ran = subprocess.run(["bash", "-euo", "pipefail", script], cwd=scratch, env=environment, text=True,
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=100)
            print(f"{'ok  ' if ran.returncode == 0 else 'FAIL'} {block.where} by {script.name}")
            if ran.returncode != 0:
                mistakes.append(f"{block.where}: {script.name} ended with {ran.returncode}:\n{ran.stdout}")
    return mistakes


def main():
    if len(sys.argv) < 3 or sys.argv[1] not in ("extract", "run"):
        sys.exit(__doc__)
    folder = Path(sys.argv[2]).resolve()
    programs = [Path(word) for word in sys.argv[3:]]
    mistakes = extract(folder) if sys.argv[1] == "extract" else run(folder, programs)
    for mistake in mistakes:
        print(mistake, file=sys.stderr)
    # A build goes on, so that the test can report the block that is wrong.
    sys.exit(1 if mistakes and sys.argv[1] == "run" else 0)


if __name__ == "__main__":
    main()
