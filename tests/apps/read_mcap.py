#!/usr/bin/env python3
"""Reads a recording as the format's specification says, and none of our code: checks every checksum, every index, every
message; prints what it found as JSON. Needs the program zstd."""

import hashlib
import json
import os
import struct
import subprocess
import sys
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "foxglove"))
import ros2msg

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
ATTACHMENT, ATTACHMENT_INDEX, STATISTICS, METADATA, METADATA_INDEX, DATA_END = 0x09, 0x0A, 0x0B, 0x0C, 0x0D, 0x0F


class Parts:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values if len(values) > 1 else values[0]

    def raw(self, n):
        assert self.at + n <= len(self.data)
        self.at += n
        return self.data[self.at - n:self.at]

    def text(self):
        return self.raw(self.take("I")).decode()

    def map(self, key, value):
        inner, found = Parts(self.raw(self.take("I"))), {}
        while inner.at < len(inner.data):
            k = key(inner)
            assert k not in found
            found[k] = value(inner)
        return found

    def rest(self):
        return self.raw(len(self.data) - self.at)


def records(data, at, end):
    while at < end:
        op, length = struct.unpack_from("<BQ", data, at)
        assert at + 9 + length <= end, "a record beyond the end"
        yield op, at, data[at + 9:at + 9 + length]
        at += 9 + length


def check_view(topic, message, report, log_time):
    """A pose, wrench, ... says what the report says, of the time of the message."""
    if topic == "/tf":
        transform, = message["transforms"]
        header, kind = transform["header"], "tf"
        assert transform["child_frame_id"] == header["frame_id"].replace("_base", "_hand")
        found, said = (transform["transform"][part] for part in ("translation", "rotation")), ("position", "orientation")
    else:
        header, kind = message["header"], topic.split("/")[2]
        parts = {"measured_cp": ("pose", "position", "orientation"), "measured_cf": ("wrench", "force", "torque"),
                 "measured_cv": ("twist", "linear", "angular")}.get(kind)
        said = {"measured_cp": ("position", "orientation"), "measured_cf": ("sent_force", "sent_torque"),
                "measured_cv": ("velocity", "angular_velocity")}.get(kind, ())
        found = (message[parts[0]][part] for part in parts[1:]) if parts else ()
    for one, member in zip(found, said):
        assert one == report[member], (topic, one, report[member])
    assert header["frame_id"].endswith("_base")
    assert header["stamp"]["sec"] * 10**9 + header["stamp"]["nanosec"] == log_time
    if kind == "measured_js":
        assert message["position"] == report["joints"][:len(message["name"])] and message["name"]
    if kind == "joy":
        assert sum(bit << i for i, bit in enumerate(message["buttons"])) == report["buttons"]


def check_scene(message, log_time):
    """Markers of that time, in the device's frame: or one that takes all away."""
    for marker in message["markers"]:
        header = marker["header"]
        assert header["frame_id"].endswith("_base")
        assert header["stamp"]["sec"] * 10**9 + header["stamp"]["nanosec"] == log_time


def check_page(topic, body):
    """What is for knurl-web's page."""
    if topic == "/knurl/scene":
        assert json.loads(body)["op"] in ("servo", "scene", "felt", "arm")
    elif topic == "/knurl/mesh":
        claim, asset, nothing, vertices, triangles = struct.unpack_from("<QIIII", body)
        assert claim > 0 and asset > 0 and nothing == 0 and len(body) == 24 + 12 * vertices + 12 * triangles
        assert all(corner < vertices for corner in struct.unpack_from(f"<{3 * triangles}I", body, 24 + 12 * vertices))


def main(path):
    data = open(path, "rb").read()
    assert data.startswith(MAGIC) and data.endswith(MAGIC)
    footer_at = len(data) - 8 - 29
    op, length, summary_start, offsets_start, summary_crc = struct.unpack_from("<BQQQI", data, footer_at)
    assert (op, length, offsets_start) == (FOOTER, 20, 0)
    assert summary_crc == zlib.crc32(data[summary_start:footer_at + 25])

    channels, counts, metadata, chunks, reports, expected = {}, {}, {}, {}, [], {}
    schemas, where = {}, {}
    attachments, attached = {}, {}

    def define(op, content):
        p = Parts(content)
        if op == SCHEMA:
            number, name, encoding = p.take("H"), p.text(), p.text()
            schemas[number] = (name, encoding, p.raw(p.take("I")).decode())
        elif op == CHANNEL:
            number, schema, topic, encoding = p.take("H"), p.take("H"), p.text(), p.text()
            assert p.map(Parts.text, Parts.text) == {}
            assert schema == 0 or schema in schemas
            channels[number] = (topic, encoding, schema)

    definitions, last_report = {}, None

    def parsed(schema):
        if schema[0] not in definitions:
            definitions[schema[0]] = ros2msg.parse(schema[0], schema[2])
        return definitions[schema[0]]

    message_indexes, last_chunk = {}, None
    data_end = None
    for op, at, content in records(data, len(MAGIC), summary_start):
        assert data_end is None
        p = Parts(content)
        if op == HEADER:
            profile, library = p.text(), p.text()
            assert profile == ""
        elif op in (SCHEMA, CHANNEL):
            define(op, content)
        elif op == METADATA:
            where[at] = len(content) + 9
            name = p.text()
            metadata[name] = p.map(Parts.text, Parts.text)
        elif op == ATTACHMENT:
            times, name, media_type = p.take("QQ"), p.text(), p.text()
            held = p.raw(p.take("Q"))
            assert p.take("I") == zlib.crc32(content[:-4]) and p.rest() == b"" and name not in attachments
            attachments[name] = {"media_type": media_type, "bytes": len(held), "sha256": hashlib.sha256(held).hexdigest()}
            attached[name] = (at, len(content) + 9, *times, len(held), media_type)
        elif op == CHUNK:
            first, last, plain, crc = p.take("QQQI")
            compression, packed = p.text(), p.raw(p.take("Q"))
            assert compression == "zstd" and p.rest() == b""
            chunk = subprocess.run(["zstd", "-dcq"], input=packed, capture_output=True, check=True).stdout
            assert len(chunk) == plain and zlib.crc32(chunk) == crc
            times, places = [], {}
            for inner_op, inner_at, inner in records(chunk, 0, len(chunk)):
                assert inner_op == MESSAGE
                m = Parts(inner)
                channel, sequence, log_time, publish_time = m.take("HIQQ")
                assert channel in channels and log_time == publish_time
                # A gap is possible: a full disk drops messages.
                assert sequence >= expected.get(channel, 0)
                expected[channel] = sequence + 1
                counts[channel] = counts.get(channel, 0) + 1
                times.append(log_time)
                places.setdefault(channel, []).append((log_time, inner_at))
                schema = schemas.get(channels[channel][2], ("", "", ""))
                body = m.rest()
                if schema[0] == "knurl_msgs/msg/Report":
                    assert body[:4] == b"\0\1\0\0" and len(body) == 4 + 376
                    values = struct.unpack_from("<Q3q8d3d4d24d4IQ", body, 4)
                    reports.append({"cycle": values[0], "sent_fz": values[36], "state": values[43]})
                    last_report = ros2msg.decode(*parsed(schema), body)
                elif schema[0] == "visualization_msgs/msg/MarkerArray":
                    check_scene(ros2msg.decode(*parsed(schema), body), log_time)
                elif schema[0] == "":
                    check_page(channels[channel][0], body)
                elif schema[1] == "ros2msg":
                    # The same as the report before it, in another form.
                    check_view(channels[channel][0], ros2msg.decode(*parsed(schema), body), last_report, log_time)
            assert (first, last) == (min(times), max(times))
            chunks[at] = {"first": first, "last": last, "bytes": len(content) + 9, "packed": len(packed),
                          "plain": plain, "indexes": {}, "index_bytes": 0}
            last_chunk, message_indexes = chunks[at], places
        elif op == MESSAGE_INDEX:
            channel = p.take("H")
            inner = Parts(p.raw(p.take("I")))
            found = [inner.take("QQ") for _ in range(len(inner.data) // 16)]
            assert found == message_indexes.pop(channel)
            last_chunk["indexes"][channel] = at
            last_chunk["index_bytes"] += len(content) + 9
        elif op == DATA_END:
            data_end = p.take("I")
            assert data_end == zlib.crc32(data[:at])
        else:
            raise AssertionError(f"op {op} in the data section")
    assert data_end is not None

    defined, seen, statistics = (dict(schemas), dict(channels)), {}, None
    for op, at, content in records(data, summary_start, footer_at):
        p = Parts(content)
        if op in (SCHEMA, CHANNEL):
            define(op, content)
        elif op == STATISTICS:
            statistics = p.take("QHIIIIQQ")
            number = lambda form: lambda part: part.take(form)
            assert {c: n for c, n in p.map(number("H"), number("Q")).items() if n > 0} == counts
        elif op == CHUNK_INDEX:
            first, last, at_chunk, length = p.take("QQQQ")
            indexes = p.map(lambda part: part.take("H"), lambda part: part.take("Q"))
            index_bytes, compression, packed, plain = p.take("Q"), p.text(), *p.take("QQ")
            seen[at_chunk] = {"first": first, "last": last, "bytes": length, "packed": packed, "plain": plain,
                              "indexes": indexes, "index_bytes": index_bytes}
            assert compression == "zstd"
        elif op == ATTACHMENT_INDEX:
            found = p.take("QQQQQ")
            assert attached.pop(p.text()) == (*found, p.text())
        elif op == METADATA_INDEX:
            at_metadata, length = p.take("QQ")
            assert where[at_metadata] == length and p.text() in metadata
        else:
            raise AssertionError(f"op {op} in the summary")
    assert defined == (schemas, channels) and seen == chunks
    assert not attached and statistics[3] == len(attachments)
    assert statistics[0] == sum(counts.values()) and statistics[5] == len(chunks)
    assert statistics[6] == min(c["first"] for c in chunks.values())
    print(json.dumps({"library": library, "metadata": metadata, "chunks": len(chunks), "schemas": list(schemas.values()),
                      "messages": {channels[c][0]: n for c, n in counts.items()}, "reports": reports,
                      "dropped": sum(expected.values()) - sum(counts.values()),
                      "attachments": attachments}))


main(sys.argv[1])
