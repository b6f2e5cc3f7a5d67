"""A hook of mkdocs (mkdocs.yml): links that leave docs/ work on the site as they do in the repository.

The chapters (README.md of the modules) become pages of the site, at their place in the repository; the README of the root is
about.md. Files that a page links, pictures and sources, are copied: sources as .txt, so that a browser shows them.
Folders without a README are named and not linked. The API reference, which doxygen builds beside the pages, is the last entry of
the menu.
"""

import os
import re
import subprocess
from pathlib import Path

from mkdocs.structure.files import File
from mkdocs.structure.nav import Link

ROOT = Path(__file__).resolve().parents[1]
LINK = re.compile(r"(!?\[(?:[^][`]|`[^`]*`|!?\[[^]]*\](?:\([^)]*\))?)*\])\(([^()\s]+)\)")
SHOWN_AS_THEY_ARE = {".md", ".png", ".svg", ".jpg", ".html", ".json", ".txt"}


def listed(*patterns):
    names = subprocess.run(["git", "-C", ROOT, "ls-files", "--cached", "--others", "--exclude-standard", "-z", *patterns],
                           check=True, capture_output=True, text=True).stdout
    return [Path(name) for name in names.split("\0") if name]


CHAPTERS = [path for path in listed("*README.md") if path.parts[0] != "docs"]


def place_on_site(path):
    """Of a file of the repository (relative to its root): where it is on the site; None: nowhere."""
    if path.parts and path.parts[0] == "docs":
        return Path(*path.parts[1:]) if len(path.parts) > 1 else Path("README.md")
    if (ROOT / path).is_dir():
        path = path / "README.md"
        if path not in CHAPTERS:
            return None
    if path == Path("README.md"):
        return Path("about.md")
    if path.suffix == ".md" and path not in CHAPTERS:
        return path.with_suffix(".md.txt")
    return path if path.suffix in SHOWN_AS_THEY_ARE else path.with_name(path.name + ".txt")


def source_of(page_path):
    """Of a page of the site: the file of the repository, relative to its root."""
    path = Path(page_path)
    if path == Path("about.md"):
        return Path("README.md")
    return path if path in CHAPTERS and path != Path("README.md") else Path("docs") / path


def outside_of_code(markdown, change):
    """The text with `change` applied to what lies between fenced blocks. Links may go over the end of a line."""
    parts, kept, fence = [], [], False
    for line in markdown.splitlines():
        edge = bool(re.match(r"\s*```", line))
        if edge or fence:
            if kept:
                parts.append(change("\n".join(kept)))
                kept = []
            parts.append(line)
            fence ^= edge
        else:
            kept.append(line)
    return "\n".join(parts + ([change("\n".join(kept))] if kept else []))


def targets_of(path):
    """Files outside of docs/ that a page links."""
    found = []
    outside_of_code((ROOT / path).read_text(), lambda text: found.extend(target for _, target in LINK.findall(text)) or "")
    for target in found:
        if re.match(r"[a-z]+:|#", target):
            continue
        there = os.path.relpath((ROOT / path).parent / target.partition("#")[0], ROOT)
        if not there.startswith(("docs/", "..")) and (ROOT / there).is_file():
            yield Path(there)


def added(path, config):
    """A file of the repository at its place on the site."""
    file = File(str(place_on_site(path)), str(ROOT), config["site_dir"], config["use_directory_urls"])
    file.abs_src_path = str(ROOT / path)
    return file


def on_files(files, config):
    pages = CHAPTERS + [path for path in listed("docs/*.md")]
    wanted = set(CHAPTERS) | {target for page in pages for target in targets_of(page)}
    for path in sorted(wanted):
        files.append(added(path, config))
    for settings in ("Doxyfile", "api.dox"):  # of the API reference
        files.remove(files.get_file_from_path(settings))
    return files


def on_nav(nav, config, files):
    nav.items.append(Link("API", "api/index.html"))
    return nav


def on_page_markdown(markdown, page, config, files):
    source = source_of(page.file.src_path)
    here = place_on_site(source).parent

    def moved(match):
        text, target = match[1], match[2]
        name, hash_mark, anchor = target.partition("#")
        if not name or re.match(r"[a-z]+:", target):
            return match[0]
        place = place_on_site(Path(os.path.relpath((ROOT / source).parent / name, ROOT)))
        if place is None:
            return text[1:-1]
        return f"{text}({os.path.relpath(place, here)}{hash_mark}{anchor})"

    return outside_of_code(markdown, lambda text: LINK.sub(moved, text))
