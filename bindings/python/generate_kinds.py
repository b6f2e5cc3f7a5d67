#!/usr/bin/env python3
"""generate_kinds.py LIBRARY OUTPUT: writes knurl/_kinds.py from the tables of libknurl.so.

    generate_kinds.py build/release/runtime/capi/libknurl.so.0 bindings/python/knurl/_kinds.py

One dataclass per kind of representation: names, defaults, units, meanings, ranges and places in the C struct are the
library's, so that a new kind appears here without a line of its own.
"""

import ctypes as c
import importlib.util
import keyword
import os
import struct
import sys

TYPES = ("real", "vector", "choice", "integer", "quaternion", "matrix", "points")
# Members of the C++ structs with these names end in an underscore there, and so here; Python has keywords of its own.
RESERVED = {"static", "default", "switch", "class", "struct", "union", "operator", "register"}

INFINITY_IN_TEXTS = "INFINITY: as stiff as the device allows"


def load_structs():
    """The module of the C structs, without the package, which needs what is written here."""
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "knurl", "_structs.py")
    spec = importlib.util.spec_from_file_location("knurl_structs", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


s = load_structs()


class Row:
    """A parameter: its place in the dataclass, and in the C struct."""

    def __init__(self, field, choices, packed):
        self.full_name = field.name.decode()
        self.part, _, name = self.full_name.rpartition(".")
        self.name = name + "_" if name in RESERVED or keyword.iskeyword(name) else name
        self.unit = field.unit.decode()
        self.meaning = field.meaning.decode()
        self.type = TYPES[field.type]
        self.count = field.count
        self.offset = field.offset
        self.range = (field.minimum, field.maximum)
        self.infinity, self.automatic = bool(field.infinity_allowed), bool(field.automatic_allowed)
        self.choices = choices
        self.default = self.value(struct.unpack_from("<" + self.format(), packed, self.offset))

    def format(self):
        """Of the module struct."""
        reals = {"real": 1, "vector": 3, "quaternion": 4, "matrix": self.count**2, "points": 3 * self.count}.get(self.type, 0)
        return ("d" * reals if reals else "") + ("I" if not reals or self.type == "points" else "")

    def value(self, flat):
        """As the dataclass has it."""
        if self.type in ("real", "integer"):
            return flat[0]
        if self.type == "choice":
            return self.choices[flat[0]]
        if self.type in ("vector", "quaternion"):
            return tuple(flat)
        if self.type == "matrix":
            return tuple(tuple(flat[i * self.count : (i + 1) * self.count]) for i in range(self.count))
        return tuple(tuple(flat[3 * i : 3 * i + 3]) for i in range(flat[-1]))

    def same(self):
        """What must be equal for two kinds to share a part: all but the place in the struct."""
        return (self.name, self.unit, self.meaning, self.type, self.count, self.range, self.infinity, self.automatic,
                self.choices, self.default)

    def annotation(self):
        if self.type == "choice":
            return "Literal[" + ", ".join(f'"{name}"' for name in self.choices) + "]"
        return {"real": "float", "integer": "int", "matrix": "Matrix", "points": "Points"}.get(self.type, "Vector")

    def converter(self):
        if self.type == "choice":
            return "choice(" + ", ".join(f'"{name}"' for name in self.choices) + ")"
        return self.type if self.type in ("real", "integer", "vector", "quaternion") else f"{self.type}({self.count})"

    def source_of_default(self):
        text = repr(self.default).replace("inf", "INFINITY")
        return "AUTOMATIC" if self.automatic and self.default == -1 else text.replace("'", '"')

    def doc(self):
        unit = f" ({self.unit})" if self.unit not in ("", "1") else ""
        low, high = self.range
        limits = f"; {low:g} to {high:g}" if self.type != "choice" and high < float("inf") else ""
        more = ", or " + INFINITY_IN_TEXTS if self.infinity else ""
        more += ", or AUTOMATIC" if self.automatic else ""
        meaning = self.meaning if self.meaning[1:2] == "." else self.meaning[:1].upper() + self.meaning[1:]
        return f"{meaning}{unit}{limits}{more}."

    def packed(self):
        """Expression that gives its numbers in the C struct; parts are local names there."""
        place = f"{self.part or 'self'}.{self.name}"
        if self.type == "choice":
            return f"{constant(self.choices)}[{place}]"
        whole = {"vector": f"*{place}", "quaternion": f"*{place}", "matrix": f"*flat({place})", "points": f"*padded({place}, {self.count})"}
        return whole.get(self.type, place)

    def unpacked(self):
        detail = self.choices if self.type == "choice" else self.count
        return (self.part, self.name, self.type, detail)


def constant(choices):
    """Name of the numbers of these choices."""
    return "_" + "_".join(choices).upper()


def camel(name):
    return "".join(word.capitalize() for word in name.split("_"))


def kinds_of(library):
    """(name, size, rows) of every kind."""
    name, size = c.c_char_p(), c.c_uint64()
    kind = 0
    while library.knurl_kind_at(kind, c.byref(name), c.byref(size)) == 0:
        packed = c.create_string_buffer(size.value)
        if library.knurl_default(kind, packed, size) != 0:
            sys.exit(f"generate_kinds: no defaults of {name.value.decode()}: {library.knurl_error(None).decode()}")
        rows, field = [], s.FieldRow()
        while library.knurl_field_at(kind, len(rows), c.byref(field)) == 0:
            rows.append(Row(field, choices_of(library, kind, len(rows)), packed.raw))
        yield name.value.decode(), size.value, rows
        kind += 1


def choices_of(library, kind, row):
    found, name = [], c.c_char_p()
    while library.knurl_choice_at(kind, row, len(found), c.byref(name)) == 0:
        found.append(name.value.decode())
    return tuple(found)


def fields_of(rows, parts):
    """(name, annotation, default, converter, text) of a dataclass; a part stands where its first row does."""
    seen = set()
    for row in rows:
        if row.part and row.part in parts:
            if row.part not in seen:
                seen.add(row.part)
                kind = parts[row.part]
                yield row.part, kind, f"field(default_factory={kind})", f"part({kind})", f"{row.part.capitalize()}: knurl.{kind}."
        else:
            yield row.name, row.annotation(), row.source_of_default(), row.converter(), row.doc()


def write_class(out, name, base, label, doc, rows, parts, more=""):
    fields = list(fields_of(rows, parts))
    out.append(f"\n\n@dataclass(repr=False, eq=False)\nclass {name}({base}):\n    \"\"\"{doc}\"\"\"\n")
    for field, annotation, default, _, text in fields:
        out.append(f"    {field}: {annotation} = {default}\n    \"\"\"{text}\"\"\"\n")
    out.append(f"\n    _NAME: ClassVar[str] = \"{label}\"\n")
    out.append("    _CONVERT: ClassVar[Dict[str, Converter]] = {\n")
    out.extend(f"        \"{field}\": {converter},\n" for field, _, _, converter, _ in fields)
    out.append("    }\n" + more)


def packing(kind, size, rows):
    """How the parameters lie in the C struct."""
    layout, at = "<Q", 8
    for row in rows:
        layout += f"{row.offset - at}x" if row.offset > at else ""
        layout += row.format()
        at = row.offset + struct.calcsize("<" + row.format())
    layout += f"{size - at}x" if size > at else ""
    parts = dict.fromkeys(row.part for row in rows if row.part)
    text = f"    _KIND: ClassVar[int] = {kind}\n    _FORMAT: ClassVar[struct.Struct] = struct.Struct(\"{layout}\")\n"
    text += "    _ROWS: ClassVar[Tuple[Tuple[str, str, str, Any], ...]] = (\n"
    text += "".join(f"        {row.unpacked()!r},\n" for row in rows) + "    )\n\n"
    text += "    def _values(self) -> Tuple[Any, ...]:\n"
    text += "".join(f"        {part} = self.{part}\n" for part in parts)
    return text + "        return (\n" + "".join(f"            {row.packed()},\n" for row in rows) + "        )\n"


def source(library):
    kinds = list(kinds_of(library))
    out = [
        f'"""The representations of libknurl {library.knurl_version().decode()}. Written by generate_kinds.py: change the library."""\n\n'
        "from __future__ import annotations\n\nimport struct\nfrom dataclasses import dataclass, field\n"
        "from typing import Any, ClassVar, Dict, Literal, Tuple\n\n"
        "from ._representation import (\n    AUTOMATIC,\n    INFINITY,\n    Converter,\n    Matrix,\n    Points,\n    Record,\n"
        "    Representation,\n    Vector,\n    choice,\n    flat,\n    integer,\n    matrix,\n    padded,\n    part,\n    points,\n"
        "    quaternion,\n    real,\n    vector,\n)\n\n"
        f"LAYOUT = {library.knurl_layout():#x}\nSIZES = {tuple(size for _, size, _ in kinds)!r}\n\n"
    ]
    all_choices = dict.fromkeys(row.choices for _, _, rows in kinds for row in rows if row.choices)
    for choices in all_choices:
        numbers = ", ".join(f'"{name}": {number}' for number, name in enumerate(choices))
        out.append(f"{constant(choices)} = {{{numbers}}}\n")
    known, names = {}, []
    for number, (kind, size, rows) in enumerate(kinds):
        parts = {}
        for part in dict.fromkeys(row.part for row in rows if row.part):
            own = [row for row in rows if row.part == part]
            same = tuple(row.same() for row in own)
            name = camel(part.replace(".", "_"))
            if known.get(name, same) != same:
                name = camel(kind) + name
            parts[part] = name
            if name not in known:
                known[name] = same
                names.append(name)
                write_class(out, name, "Record", part, f"The {part} of a surface. Lengths in m, forces in N.", own, {})
        names.append(camel(kind))
        write_class(out, camel(kind), "Representation", kind,
                    f"Parameters of a {kind}, as knurl::{camel(kind)} of C++. Frame: the world of the claim.", rows, parts,
                    "\n" + packing(number, size, rows))
    listed = "".join(f"    {camel(kind)},\n" for kind, _, _ in kinds)
    out.append(f"\n\nKINDS: Tuple[type, ...] = (\n{listed})\n\n__all__ = {sorted(names)!r}\n")
    text = "".join(out)
    return text if text.count("INFINITY") > text.count(INFINITY_IN_TEXTS) + 1 else text.replace("    INFINITY,\n", "")


def open_library(path):
    library = c.CDLL(path)
    library.knurl_version.restype = library.knurl_error.restype = c.c_char_p
    library.knurl_layout.restype = c.c_uint64
    library.knurl_error.argtypes = [c.c_void_p]
    library.knurl_default.argtypes = [c.c_uint32, c.c_void_p, c.c_uint64]
    return library


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    text = source(open_library(os.path.abspath(sys.argv[1])))
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main()
