#!/usr/bin/python3
"""Names each enumerator of the public headers that has no comment, from doxygen's XML (scripts/docs). Ends with 1 if there is one.

    docs_enumerators.py DIRECTORY
"""

import sys
import xml.etree.ElementTree as tree
from pathlib import Path


def without_comment(directory):
    for path in sorted(Path(directory).glob("*.xml")):
        root = tree.parse(path)
        if root.find("compounddef[@prot='private']") is not None:
            continue
        for enum in root.iterfind(".//memberdef[@kind='enum']"):
            if enum.get("prot") == "private":
                continue
            place = enum.find("location")
            for value in enum.iterfind("enumvalue"):
                words = [value.find(part) for part in ("briefdescription", "detaileddescription")]
                if not any("".join(each.itertext()).strip() for each in words if each is not None):
                    yield f"{place.get('file')}:{place.get('line')}: {enum.findtext('qualifiedname')}::{value.findtext('name')}"


found = sorted(set(without_comment(sys.argv[1])))
for each in found:
    print(f"{each} is not documented", file=sys.stderr)
sys.exit(1 if found else 0)
