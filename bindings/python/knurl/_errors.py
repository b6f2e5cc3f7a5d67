"""What goes wrong: one exception class per code of knurl.h, each with one line that says what to do."""

from __future__ import annotations

from typing import Dict, Type


class Error(RuntimeError):
    """Anything that Knurl refuses. Its text is one line: what is wrong, where, what to do."""

    code = 0
    """The knurl_code of the C library."""


class NoServo(Error):
    """Nobody listens under that name."""

    code = -1


class Permission(Error):
    """This user may not open the socket; on another host: the key is wrong."""

    code = -2


class Incompatible(Error):
    """Servo, library and package are not of one version or layout."""

    code = -3


class NoSuchDevice(Error):
    """The servo has no such device."""

    code = -4


class DeviceHeld(Error):
    """Another process holds the device."""

    code = -5
    holder = 0
    """Process number of the holder; 0: not known."""


class BadParameters(Error, ValueError):
    """Parameters are out of range. The text has the field, its value and its range."""

    code = -6


class ChannelFull(Error):
    """Too many commands at once; nothing was sent."""

    code = -7


class Refused(Error):
    """The device's state forbids it, or there is no place now."""

    code = -8


class Disconnected(Error):
    """The servo is gone."""

    code = -9


class AfterFork(Error):
    """This is the child of a fork: it has no claim. Connect anew in the child."""

    code = -10


class Stale(Error):
    """The representation was removed, or is of another claim."""

    code = -11


class Exhausted(Error):
    """This process has no descriptor left, or the socket's path is too long."""

    code = -12


class BadHandle(Error):
    """The client, hand or offline servo was closed."""

    code = -13


class BadArgument(Error, ValueError):
    """An argument makes no sense to the library."""

    code = -14


class CallbackFailed(Error):
    """A model failed without an exception of its own."""

    code = -15


class NoMemory(Error, MemoryError):
    """No memory."""

    code = -16


class Unknown(Error):
    """Anything else."""

    code = -17


def _all_classes() -> Dict[int, Type[Error]]:
    return {kind.code: kind for kind in Error.__subclasses__()}


_CLASSES = _all_classes()


def error_of(code: int, line: str, holder: int = 0) -> Error:
    """The exception for a code of the library."""
    error = _CLASSES.get(code, Unknown)(line or f"the library answered {code} without a reason")
    if isinstance(error, DeviceHeld):
        error.holder = holder
    return error
