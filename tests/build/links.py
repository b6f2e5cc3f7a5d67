#!/usr/bin/python3
"""Every relative link of every Markdown file of the repository: is the file there, and the heading in it? No network.

    links.py [ROOT]

Of docs/glossary.md also: rows are in the order of the alphabet, and what the last column names is in the file that it
links. Headings become anchors as GitHub and Python-Markdown (the site) both make them; a heading for which the two differ
is a mistake when it is linked.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).resolve().parents[2]).resolve()
LINK = re.compile(r"!?\[((?:[^][`]|`[^`]*`|\[[^]]*\])*)\]\(([^()\s]+(?:\([^()]*\)[^()\s]*)?)\)")


def markdown_files():
    """Those that git knows, or would add; without git, all outside of what builds leave."""
    try:
        listed = subprocess.run(["git", "-C", ROOT, "ls-files", "--cached", "--others", "--exclude-standard", "-z", "*.md"],
                                check=True, capture_output=True, text=True).stdout
        return sorted(ROOT / name for name in listed.split("\0") if name and (ROOT / name).exists())
    except (OSError, subprocess.CalledProcessError):
        return sorted(path for path in ROOT.rglob("*.md") if path.relative_to(ROOT).parts[0] not in ("build", "out"))


def without_code(text):
    """The text with fenced blocks and code spans blanked, line by line as before."""
    lines, fence = [], ""
    for line in text.splitlines():
        mark = re.match(r"\s*(```+|~~~+)", line)
        if mark and (not fence or mark[1].startswith(fence)):
            fence = "" if fence else mark[1]
            line = ""
        lines.append("" if fence else line)
    return lines


def plain(heading):
    heading = re.sub(r"!?\[([^]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[`*]", "", heading).strip()


def github_anchor(heading):
    return re.sub(r"[^\w\- ]", "", plain(heading).lower()).replace(" ", "-")


def site_anchor(heading):
    """As Python-Markdown's toc with its default slugify, which drops what is not ASCII and joins runs of hyphens."""
    ascii_only = plain(heading).encode("ascii", "ignore").decode()
    return re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", ascii_only).strip().lower())


def anchors(path, cache={}):
    if path not in cache:
        found, seen = {}, {}
        for line in without_code(path.read_text()):
            if heading := re.match(r"#{1,6}\s+(.*?)\s*#*$", line):
                github, site = github_anchor(heading[1]), site_anchor(heading[1])
                count = seen.get(github, 0)
                seen[github] = count + 1
                found[github + (f"-{count}" if count else "")] = site + (f"_{count}" if count else "")
        cache[path] = found
    return cache[path]


def mistake_of(page, target):
    path, _, anchor = target.partition("#")
    there = (page.parent / path).resolve() if path else page
    if not there.exists():
        return f"there is no {path}"
    if ROOT not in there.parents and there != ROOT:
        return f"{path} is outside of the repository"
    if not anchor:
        return ""
    if there.is_dir():
        there = there / "README.md"
    if there.suffix != ".md" or not there.exists():
        return f"#{anchor} of what is no page"
    if anchor not in anchors(there):
        return f"no heading of {there.relative_to(ROOT)} gives #{anchor}"
    if anchors(there)[anchor] != anchor:
        return f"#{anchor} is #{anchors(there)[anchor]} on the site: take the heading's punctuation out"
    return ""


def dead_links(page):
    # The page is one text, since a link's text may extend over several lines. Code spans are blanked, except in a link's text.
    text = re.sub(r"(?<!\[)`[^`\n]*`(?!\])", lambda span: " " * len(span[0]), "\n".join(without_code(page.read_text())))
    for link in LINK.finditer(text):
        # A picture may itself be a link.
        for target in [link[2]] + [inner for _, inner in LINK.findall(link[1])]:
            if re.match(r"[a-z]+:", target):
                continue
            if why := mistake_of(page, target):
                line = text.count("\n", 0, link.start()) + 1
                yield f"{page.relative_to(ROOT)}:{line}: {target}: {why}"


def glossary_mistakes(path):
    before = ""
    for number, line in enumerate(path.read_text().splitlines(), 1):
        row = re.match(r"\| \*\*(.+?)\*\* \|.*\| \[`(\w+)`\]\(([^)]+)\) \|$", line)
        if not row:
            if line.startswith("| **"):
                yield f"docs/glossary.md:{number}: the last column is not [`NAME`](FILE)"
            continue
        word, name, target = row[1].lower(), row[2], (path.parent / row[3])
        if word <= before:
            yield f"docs/glossary.md:{number}: {row[1]} comes before {before}"
        before = word
        if target.is_file() and not re.search(rf"\b{name}\b", target.read_text()):
            yield f"docs/glossary.md:{number}: there is no {name} in {row[3]}"


def main():
    files = markdown_files()
    mistakes = [why for page in files for why in dead_links(page)]
    glossary = ROOT / "docs" / "glossary.md"
    if glossary.exists():
        mistakes += glossary_mistakes(glossary)
    print("\n".join(mistakes) if mistakes else f"the links of {len(files)} files lead somewhere")
    sys.exit(1 if mistakes else 0)


main()
