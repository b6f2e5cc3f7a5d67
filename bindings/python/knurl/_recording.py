"""Recordings: every report of a device, in the device's own frame, in memory; as .npz, .csv or .mcap on disk."""

from __future__ import annotations

import os
import threading
import time
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, Optional, Tuple

from ._device import Device
from ._errors import BadParameters
from ._lazy import numpy
from ._reports import report_dtype

if TYPE_CHECKING:
    from ._lazy import Table
    from ._observer import Observer

_EVERY = 0.02  # s; the servo keeps 4095 reports: 0.2 s at 20 kHz


def _spread(prefix: str, names: str) -> Tuple[str, ...]:
    return tuple(prefix + name for name in names)


# The columns that `knurl replay --csv` writes, and what they are called in a report.
_COLUMNS: Tuple[Tuple[str, Tuple[str, ...]], ...] = (
    ("cycle", ("cycle",)),
    ("deadline_ns", ("deadline_ns",)),
    ("read_ns", ("read_ns",)),
    ("write_ns", ("write_ns",)),
    ("joints", _spread("q", "01234567")),
    ("position", _spread("", "xyz")),
    ("orientation", _spread("q", "wxyz")),
    ("velocity", _spread("v", "xyz")),
    ("slow_velocity", _spread("slow_v", "xyz")),
    ("angular_velocity", _spread("w", "xyz")),
    ("scene_force", _spread("scene_f", "xyz")),
    ("scene_torque", _spread("scene_t", "xyz")),
    ("sent_force", _spread("sent_f", "xyz")),
    ("sent_torque", _spread("sent_t", "xyz")),
    ("contact_point", _spread("contact_", "xyz")),
    ("state", ("state",)),
    ("faults", ("faults",)),
    ("buttons", ("buttons",)),
    ("flags", ("flags",)),
    ("late_count", ("late_count",)),
    ("presses", ("presses",)),
    ("touches", ("touches",)),
)


class Recording:
    """Every report of a device since hand.record(), or the last seconds of them (hand.ring()).

    A thread of this process collects them, through an observer of its own: they are in the device's own frame, as
    those of `knurl record`, and the hand's own reading is not disturbed. `missed` counts what was lost where Python
    stood still for longer than the servo keeps reports (4095 of them).

        with hand.record() as recording:
            ...
        recording.save("run.mcap")
    """

    def __init__(self, reports: Any = None, device: str = "") -> None:
        """Of reports that are there already, as hand.drain() gives them."""
        self.device = device
        """Name of the device."""
        self._chunks: List[Any] = [] if reports is None else [reports]
        self._seconds: Optional[float] = None
        self._observer: Optional["Observer"] = None
        self._missed = int(self._chunks[-1]["missed"][-1]) if self._chunks and len(self._chunks[-1]) else 0
        self._lock = threading.Lock()
        self._done = threading.Event()
        self._thread: Optional[threading.Thread] = None
        self._realtime_ns = time.time_ns() - time.monotonic_ns()

    @classmethod
    def _of(cls, observer: "Observer", device: Device, seconds: Optional[float]) -> "Recording":
        recording = cls(device=device.name)
        recording._observer, recording._seconds = observer, seconds
        # Of a servo on another host read_ns counts by that host's clock.
        recording._realtime_ns -= int(observer.network.clock_offset * 1e9)
        recording._thread = threading.Thread(target=recording._run, name="knurl-record", daemon=True)
        recording._thread.start()
        return recording

    def _run(self) -> None:
        while not self._done.wait(_EVERY):
            self._collect()
        self._collect()

    def _collect(self) -> None:
        assert self._observer is not None
        chunk = self._observer.drain()
        if not len(chunk):
            return
        with self._lock:
            self._chunks.append(chunk)
            self._missed = int(chunk["missed"][-1])
            if self._seconds is not None:
                self._forget_before(int(chunk["read_ns"][-1]) - int(self._seconds * 1e9))

    def _forget_before(self, read_ns: int) -> None:
        while self._chunks[0]["read_ns"][-1] < read_ns:
            del self._chunks[0]

    def stop(self) -> None:
        """Ends the recording; what there is stays. More than once does nothing."""
        thread, self._thread = self._thread, None
        if thread is None:
            return
        self._done.set()
        thread.join()
        assert self._observer is not None
        self._observer.close()

    def __enter__(self) -> "Recording":
        return self

    def __exit__(self, *error: Any) -> None:
        self.stop()

    @property
    def reports(self) -> "Table":
        """The reports so far, as a structured array with the names of Report."""
        np = numpy()
        with self._lock:
            table: "Table" = np.concatenate(self._chunks) if self._chunks else np.zeros(0, report_dtype())
        if self._seconds is not None and len(table):
            table = table[table["read_ns"] > table["read_ns"][-1] - int(self._seconds * 1e9)]
        return table

    def __len__(self) -> int:
        return len(self.reports)

    @property
    def missed(self) -> int:
        """Reports that were overwritten before they were collected."""
        return self._missed

    # ------------------------------------------------------------------ files

    def save(self, path: Any) -> None:
        """Writes .npz (NumPy), .csv (the columns of `knurl replay --csv`), or .mcap (Foxglove, PlotJuggler)."""
        path = os.fspath(path)
        save = _SAVE.get(os.path.splitext(path)[1])
        if save is None:
            raise BadParameters(f"{path}: give a name that ends in {', '.join(_SAVE)}")
        save(self, path)

    def _save_npz(self, path: str) -> None:
        numpy().savez_compressed(path, reports=self.reports, device=self.device, realtime_offset_ns=self._realtime_ns)

    def _save_csv(self, path: str) -> None:
        with open(path, "w", encoding="ascii") as file:
            file.write(",".join(name for _, names in _COLUMNS for name in names) + "\n")
            file.writelines(_csv_lines(self.reports))

    def _save_mcap(self, path: str) -> None:
        from ._mcap import write

        write(path, self.reports, self._realtime_ns, self.device)


_SAVE: Dict[str, Callable[[Recording, str], None]] = {
    ".npz": Recording._save_npz,
    ".csv": Recording._save_csv,
    ".mcap": Recording._save_mcap,
}


def _csv_lines(reports: "Table") -> Iterator[str]:
    members = [reports[member].reshape(len(reports), len(names)).tolist() for member, names in _COLUMNS]
    for row in zip(*members):
        yield ",".join(repr(number) for numbers in row for number in numbers) + "\n"


def _load_npz(path: str) -> Recording:
    with numpy().load(path) as file:
        recording = Recording(file["reports"], str(file["device"]))
        recording._realtime_ns = int(file["realtime_offset_ns"])
    return recording


def _load_csv(path: str) -> Recording:
    np = numpy()
    with open(path, encoding="ascii") as file:
        lines = [line for line in file if not line.startswith("#")]  # the guardian writes such lines first
    head, rows = lines[0].strip().split(","), [line.strip().split(",") for line in lines[1:]]
    if head != [name for _, names in _COLUMNS for name in names]:
        raise BadParameters(f"{path}: line 1 has not the columns of a report; see docs/reference/report.md")
    reports = np.zeros(len(rows), report_dtype())
    reports["size"] = reports.dtype.itemsize
    at = 0
    for member, names in _COLUMNS:
        kind = reports.dtype[member].base
        read = float if kind.kind == "f" else int
        values = [[read(text) for text in row[at : at + len(names)]] for row in rows]
        reports[member] = np.array(values, kind).reshape(reports[member].shape)
        at += len(names)
    return Recording(reports)


def load(path: Any) -> Recording:
    """Reads a recording that Recording.save() wrote, or the CSV of `knurl replay --csv`."""
    path = os.fspath(path)
    ending = os.path.splitext(path)[1]
    if ending == ".mcap":
        from ._mcap import read

        reports, device, realtime_ns = read(path)
        recording = Recording(reports, device)
        recording._realtime_ns = realtime_ns
        return recording
    if ending not in (".npz", ".csv"):
        raise BadParameters(f"{path}: give a name that ends in {', '.join(_SAVE)}")
    return _load_npz(path) if ending == ".npz" else _load_csv(path)
