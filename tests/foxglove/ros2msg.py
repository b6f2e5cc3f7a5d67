#!/usr/bin/env python3
"""Reads definitions of ROS 2 messages (ros2msg) and messages in CDR by their own documents, and none of our code.

`ros2msg.py FILE`: FILE is JSON, a list of {"name", "schema", "hex"}; prints the list of the messages as JSON."""

import json
import struct
import sys

NUMBERS = {"bool": "?", "byte": "B", "char": "b", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
           "int64": "q", "uint64": "Q", "float32": "f", "float64": "d"}


def parse(name, text):
    """{type: [(member, type, count)]}; count: None, one; 0, as many as the message says; else so many."""
    types = {}
    root = name.replace("/msg/", "/")
    for block in ("MSG: " + root + "\n" + text).split("=" * 80 + "\n"):
        lines = block.split("\n")
        assert lines[0].startswith("MSG: "), lines[0]
        current = lines[0][5:].strip()
        assert current not in types, "defined twice: " + current
        types[current] = []
        for line in lines[1:]:
            words = line.split("#")[0].split()
            if not words or "=" in "".join(words[1:]):  # nothing, or a constant
                continue
            kind, member, count = words[0], words[1], None
            if kind.endswith("]"):
                kind, inside = kind[:-1].split("[")
                count = int(inside) if inside else 0
            if kind not in NUMBERS and kind != "string" and "/" not in kind:
                kind = current.split("/")[0] + "/" + kind
            types[current].append((member, kind, count))
    for members in types.values():
        for _, kind, _ in members:
            assert kind in NUMBERS or kind == "string" or kind in types, "no definition of " + kind
    return root, types


class Cdr:
    def __init__(self, data):
        assert data[:4] == b"\0\1\0\0", "not CDR, little endian"
        self.data, self.at = data[4:], 0

    def number(self, code):
        size = struct.calcsize("=" + code)
        self.at += -self.at % size
        value, = struct.unpack_from("<" + code, self.data, self.at)
        self.at += size
        return value

    def value(self, kind, types):
        if kind in NUMBERS:
            return self.number(NUMBERS[kind])
        if kind == "string":
            size = self.number("I")
            text = self.data[self.at:self.at + size]
            self.at += size
            assert len(text) == size and text.endswith(b"\0")
            return text[:-1].decode()
        out = {}
        for member, inner, count in types[kind]:
            if count is None:
                out[member] = self.value(inner, types)
            else:
                out[member] = [self.value(inner, types) for _ in range(count or self.number("I"))]
        return out


def decode(root, types, data):
    cdr = Cdr(data)
    message = cdr.value(root, types)
    assert cdr.at == len(cdr.data), f"{len(cdr.data) - cdr.at} bytes are left"
    return message


def main():
    out = []
    for case in json.load(open(sys.argv[1])):
        out.append(decode(*parse(case["name"], case["schema"]), bytes.fromhex(case["hex"])))
    print(json.dumps(out, allow_nan=False))


if __name__ == "__main__":
    main()
