"""Reading the reports of a device: in order, the newest, many at once, in an asyncio loop."""

from __future__ import annotations

import ctypes as c
import time
from typing import TYPE_CHECKING, Any, AsyncIterator, Callable, Dict, Iterator, List, Optional, Tuple, Union, overload

from . import _structs as s
from ._device import Device, Network, device_of, network_of
from ._errors import BadParameters, Disconnected
from ._lazy import numpy
from ._library import check, lib
from ._reports import Frame, Report, report_dtype

if TYPE_CHECKING:
    from ._lazy import Table
    from ._recording import Recording

SLICE = 0.05
"""Longest wait inside the library (s): Ctrl-C arrives in between."""


def slices(timeout: Optional[float]) -> Iterator[int]:
    """Waits of at most SLICE (ns) that add up to `timeout` (s; None: for ever); at least one."""
    if timeout is not None and timeout <= SLICE:
        yield max(0, int(timeout * 1e9))
        return
    end = None if timeout is None else time.monotonic() + timeout
    while True:
        left = SLICE if end is None else end - time.monotonic()
        if left <= 0:
            return
        yield int(min(left, SLICE) * 1e9)


def _checked(out: Any) -> Any:
    """An array that the library may fill; else BadParameters."""
    if not isinstance(out, numpy().ndarray) or out.dtype != report_dtype() or out.ndim != 1:
        raise BadParameters("out is no array of reports; make one with numpy.empty(4096, knurl.report_dtype())")
    if not (out.flags.c_contiguous and out.flags.writeable and out.flags.aligned):
        raise BadParameters("out is an array with gaps, or one that cannot be written; give a whole one")
    return out


class Pace:
    """So many turns a second. One that comes too late is not made up for."""

    def __init__(self, rate: float) -> None:
        if not 0 < rate < 1e6:
            raise BadParameters(f"rate is {rate}: turns a second, more than 0, are needed")
        self._period = 1.0 / rate
        self._next = time.monotonic()

    def left(self) -> float:
        """Seconds until the next turn; counts it."""
        now = time.monotonic()
        left = self._next - now
        self._next = max(self._next, now - self._period) + self._period
        return left


class Observer:
    """Reads the reports of a device without holding it, in the device's own frame. Made by `client.observe()`."""

    def __init__(self, client: Any, handle: int) -> None:
        self._client = client
        self._handle: Optional[int] = handle
        self._origin_ns: Optional[int] = None
        self._rooms: List[Any] = []
        self._on_close: Dict[int, Callable[[], None]] = {}

    # ------------------------------------------------------------------ life

    def close(self) -> None:
        """Ends it; of a hand: the force fades and the device is free. More than once does nothing."""
        for end in list(self._on_close.values()):
            end()
        self._on_close.clear()
        handle, self._handle = self._handle, None
        if handle is not None:
            lib.knurl_close(handle)

    def __enter__(self) -> "Observer":
        return self

    def __exit__(self, *error: Any) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_handle", None) is not None and lib is not None:
            lib.knurl_close(self._handle)
            self._handle = None

    @property
    def connected(self) -> bool:
        """False: the servo is gone, and not back yet."""
        there = c.c_uint32()
        check(lib.knurl_connected(self._handle, c.byref(there)))
        return bool(there.value)

    @property
    def reattachments(self) -> int:
        """How often the servo came back."""
        count = c.c_uint64()
        check(lib.knurl_reattachments(self._handle, c.byref(count)))
        return count.value

    @property
    def device(self) -> Device:
        """What the servo says about the device."""
        row = s.DeviceRow()
        check(lib.knurl_device_of(self._handle, c.byref(row)))
        return device_of(row)

    @property
    def network(self) -> Network:
        """What lies between here and the servo; on one box all 0."""
        row = s.NetworkRow()
        check(lib.knurl_network_of(self._handle, c.byref(row)))
        return network_of(row)

    # ------------------------------------------------------------------ one report

    def _origin(self, read_ns: int) -> int:
        if self._origin_ns is None:
            self._origin_ns = read_ns
        return self._origin_ns

    def _waited(self, call: Any, timeout: Optional[float], row: Any) -> bool:
        """`call(handle, ns, row)` in slices; False: nothing came in time."""
        out = c.byref(row)
        for wait in slices(timeout):
            began = time.monotonic()
            code = call(self._handle, wait, out)
            if code == 0:
                return True
            check(code)
            # Where the servo is gone the library does not wait; this must not become a loop at full speed.
            rest = wait * 1e-9 - (time.monotonic() - began)
            if rest > 1e-3:
                time.sleep(min(rest, 0.01))
        return False

    def newest(self, timeout: Optional[float] = 0.05) -> Optional[Frame]:
        """The newest report, with all that happened since the call before; waits for one that was not read.

        `timeout`: s; None: for ever. Returns None if no report came in time, or the servo is gone.
        """
        row = s.FrameRow()
        row.report.size = c.sizeof(s.ReportRow)
        if not self._waited(lib.knurl_newest, timeout, row):
            return None
        return Frame(row, self._origin(row.report.read_ns))

    def latest(self) -> Optional[Report]:
        """The newest report, though it may have been read already. None: there is none, or the servo is gone."""
        row = s.ReportRow()
        code = lib.knurl_latest(self._handle, c.byref(row))
        check(code)
        return Report(row, self._origin(row.read_ns)) if code == 0 else None

    def next_report(self, timeout: Optional[float] = 0.05) -> Optional[Report]:
        """The next report in order, waiting for it for at most `timeout` (s; None: for ever)."""
        row = s.ReportRow()
        if not self._waited(lib.knurl_next_report, timeout, row):
            return None
        return Report(row, self._origin(row.read_ns))

    # ------------------------------------------------------------------ many

    def drain(self, out: Optional["Table"] = None) -> "Table":
        """All reports that were not read, in order, as a structured array with the names of Report. Does not wait.

        `array["position"]` is of shape (n, 3); `missed` of a row counts what was overwritten before it.

        `out`: an array of the type knurl.report_dtype(), which is filled from its beginning with as many as it has
        room for; the result is that part of it. Without it the array is the caller's to keep. The memory of those
        that were let go is used again.
        """
        if out is not None:
            return out[: self._drain_into(_checked(out))] if len(out) else out
        from . import _rooms

        room = _rooms.take(self._rooms)
        try:
            count = self._drain_into(room)
        except BaseException:
            _rooms.give_back(self._rooms, room)
            raise
        return _rooms.lend(self._rooms, room, count)

    def _drain_into(self, room: Any) -> int:
        count = c.c_size_t()
        room["size"][0] = room.itemsize
        check(lib.knurl_reports(self._handle, room.ctypes.data, len(room), c.byref(count)))
        if count.value and self._origin_ns is None:
            self._origin(int(room["read_ns"][0]))
        return count.value

    def seconds(self, read_ns: Any) -> Any:
        """Report.time of these `read_ns`: a number, or an array of drain()."""
        return (read_ns - self._origin_ns) * 1e-9 if self._origin_ns is not None else read_ns * 0.0

    @property
    def missed(self) -> int:
        """Reports that were overwritten before they were read."""
        count = c.c_uint64()
        check(lib.knurl_missed(self._handle, c.byref(count)))
        return count.value

    def age(self, report: Report) -> Tuple[float, float]:
        """How old a report is now by the servo's clock, and within what that is right (s)."""
        age, within = c.c_int64(), c.c_int64()
        check(lib.knurl_age(self._handle, report.read_ns, c.byref(age), c.byref(within)))
        return age.value * 1e-9, within.value * 1e-9

    def fileno(self) -> int:
        """A descriptor for select, poll, asyncio: readable while a report is there that was not read."""
        fd = c.c_int()
        check(lib.knurl_fd(self._handle, c.byref(fd)))
        return fd.value

    # ------------------------------------------------------------------ loops

    def _turn(self) -> None:
        """Between two turns of a loop; a hand commits."""

    @overload
    def reports(self, rate: None = None, timeout: Optional[float] = None) -> Iterator[Report]:
        ...

    @overload
    def reports(self, rate: float, timeout: Optional[float] = None) -> Iterator[Frame]:
        ...

    def reports(self, rate: Optional[float] = None, timeout: Optional[float] = None) -> Iterator[Union[Report, Frame]]:
        """Reports for a loop: the newest one `rate` times a second, or every one in order (None).

        A hand commits after each turn. `timeout`: s without a report after which Disconnected is raised; None: it
        waits, also for a servo that restarts.
        """
        pace = None if rate is None else Pace(rate)
        while True:
            if pace is None:
                report: Optional[Report] = self.next_report(timeout)
            else:
                left = pace.left()
                if left > 0:
                    time.sleep(left)
                report = self.newest(timeout)
            if report is None:
                raise Disconnected(f"no report came for {timeout} s" + ("" if self.connected else ": the servo is gone"))
            yield report
            self._turn()

    @overload
    def areports(self, rate: None = None) -> AsyncIterator[Report]:
        ...

    @overload
    def areports(self, rate: float) -> AsyncIterator[Frame]:
        ...

    async def areports(self, rate: Optional[float] = None) -> AsyncIterator[Union[Report, Frame]]:
        """As reports(), for `async for`. One such loop at a time on each hand."""
        import asyncio

        pace = None if rate is None else Pace(rate)
        read = self.next_report if rate is None else self.newest
        while True:
            await asyncio.sleep(0 if pace is None else max(0.0, pace.left()))
            report = read(0)
            while report is None:
                await self._readable()
                report = read(0)
            yield report
            self._turn()

    async def _readable(self) -> None:
        import asyncio

        loop = asyncio.get_running_loop()
        fd = self.fileno()
        ready = asyncio.Event()
        loop.add_reader(fd, ready.set)
        try:
            await ready.wait()
        finally:
            loop.remove_reader(fd)

    # ------------------------------------------------------------------ recordings

    def record(self) -> "Recording":
        """Begins to record every report of the device, in the device's own frame. See knurl.Recording."""
        return self._recording(None)

    def ring(self, seconds: float = 10.0) -> "Recording":
        """As record(), but keeps the last `seconds` alone."""
        return self._recording(seconds)

    def _recording(self, seconds: Optional[float]) -> "Recording":
        from ._recording import Recording

        device = self.device
        recording = Recording._of(self._client.observe(device.name), device, seconds)
        self._on_close[id(recording)] = recording.stop
        return recording
