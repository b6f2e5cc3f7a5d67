"""The names of the package, but for the representations, which _kinds.py has. `knurl` itself is made of the two."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Tuple

from . import _kinds
from ._assets import AssetMaterial, SentShape
from ._client import Client, connect
from ._device import Device, Limits, Network, Timing
from ._errors import (
    AfterFork,
    BadArgument,
    BadHandle,
    BadParameters,
    CallbackFailed,
    ChannelFull,
    DeviceHeld,
    Disconnected,
    Error,
    Exhausted,
    Incompatible,
    NoMemory,
    NoServo,
    NoSuchDevice,
    Permission,
    Refused,
    Stale,
    Unknown,
)
from ._feedback import Feedback, FeedbackFlags, Followed, SurfacePoint
from ._hand import Hand
from ._library import check_layout, lib
from ._observer import Observer
from ._reports import DeviceState, Faults, Frame, Report, ReportFlags, report_dtype
from ._representation import AUTOMATIC, INFINITY, Representation

if TYPE_CHECKING:
    from ._offline import Cycle, Offline
    from ._plot import plot
    from ._recording import Recording, load
    from ._simulated import Simulated, simulated

check_layout(_kinds.LAYOUT, _kinds.SIZES)


def _names_of_materials() -> Tuple[str, ...]:
    names: List[str] = []
    while True:
        name = lib.knurl_material(len(names))
        if name is None:
            return tuple(names)
        names.append(name.decode())


materials: Tuple[str, ...] = _names_of_materials()
"""Names for `Plane.made_of(...)` and every other surface."""

# What few programs need, or what needs more of Python's library, is imported when it is first used.
_LATER = {
    "Cycle": "_offline",
    "Offline": "_offline",
    "Recording": "_recording",
    "Simulated": "_simulated",
    "load": "_recording",
    "plot": "_plot",
    "simulated": "_simulated",
}


if not TYPE_CHECKING:  # every name would be known to a type checker otherwise

    def __getattr__(name: str) -> Any:
        import importlib

        return getattr(importlib.import_module("." + _LATER[name], __package__), name)


__all__ = [
    "AUTOMATIC",
    "AfterFork",
    "AssetMaterial",
    "BadArgument",
    "BadHandle",
    "BadParameters",
    "CallbackFailed",
    "ChannelFull",
    "Client",
    "Cycle",
    "Device",
    "DeviceHeld",
    "DeviceState",
    "Disconnected",
    "Error",
    "Exhausted",
    "Faults",
    "Feedback",
    "FeedbackFlags",
    "Followed",
    "Frame",
    "Hand",
    "INFINITY",
    "Incompatible",
    "Limits",
    "Network",
    "NoMemory",
    "NoServo",
    "NoSuchDevice",
    "Observer",
    "Offline",
    "Permission",
    "Recording",
    "Refused",
    "Report",
    "ReportFlags",
    "Representation",
    "SentShape",
    "Simulated",
    "Stale",
    "SurfacePoint",
    "Timing",
    "Unknown",
    "connect",
    "load",
    "materials",
    "plot",
    "report_dtype",
    "simulated",
]
