"""Reports as an MCAP file: topics, schemas and encoding of `knurl record`, without chunks and compression.

Foxglove and PlotJuggler plot it; pose, wrench and transform are there for 3D views, 100 times a second. `knurl replay` needs the cycle's inputs, too, which only `knurl record` has.
"""

from __future__ import annotations

import io
import re
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


# Definitions of ROS 2; each but the first line's type behind its name.
_HEADER_OF_ROS = {"std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
                  "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n"}
_VECTOR = {"geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n"}
_QUATERNION = {"geometry_msgs/Quaternion": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"}
_VIEW_EVERY = 10_000_000  # ns


class _View:
    """A channel with a fixed number of doubles behind header and frames."""

    def __init__(self, topic: str, type_: str, definition: str, needs: Dict[str, str], members: Tuple[str, str], child: bool = False) -> None:
        self.topic, self.members, self.child = topic, members, child
        self.name = type_.replace("/", "/msg/")
        self.definition = definition + "".join("=" * 80 + f"\nMSG: {name}\n{text}" for name, text in needs.items())

    def messages(self, channel: int, reports: "Table", times: Any, base: str) -> bytes:
        np = numpy()
        # Between the stamp and the doubles, which CDR aligns to 8 behind its first four bytes.
        frames = _cdr_text(base, 12 if self.child else 8)
        if self.child:
            frames += _cdr_text(base[:-len("base")] + "hand", 12 + len(frames))
        at = (12 if self.child else 8) + len(frames)
        frames += b"\0" * (-at % 8)
        columns = [reports[member][:, [1, 2, 3, 0]] if member == "orientation" else reports[member] for member in self.members]
        values = np.concatenate(columns, axis=1)
        count = [("count", "<u4")] if self.child else []
        head = np.dtype([("op", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"), ("publish", "<u8"),
                         ("cdr", "V4"), *count, ("sec", "<i4"), ("nanosec", "<u4"), ("frames", "V%d" % len(frames)),
                         ("values", "<f8", values.shape[1])])
        rows = np.zeros(len(reports), head)
        rows["op"], rows["length"], rows["channel"] = _MESSAGE, head.itemsize - 9, channel
        rows["sequence"] = np.arange(len(reports))
        rows["log"] = rows["publish"] = times
        rows["cdr"], rows["frames"] = np.void(_CDR), np.void(frames)
        if self.child:
            rows["count"] = 1
        rows["sec"], rows["nanosec"] = times // 1_000_000_000, times % 1_000_000_000
        rows["values"] = values
        return bytes(rows.tobytes())


def _views(device: str) -> Tuple[_View, ...]:
    pose = {**_HEADER_OF_ROS, "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
            "geometry_msgs/Point": _VECTOR["geometry_msgs/Vector3"], **_QUATERNION}
    wrench = {**_HEADER_OF_ROS, "geometry_msgs/Wrench": "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n", **_VECTOR}
    tree = {"geometry_msgs/TransformStamped": "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
            **_HEADER_OF_ROS, "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
            **_VECTOR, **_QUATERNION}
    return (_View(f"/{device}/measured_cp", "geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n", pose,
                  ("position", "orientation")),
            _View(f"/{device}/measured_cf", "geometry_msgs/WrenchStamped", "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n", wrench,
                  ("sent_force", "sent_torque")),
            _View("/tf", "tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n", tree, ("position", "orientation"), True))


def _cdr_text(text: str, at: int) -> bytes:
    """A text where `at` bytes of the body stand before it."""
    said = text.encode() + b"\0"
    return b"\0" * (-at % 4) + struct.pack("<I", len(said)) + said


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
    rows["op"], rows["length"], rows["channel"], rows["cdr"] = _MESSAGE, head.itemsize - 9, 1, _CDR
    rows["sequence"] = np.arange(len(reports))
    rows["log"] = rows["publish"] = times
    # A string type would drop the zeros at its end.
    flat = rows.view(np.uint8).reshape(len(reports), head.itemsize)
    flat[:, -_BYTES:] = np.ascontiguousarray(reports).view(np.uint8).reshape(len(reports), reports.dtype.itemsize)[:, _AT : _AT + _BYTES]
    return rows.tobytes(), times


def write(path: str, reports: "Table", realtime_ns: int, device: str) -> None:
    """realtime_ns: what is added to the servo's CLOCK_MONOTONIC to give CLOCK_REALTIME."""
    name = re.sub("[.-]", "_", device or "knurl")  # what ROS takes
    views = _views(name)
    messages, times = _messages(reports, realtime_ns)
    kinds = [("knurl_msgs/msg/Report", _DEFINITION, f"/{name}/report"), *((view.name, view.definition, view.topic) for view in views)]
    definitions = b"".join(_record(_SCHEMA, struct.pack("<H", i) + _text(kind) + _text("ros2msg") + _text(text))
                           for i, (kind, text, _) in enumerate(kinds, 1))
    definitions += b"".join(_record(_CHANNEL, struct.pack("<HH", i, i) + _text(topic) + _text("cdr") + _map({}))
                            for i, (_, _, topic) in enumerate(kinds, 1))
    shown = numpy().diff(times // _VIEW_EVERY, prepend=0) > 0
    for channel, view in enumerate(views, 2):
        messages += view.messages(channel, reports[shown], times[shown], f"{name}_base")
    metadata = _record(_METADATA, _text("knurl python") + _map({"device": device, "realtime_offset_ns": str(realtime_ns)}))
    head = _MAGIC + _record(_HEADER, _text("") + _text(f"knurl for Python {__version__}")) + definitions
    data = head + messages + metadata
    first, last = (int(times.min()), int(times.max())) if len(times) else (0, 0)
    each = [len(times)] + [int(shown.sum())] * len(views)
    counts = struct.pack("<QHIIIIQQ", sum(each), len(each), len(each), 0, 1, 0, first, last)
    counts += struct.pack("<I", 10 * len(each)) + b"".join(struct.pack("<HQ", i, n) for i, n in enumerate(each, 1))
    index = _record(_METADATA_INDEX, struct.pack("<QQ", len(data) - len(metadata), len(metadata)) + _text("knurl python"))
    data += _record(_DATA_END, struct.pack("<I", zlib.crc32(data)))
    summary = definitions + _record(_STATISTICS, counts) + index
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
