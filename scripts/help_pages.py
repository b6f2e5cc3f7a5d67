#!/usr/bin/python3
"""Man pages and completions of programs, made from what their --help says.

    help_pages.py man FOLDER PROGRAM...           FOLDER/NAME.1.gz of each program and verb, by help2man
    help_pages.py completions FOLDER PROGRAM...   FOLDER/bash/NAME and FOLDER/zsh/_NAME of each program

PROGRAMs are paths. Run at installation, so that pages and completions are those of the programs beside them.
"""

import gzip
import re
import subprocess
import sys
import tempfile
from pathlib import Path


class Page:
    """One --help: of a program, or of a verb of it (words: ["device", "check"])."""

    def __init__(self, program, words=()):
        self.program, self.words = Path(program), list(words)
        text = subprocess.run([program, *words, "--help"], check=True, capture_output=True, text=True).stdout
        lines = text.splitlines()
        self.text = text
        self.purpose = re.sub(rf"^{re.escape(self.program.name)}: ", "", lines[0])
        section, self.options, verbs = "", {}, []
        for line in lines:
            if heading := re.match(r"([A-Z][a-z]+):$", line):
                section = heading[1]
            elif section == "Subcommands" and (verb := re.match(r"  ([a-z][a-z-]*)  ", line + "  ")):
                verbs.append(verb[1])
            elif section == "Options" and (option := re.match(r"  (?:(-\w),)?(--[a-z][\w-]*)(.*)", line)):
                self.add_option(option)
            elif line and not line.startswith(" "):
                section = ""
        self.verbs = [Page(program, [*self.words, verb]) for verb in verbs]

    def add_option(self, option):
        """Of `--around {last, late}=last  the ...`: the words that it takes; [] where it takes any; None: it is a flag."""
        kind = re.match(r" (\{[^}]*\}|(?!(?:Excludes:|REQUIRED))\S+)", option[3])
        choices = None
        if kind:
            choices = [word.strip() for word in kind[1].strip("{}").split(",")] if kind[1].startswith("{") else []
        for name in filter(None, (option[1], option[2])):
            self.options[name] = choices

    @property
    def name(self):
        return "-".join([self.program.name, *self.words])

    def all(self):
        """Itself, and all verbs below."""
        return [self] + [page for verb in self.verbs for page in verb.all()]


def lines_apart(text):
    """Examples and the like, a line each, become paragraphs each: help2man fills paragraphs."""
    lines = []
    for line in text.splitlines():
        alone = re.match(r"  \S(?:(?!  ).)*$", line) and not line.startswith("  -")
        lines += [""] * bool(alone and lines and lines[-1].startswith("  ")) + [line]
    return "\n".join(lines) + "\n"


def man_page(page, folder):
    """help2man runs a program by the page's name: one that says what the real one says."""
    with tempfile.TemporaryDirectory() as scratch:
        (Path(scratch) / "help").write_text(lines_apart(page.text))
        stand_in = Path(scratch) / page.name
        stand_in.write_text(f'#!/bin/sh\nexec cat "{scratch}/help"\n')
        stand_in.chmod(0o755)
        version = subprocess.run([page.program, "--version"], check=True, capture_output=True, text=True).stdout.split()[-1]
        text = subprocess.run(["help2man", "--no-info", "--section=1", f"--name={page.purpose}", f"--version-string={version}",
                               "--manual=Knurl", f"--source=Knurl {version}", stand_in], check=True, capture_output=True).stdout
    # mtime=0: the same page is the same file.
    with open(folder / f"{page.name}.1.gz", "wb") as file, gzip.GzipFile("", "wb", 9, file, mtime=0) as packed:
        packed.write(text)


def identifier(page):
    return "_" + re.sub(r"\W", "_", page.name)


def bash_cases(page):
    """Of each verb, by the words up to it: what may follow, and what its options take."""
    for one in page.all():
        words = " ".join([one.program.name, *one.words])
        follow = " ".join([*[verb.words[-1] for verb in one.verbs], *one.options])
        takes = " ".join(name for name, choices in one.options.items() if choices == [])
        chosen = "".join(f"            '{words} {name}') reply='{' '.join(choices)}' ;;\n"
                         for name, choices in one.options.items() if choices)
        yield words, follow, takes, chosen


def bash_completion(page):
    rows = list(bash_cases(page))
    follow = "".join(f"        '{words}') follow='{follow}'; takes=' {takes} ' ;;\n" for words, follow, takes, _ in rows)
    chosen = "".join(chosen for *_, chosen in rows)
    known = " ".join(f"'{words}'" for words, *_ in rows)
    return f"""# Completion of {page.name} for bash: made from its --help by help_pages.py.
{identifier(page)}() {{
    local now="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD - 1]}}" at='{page.program.name}' word one
    local follow='' takes='' reply=''
    for word in "${{COMP_WORDS[@]:1:COMP_CWORD - 1}}"; do
        for one in {known}; do [[ "$one" != "$at $word" ]] || {{ at="$one"; break; }}; done
    done
    case "$at" in
{follow}    esac
    case "$at $before" in
{chosen}    esac
    if [[ -n "$reply" ]]; then
        COMPREPLY=($(compgen -W "$reply" -- "$now"))
    elif [[ "$takes" == *" $before "* ]]; then
        COMPREPLY=($(compgen -f -- "$now"))
    else
        COMPREPLY=($(compgen -W "$follow" -- "$now"))
        [[ "$now" == -* ]] || COMPREPLY+=($(compgen -f -- "$now"))
    fi
}}
complete -o filenames -F {identifier(page)} {page.program.name}
"""


def zsh_quoted(text):
    return "'" + re.sub(r"([\[\]:])", r"\\\1", text).replace("'", "'\\''") + "'"


def zsh_function(page):
    lines = [f"{identifier(page)}() {{", "    _arguments -C \\"]
    for name, choices in page.options.items():
        value = "" if choices is None else f":value:({' '.join(choices)})" if choices else ":value:_files"
        lines.append(f"        '{name}{value}' \\")
    if not page.verbs:
        return "\n".join([*lines, "        '*:file:_files'", "}"])
    described = " ".join(zsh_quoted(verb.words[-1]) + ":" + zsh_quoted(verb.purpose) for verb in page.verbs)
    cases = "\n".join(f"        {verb.words[-1]}) {identifier(verb)} ;;" for verb in page.verbs)
    return "\n".join([*lines, "        '1:verb:->verb' '*::rest:->rest'", "    case $state in",
                      f"        verb) local -a verbs=({described}); _describe verb verbs ;;",
                      "        rest) case $words[1] in", cases.replace("\n", "\n    ").replace("        ", "            ", 1),
                      "        esac ;;", "    esac", "}"])


def zsh_completion(page):
    functions = "\n\n".join(zsh_function(one) for one in page.all())
    return (f"#compdef {page.program.name}\n# Completion of {page.name} for zsh: made from its --help by help_pages.py.\n\n"
            f'{functions}\n\n{identifier(page)} "$@"\n')


def main():
    if len(sys.argv) < 4 or sys.argv[1] not in ("man", "completions"):
        sys.exit(__doc__)
    folder = Path(sys.argv[2])
    for page in map(Page, sys.argv[3:]):
        if sys.argv[1] == "man":
            folder.mkdir(parents=True, exist_ok=True)
            for one in page.all():
                man_page(one, folder)
            continue
        for shell, name, text in (("bash", page.name, bash_completion(page)), ("zsh", f"_{page.name}", zsh_completion(page))):
            (folder / shell).mkdir(parents=True, exist_ok=True)
            (folder / shell / name).write_text(text)


if __name__ == "__main__":
    main()
