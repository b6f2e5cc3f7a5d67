#!/usr/bin/python3
"""What ctest skipped, and why: test_summary.py JUNIT.xml (ctest --output-junit). One line a reason; the last line counts.

A test says why in the line behind GoogleTest's "Skipped", or behind "SKIPPED: ". Where a right is missing
(tests/rights.hpp), what counts is which one, in whatever words the kernel refused it.
"""

import collections
import re
import sys
import xml.etree.ElementTree


def reason(output):
    said = re.search(r": Skipped\n+(.+)|SKIPPED: (.+)", output or "")
    return next(filter(None, said.groups())).strip() if said else "it does not say why"


def right(text):
    """Short, and the same for all that lack the same."""
    return re.sub(r"^missing right: ", "", text).split(" (")[0] if text.startswith("missing right: ") else text


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.split(":")[0] + ": usage: test_summary.py JUNIT.xml")
    cases = xml.etree.ElementTree.parse(sys.argv[1]).getroot().findall("testcase")
    skipped, texts = collections.Counter(), {}
    for case in cases:
        if case.find("skipped") is not None:
            why = reason(case.findtext("system-out"))
            skipped[right(why)] += 1
            texts.setdefault(right(why), why)
    failed = sum(case.find("failure") is not None for case in cases)
    for name, count in skipped.most_common():
        print(f"skipped {count}: {texts[name]}")
    counts = "; ".join(f"{count} {name.split('; ')[0].split(': ')[0]}" for name, count in skipped.most_common())
    print(f"{len(cases)} tests, {f'{failed} failed, ' if failed else ''}{sum(skipped.values())} skipped{f' ({counts})' if counts else ''}")


if __name__ == "__main__":
    main()
