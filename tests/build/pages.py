#!/usr/bin/python3
"""The code blocks of docs/**/*.md: built, run and compared, so that a page cannot say what is not so.

    pages.py extract FOLDER                   writes each page's files to FOLDER/PAGE/; prints PAGE/NAME of every program
    pages.py run FOLDER PROGRAMS... [--only PAGE] [--keep SCRATCH]
                                              runs the pages' commands; PROGRAMS are folders of programs. --keep: in that
                                              folder, so that what they made can be looked at, or drawn

A comment above a fence says what becomes of its block:

    <!-- file: NAME -->      the file NAME of this page; a .cpp is a program, which CMake builds (FOLDER/PAGE/bin/NAME)
    <!-- run -->             bash commands, run in a folder that has the files and programs of the page
    <!-- prints -->          lines that the run before has printed; numbers and folders may differ
    <!-- source: PATH -->    an excerpt of that file of the repository, verbatim

Without a comment ```text is no code, and of ```sh the programs, scripts and options must be there (readme.py). Anything
else is a mistake, so that no block is skipped silently. README.md files of docs/ are pages too.
"""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import readme

ROOT = readme.ROOT
MARK = re.compile(r"\s*<!-- (file|source): (\S+) -->\s*$|\s*<!-- (run|prints) -->\s*$")
NUMBER = re.compile(r"(?<![A-Za-z_.])[-+]?\d+(\.\d+)?(e[-+]?\d+)?")
STAMP = re.compile(r"\d{8}T\d{6}(\.\d+)?")  # a time in a file's name
ABSOLUTE = re.compile(r"(?<![\w.])(/[\w.+-]+){2,}")
TIMEOUT = 100  # s, of one block of commands


class Block:
    def __init__(self, page, line, language, mark, argument, text):
        self.page, self.line, self.language, self.mark, self.argument, self.text = page, line, language, mark, argument, text

    @property
    def where(self):
        return f"{self.page}:{self.line}"


def page_id(page):
    """docs/tutorial/1-wall.md: tutorial_1_wall."""
    return re.sub(r"\W", "_", str(page.with_suffix("").relative_to("docs")))


def blocks_of(page):
    found = []
    for line, language, above, text in readme.fences(page):
        said = MARK.match(above)
        mark, argument = (said[1] or said[3], said[2] or "") if said else ("", "")
        found.append(Block(page, line, language, mark, argument, text))
    return found


def pages():
    return sorted(path.relative_to(ROOT) for path in (ROOT / "docs").rglob("*.md"))


def is_program(block):
    return block.mark == "file" and block.argument.endswith(".cpp")


def extract(folder):
    """The pages' files; of programs with a #line, so that the compiler names the page."""
    programs, kept = [], set()
    for page in pages():
        for block in blocks_of(page):
            if block.mark != "file":
                continue
            path = folder / page_id(page) / block.argument
            path.parent.mkdir(parents=True, exist_ok=True)
            line = f'#line {block.line + 1} "{page}"\n' if is_program(block) else ""
            readme.write(path, line + block.text)
            kept.add(path)
            if is_program(block):
                programs.append(f"{page_id(page)}/{block.argument[:-4]}")
    for path in folder.glob("*/*.*"):
        if path.is_file() and path not in kept:
            path.unlink()
    return programs


def shape_of(line):
    """A line as it is compared: numbers are alike, and so are absolute paths and any white space."""
    return " ".join(NUMBER.sub("#", STAMP.sub("#", ABSOLUTE.sub("/", line))).split())


def not_printed(text, output):
    printed = {shape_of(line) for line in output.splitlines()}
    return [line for line in text.splitlines() if line.strip() not in ("", "...") and shape_of(line) not in printed]


def with_a_free_port(text):
    """Pages listen at this host's port 4096, which another test may have: then it is any that is free."""
    if "127.0.0.1:4096" not in text:
        return text
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        return text.replace("127.0.0.1:4096", f"127.0.0.1:{listening.getsockname()[1]}")


def end_group(started):
    """Whoever is left of its group is asked to end, and is waited for: the next commands may start a servo of that name."""
    deadline = time.monotonic() + 10
    try:
        os.killpg(started.pid, signal.SIGTERM)
        while time.monotonic() < deadline:
            started.poll()
            os.killpg(started.pid, 0)
            time.sleep(0.02)
        os.killpg(started.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass
    started.wait()


def run_commands(block, scratch, environment):
    """What they printed, and the exit code. All that they have left running is ended: a group of processes of its own."""
    with tempfile.TemporaryFile("w+") as output:
        started = subprocess.Popen(["bash", "-euo", "pipefail", "-c", with_a_free_port(block.text)], cwd=scratch, env=environment,
                                   stdout=output, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            code = started.wait(TIMEOUT)
        except subprocess.TimeoutExpired:
            code = f"nothing within {TIMEOUT} s"
        end_group(started)
        output.seek(0)
        return output.read(), code


def check_words(block, programs):
    if block.language == "sh":
        return [f"{block.where}: {why}" for why in readme.wrong_words(block.text, programs)]
    if block.language == "text":
        return []
    return [f"{block.where}: nobody tries this block ({block.language or 'no language'}): say what it is, <!-- file: NAME -->, "
            "<!-- run -->, <!-- source: PATH --> (pages.py), or ```text for what is no code"]


def check_source(block):
    path = ROOT / block.argument
    if not path.is_file():
        return [f"{block.where}: there is no file {block.argument}"]
    # Without the indentation of the first line, which an excerpt may leave out.
    if block.text.strip() in path.read_text():
        return []
    return [f"{block.where}: this is not in {block.argument}"]


def try_page(page, folder, programs, scratch):
    mistakes, output = [], ""
    environment = dict(os.environ, KNURL_RUNTIME_DIR=scratch, KNURL_STATE_DIR=f"{scratch}/state", HOME=scratch,
                       REPOSITORY=str(ROOT), PATH=":".join(map(str, programs)) + f":{ROOT}/scripts:" + os.environ["PATH"])
    for block in blocks_of(page):
        if block.mark == "file":
            shutil.copy(folder / page_id(page) / block.argument, scratch)
            if is_program(block):
                shutil.copy(folder / page_id(page) / "bin" / block.argument[:-4], scratch)
        elif block.mark == "source":
            mistakes += check_source(block)
        elif block.mark == "run":
            output, code = run_commands(block, scratch, environment)
            print(f"== {block.where}\n{output}", flush=True)
            if code != 0:
                mistakes.append(f"{block.where}: ended with {code}, see above")
        elif block.mark == "prints":
            mistakes += [f"{block.where}: the run did not print a line like: {line}" for line in not_printed(block.text, output)]
        else:
            mistakes += check_words(block, programs)
    return mistakes


def option(words, name):
    """Taken out of the words, with its value."""
    if name not in words:
        return ""
    at = words.index(name)
    value = words[at + 1]
    del words[at:at + 2]
    return value


def main():
    words = sys.argv[1:]
    if len(words) < 2 or words[0] not in ("extract", "run"):
        sys.exit(__doc__)
    only, keep = option(words, "--only"), option(words, "--keep")
    folder = Path(words[1]).resolve()
    if words[0] == "extract":
        print("\n".join(extract(folder)))
        return
    programs, mistakes = [Path(word) for word in words[2:]], []
    for page in pages():
        if only and page_id(page) != only:
            continue
        with tempfile.TemporaryDirectory(prefix="knurl-page-") as scratch:
            mistakes += try_page(page, folder, programs, keep or scratch)
    for mistake in mistakes:
        print(mistake, file=sys.stderr)
    sys.exit(1 if mistakes else 0)


main()
