"""A connection to a servo."""

from __future__ import annotations

import ctypes as c
import os
from typing import TYPE_CHECKING, Any, Callable, List, Optional, Sequence

from . import _structs as s
from ._device import Device, device_of
from ._errors import BadParameters
from ._hand import Hand
from ._library import check, lib
from ._observer import SLICE, Observer

if TYPE_CHECKING:
    from ._hand import Alive


def encoded(text: Optional[str]) -> Optional[bytes]:
    """A text for C."""
    return None if text is None else os.fsencode(text)


def _interruptibly(call: Callable[[], Any]) -> Any:
    """`call()` in a thread of its own, so that Ctrl-C arrives while the library waits."""
    import threading

    answers: List[Any] = []

    def run() -> None:
        try:
            answers.append((call(), None))
        except BaseException as error:
            answers.append((None, error))

    thread = threading.Thread(target=run, name="knurl-connect", daemon=True)
    thread.start()
    while thread.is_alive():
        thread.join(SLICE)
    answer, error = answers[0]
    if error is not None:
        raise error
    return answer


def connect(
    address: Optional[str] = None,
    *,
    name: Optional[str] = None,
    wait: float = 2.0,
    reattach: bool = True,
    hints: bool = True,
    report_rate: float = 0.0,
    key_file: Optional[str] = None,
) -> "Client":
    """Connects to a servo: "knurl:NAME", NAME or its socket's path on this box, "knurl://HOST:PORT" on another, or
    "knurl://SERVO/DEVICE", which the registry of this host (knurl-dds) looks up.

    address: None: "knurl:default". name: that `knurl ls` shows; None: the program's. wait: for a servo that starts
    (s). reattach: after a restart of the servo everything is added again (force stays off until arm()). hints: lines
    on standard error where arm() or commit() is forgotten. Of a servo on another host: report_rate, the largest rate
    of reports (Hz; 0: every one); key_file, path of your line of the bridge's keys (None: $KNURL_KEY, or no key).
    """
    options = s.ConnectOptions()
    lib.knurl_default_connect_options(c.byref(options))
    options.name = encoded(name)
    options.wait_ns = int(wait * 1e9)
    options.reattach, options.hints = int(reattach), int(hints)
    options.report_rate = report_rate
    options.key_file = encoded(key_file)
    handle = c.c_void_p()

    def call() -> None:
        check(lib.knurl_connect(encoded(address), c.byref(options), c.byref(handle)))

    _interruptibly(call) if wait > SLICE else call()
    if handle.value is None:
        raise BadParameters("the library gave no connection")
    return Client(handle.value)


class Client:
    """A connection to a servo. Made by knurl.connect(); ends with the `with` block, or close()."""

    def __init__(self, handle: int) -> None:
        self._handle: Optional[int] = handle

    def close(self) -> None:
        """Ends the connection, and all that was claimed through it. More than once does nothing."""
        handle, self._handle = self._handle, None
        if handle is not None:
            lib.knurl_close(handle)

    def __enter__(self) -> "Client":
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
    def servo_pid(self) -> int:
        """Process number of the servo; 0: not connected."""
        pid = c.c_int32()
        check(lib.knurl_servo_pid(self._handle, c.byref(pid)))
        return pid.value

    def devices(self) -> List[Device]:
        """The servo's devices."""
        found: List[Device] = []
        while True:
            row = s.DeviceRow()
            code = lib.knurl_device_at(self._handle, len(found), c.byref(row))
            check(code)
            if code != 0:
                return found
            found.append(device_of(row))

    def claim(
        self,
        device: Optional[str] = None,
        *,
        shared: bool = False,
        alive: "Alive" = "loop",
        representations: int = 128,
        workspace_radius: float = 0.0,
        workspace_centre: Sequence[float] = (0.0, 0.0, 0.0),
        update_interval: float = 0.0,
    ) -> Hand:
        """Claims a device by name; None: the only one. Raises DeviceHeld, with the holder's process number.

        shared: others may hold it as well, if they say so too. alive: see Hand.keep_alive. representations: most at
        once, 1 to 1024. workspace_radius (m): of the workspace in this program's world; 0: the device's own, scale 1.
        workspace_centre: where its middle lies there (m). update_interval: how often it means to commit (s); 0: measured.
        """
        options = s.ClaimOptions(
            shared=int(shared),
            representations=representations,
            workspace_radius=workspace_radius,
            workspace_centre=s.Vec3(*map(float, workspace_centre)),
            update_interval_ns=int(update_interval * 1e9),
        )
        handle = c.c_void_p()
        check(lib.knurl_claim(self._handle, encoded(device), c.byref(options), c.byref(handle)))
        assert handle.value is not None
        return Hand(self, handle.value, alive)

    def observe(self, device: Optional[str] = None) -> Observer:
        """Reads the reports of a device without claiming it, in the device's own frame. None: the only one."""
        handle = c.c_void_p()
        check(lib.knurl_observe(self._handle, encoded(device), c.byref(handle)))
        assert handle.value is not None
        return Observer(self, handle.value)

    def reset_fault(self, device: Optional[str] = None) -> None:
        """Leaves the fault of a device, whoever holds it. None: the only one."""
        check(lib.knurl_reset_fault_of(self._handle, encoded(device)))
