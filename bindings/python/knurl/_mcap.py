"""Reports as an MCAP file: the topic, schema and encoding of `knurl record`, without chunks and compression.

Foxglove and PlotJuggler plot it. `knurl replay` needs the cycle's inputs, too, which only `knurl record` has.
"""

from __future__ import annotations

import io
import struct
import zlib
from typing import TYPE_CHECKING, Any, BinaryIO, Dict, Tuple

from ._errors import BadParameters
from ._lazy import numpy
from ._reports import report_dtype
from ._version import __version__

if TYPE_CHECKING:
    from ._lazy import Table

_MAGIC = b"\x89MCAP0\r\n"
_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _METADATA, _DATA_END = 1, 2, 3, 4, 5, 6, 12, 15
_STATISTICS, _METADATA_INDEX = 11, 13
_TOPIC = "/knurl/report"
_CDR = b"\0\1\0\0"  # little endian
_AT, _BYTES = 8, 376  # of a report in knurl_report: CDR packs the members as the compiler does

_DEFINITION = """# What Knurl's servo publishes each cycle, of one device, in that device's own frame.
uint64 cycle
int64 deadline_ns   # CLOCK_MONOTONIC: when the cycle should have begun
int64 read_ns       # when the joint sample had been read
int64 write_ns      # when the efforts had been written
float64[8] joints   # rad
geometry_msgs/Vector3 position      # m
knurl_msgs/Quaternion orientation
geometry_msgs/Vector3 velocity      # m/s
geometry_msgs/Vector3 slow_velocity # m/s
geometry_msgs/Vector3 angular_velocity # rad/s
geometry_msgs/Vector3 scene_force   # N, before the supervisor
geometry_msgs/Vector3 scene_torque  # N m
geometry_msgs/Vector3 sent_force    # N, after the supervisor
geometry_msgs/Vector3 sent_torque   # N m
geometry_msgs/Vector3 contact_point # m
uint32 state        # 0 disconnected, 1 idle, 2 armed, 3 ramp up, 4 active, 5 ramp down, 6 fault
uint32 faults       # bit mask
uint32 buttons      # bit mask
uint32 flags        # bit mask
uint64 late_count   # cycles
uint32 presses      # bit mask, a bit turned over by each press
uint32 touches      # contacts that have begun
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: knurl_msgs/Quaternion
float64 w
float64 x
float64 y
float64 z
"""


def _text(text: str) -> bytes:
    return struct.pack("<I", len(text.encode())) + text.encode()


def _map(values: Dict[str, str]) -> bytes:
    content = b"".join(_text(key) + _text(value) for key, value in values.items())
    return struct.pack("<I", len(content)) + content


def _record(op: int, content: bytes) -> bytes:
    return struct.pack("<BQ", op, len(content)) + content


def _messages(reports: "Table", realtime_ns: int) -> Tuple[bytes, Any]:
    """All messages, one behind the other, and their times (ns)."""
    np = numpy()
    times = (reports["read_ns"] + realtime_ns).astype(np.uint64)
    head = np.dtype([("op", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"),
                     ("publish", "<u8"), ("cdr", "S4"), ("report", "V%d" % _BYTES)])
    rows = np.zeros(len(reports), head)
    rows["op"], rows["length"], rows["cdr"] = _MESSAGE, head.itemsize - 9, _CDR
    rows["sequence"] = np.arange(len(reports))
    rows["log"] = rows["publish"] = times
    # A string type would drop the zeros at its end.
    flat = rows.view(np.uint8).reshape(len(reports), head.itemsize)
    flat[:, -_BYTES:] = np.ascontiguousarray(reports).view(np.uint8).reshape(len(reports), reports.dtype.itemsize)[:, _AT : _AT + _BYTES]
    return rows.tobytes(), times


def write(path: str, reports: "Table", realtime_ns: int, device: str) -> None:
    """realtime_ns: what is added to the servo's CLOCK_MONOTONIC to give CLOCK_REALTIME."""
    schema = _record(_SCHEMA, struct.pack("<H", 1) + _text("knurl_msgs/msg/Report") + _text("ros2msg") + _text(_DEFINITION))
    channel = _record(_CHANNEL, struct.pack("<HH", 0, 1) + _text(_TOPIC) + _text("cdr") + _map({}))
    metadata = _record(_METADATA, _text("knurl python") + _map({"device": device, "realtime_offset_ns": str(realtime_ns)}))
    messages, times = _messages(reports, realtime_ns)
    head = _MAGIC + _record(_HEADER, _text("") + _text(f"knurl for Python {__version__}")) + schema + channel
    data = head + messages + metadata
    first, last = (int(times.min()), int(times.max())) if len(times) else (0, 0)
    counts = struct.pack("<QHIIIIQQ", len(times), 1, 1, 0, 1, 0, first, last)
    counts += struct.pack("<IHQ", 10, 0, len(times))
    index = _record(_METADATA_INDEX, struct.pack("<QQ", len(data) - len(metadata), len(metadata)) + _text("knurl python"))
    data += _record(_DATA_END, struct.pack("<I", zlib.crc32(data)))
    summary = schema + channel + _record(_STATISTICS, counts) + index
    footer = struct.pack("<BQQQ", _FOOTER, 20, len(data), 0)
    crc = zlib.crc32(footer, zlib.crc32(summary))
    with open(path, "wb") as file:
        file.write(data + summary + footer + struct.pack("<I", crc) + _MAGIC)


class _Content:
    """Reads the members of a record."""

    def __init__(self, content: bytes) -> None:
        self._stream = io.BytesIO(content)

    def number(self, code: str) -> int:
        return int(struct.unpack("<" + code, self._stream.read(struct.calcsize("<" + code)))[0])

    def bytes(self) -> bytes:
        return self._stream.read(self.number("I"))

    def text(self) -> str:
        return self.bytes().decode()

    def map(self) -> Dict[str, str]:
        content, values = _Content(self.bytes()), {}
        while content._stream.tell() < len(content._stream.getvalue()):
            key = content.text()
            values[key] = content.text()
        return values


def _records(file: BinaryIO) -> Any:
    while True:
        head = file.read(9)
        if len(head) < 9:
            return
        op, length = struct.unpack("<BQ", head)
        content = file.read(length)
        if len(content) < length or op in (_DATA_END, _FOOTER):
            return
        yield op, content


def read(path: str) -> Tuple["Table", str, int]:
    """Reports, device, and realtime_ns of a file that write() made. One that was cut off is read up to there."""
    np = numpy()
    found, device, realtime_ns = [], "", 0
    with open(path, "rb") as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            raise BadParameters(f"{path}: this is no MCAP file")
        for op, content in _records(file):
            if op == _MESSAGE and len(content) == 22 + len(_CDR) + _BYTES:
                found.append(content[-_BYTES:])
                if not realtime_ns:
                    realtime_ns = struct.unpack_from("<Q", content, 6)[0] - struct.unpack_from("<q", content, 26 + 16)[0]
            elif op == _METADATA:
                values = _Content(content)
                if values.text() == "knurl python":
                    device = values.map().get("device", "")
            elif op == _CHUNK:
                raise BadParameters(f"{path}: its messages are in chunks, as `knurl record` writes them; convert it with `knurl replay --csv`")
    reports = np.zeros(len(found), report_dtype())
    reports["size"] = reports.dtype.itemsize
    if found:
        bytes_of = reports.view(np.uint8).reshape(len(found), -1)
        bytes_of[:, _AT : _AT + _BYTES] = np.frombuffer(b"".join(found), np.uint8).reshape(len(found), _BYTES)
    return reports, device, realtime_ns
