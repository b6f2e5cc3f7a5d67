"""Finds the C libraries, checks that they belong to this package, and binds their functions.

`lib.knurl_commit(...)` and the others are the functions of knurl.h. Where a wheel has libraries of its own in
knurl/lib, those are taken before the system's.
"""

from __future__ import annotations

import ctypes as c
import os
from typing import Any, List, Optional, Tuple

from . import _structs as s
from ._errors import Incompatible, error_of
from ._version import __version__

_HERE = os.path.dirname(os.path.abspath(__file__))
_PACKAGED = os.path.join(_HERE, "lib")

_P = c.c_void_p  # handle, struct, or array
_S = c.c_char_p
_U32, _U64, _I64, _F, _N = c.c_uint32, c.c_uint64, c.c_int64, c.c_double, c.c_size_t

# Arguments of every function of knurl.h. All return a knurl_code but those of _OTHER_RESULTS.
_ARGUMENTS = {
    "knurl_version": [],
    "knurl_layout": [],
    "knurl_error": [_P],
    "knurl_holder": [],
    "knurl_close": [_P],
    "knurl_default_connect_options": [_P],
    "knurl_connect": [_S, _P, _P],
    "knurl_connected": [_P, _P],
    "knurl_servo_pid": [_P, _P],
    "knurl_device_at": [_P, _U32, _P],
    "knurl_reset_fault_of": [_P, _S],
    "knurl_default_claim_options": [_P],
    "knurl_claim": [_P, _S, _P, _P],
    "knurl_observe": [_P, _S, _P],
    "knurl_newest": [_P, _I64, _P],
    "knurl_latest": [_P, _P],
    "knurl_next_report": [_P, _I64, _P],
    "knurl_reports": [_P, _P, _N, _P],
    "knurl_fd": [_P, _P],
    "knurl_missed": [_P, _P],
    "knurl_reattachments": [_P, _P],
    "knurl_device_of": [_P, _P],
    "knurl_age": [_P, _I64, _P, _P],
    "knurl_network_of": [_P, _P],
    "knurl_default_add_options": [_P],
    "knurl_add": [_P, _U32, _P, _P, _P],
    "knurl_set": [_P, _U64, _U32, _P],
    "knurl_get": [_P, _U64, _U32, _P],
    "knurl_remove": [_P, _U64],
    "knurl_validate": [_U32, _P],
    "knurl_default": [_U32, _P, _U64],
    "knurl_made_of": [_U32, _S, _P],
    "knurl_material": [_U32],
    "knurl_place_probe": [_P, _U32, _P, _F],
    "knurl_begin_group": [_P],
    "knurl_end_group": [_P],
    "knurl_cancel_group": [_P],
    "knurl_feedback_of": [_P, _U64, _P],
    "knurl_applied_stiffness": [_P, _U64, _P],
    "knurl_arm": [_P],
    "knurl_disarm": [_P],
    "knurl_reset_fault": [_P],
    "knurl_commit": [_P, _P],
    "knurl_wait_applied": [_P, _U64, _I64],
    "knurl_keep_alive": [_P, _I64],
    "knurl_progress": [_P],
    "knurl_limits_of": [_P, _P],
    "knurl_timing_of": [_P, _P],
    "knurl_predicted_position": [_P, _P],
    "knurl_follow": [_P, _U64, _P, _P, _F, _P],
    "knurl_send_mesh": [_P, _P, _P],
    "knurl_send_heights": [_P, _P, _P],
    "knurl_begin_sending_mesh": [_P, _P, _P],
    "knurl_begin_sending_heights": [_P, _P, _P],
    "knurl_sending_done": [_P, _I64, _P],
    "knurl_sending_fd": [_P, _P],
    "knurl_forget": [_P, _U32],
    "knurl_kind_at": [_U32, _P, _P],
    "knurl_field_at": [_U32, _U32, _P],
    "knurl_choice_at": [_U32, _U32, _U32, _P],
}
_OFFLINE_ARGUMENTS = {
    "knurl_offline_default_options": [_P],
    "knurl_offline_open": [_S, _P, _P],
    "knurl_offline_close": [_P],
    "knurl_offline_error": [],
    "knurl_offline_add": [_P, _U32, _P, _P, _P],
    "knurl_offline_set": [_P, _U64, _U32, _P],
    "knurl_offline_remove": [_P, _U64],
    "knurl_offline_place_probe": [_P, _U32, _P, _F],
    "knurl_offline_send_mesh": [_P, _P, _P],
    "knurl_offline_send_heights": [_P, _P, _P],
    "knurl_offline_step": [_P, _P, _P],
    "knurl_offline_run": [_P, _P, _N, _P],
    "knurl_offline_feedback_of": [_P, _U64, _P],
    "knurl_offline_reset": [_P],
}
_OTHER_RESULTS = {
    "knurl_version": _S,
    "knurl_layout": _U64,
    "knurl_error": _S,
    "knurl_holder": c.c_int32,
    "knurl_material": _S,
    "knurl_default_connect_options": None,
    "knurl_default_claim_options": None,
    "knurl_default_add_options": None,
    "knurl_offline_default_options": None,
    "knurl_offline_error": _S,
}


def candidates(name: str) -> List[str]:
    """Where a library of this name may be, the first that is there wins."""
    stated = os.environ.get("KNURL_LIBRARY_DIR")
    if stated:
        return [os.path.join(stated, name)]
    packaged = os.path.join(_PACKAGED, name)
    return [packaged] if os.path.exists(packaged) else [name]


def _bound(name: str, arguments: Any) -> c.CDLL:
    path = candidates(name)[0]
    try:
        library = c.CDLL(path)
    except OSError as error:
        raise ImportError(
            f"{path} cannot be loaded ({error}); install Knurl's library, or set KNURL_LIBRARY_DIR to its folder"
        ) from None
    for function, types in arguments.items():
        try:
            bound = getattr(library, function)
        except AttributeError:
            raise ImportError(
                f"{path} has no {function}: it is not the library of knurl {__version__} for Python"
            ) from None
        bound.argtypes = types
        bound.restype = _OTHER_RESULTS.get(function, c.c_int)
    return library


def _check_version(library: c.CDLL) -> None:
    version = library.knurl_version().decode()
    if version != __version__:
        raise Incompatible(
            f"libknurl.so.0 is of version {version}, the Python package knurl of {__version__}; install both of one version"
        )
    for fill, struct in (
        (library.knurl_default_connect_options, s.ConnectOptions),
        (library.knurl_default_claim_options, s.ClaimOptions),
        (library.knurl_default_add_options, s.AddOptions),
    ):
        row = struct()
        fill(c.byref(row))
        if row.size != c.sizeof(struct):
            raise Incompatible(
                f"libknurl.so.0 has {row.size} bytes where the Python package has {c.sizeof(struct)} for {struct.__doc__}; "
                "install both of one version"
            )


def _load() -> c.CDLL:
    library = _bound("libknurl.so.0", _ARGUMENTS)
    _check_version(library)
    return library


lib = _load()

_offline: Optional[c.CDLL] = None


def offline() -> c.CDLL:
    """The library of the servo in this process, loaded when it is first wanted."""
    global _offline
    if _offline is None:
        _offline = _bound("libknurl-offline.so.0", _OFFLINE_ARGUMENTS)
    return _offline


def check(code: int) -> None:
    """Raises what the library says of a failed call. Call it in the thread of that call, before any other."""
    if code < 0:
        line = lib.knurl_error(None)
        raise error_of(code, (line or b"").decode(errors="replace"), lib.knurl_holder() if code == -5 else 0)


def check_layout(layout: int, sizes: Tuple[int, ...]) -> None:
    """Compares the tables from which _kinds.py was made with those of the library that was loaded."""
    if layout == lib.knurl_layout():
        found: List[int] = []
        name, size = _S(), _U64()
        while lib.knurl_kind_at(len(found), c.byref(name), c.byref(size)) == 0:
            found.append(size.value)
        if tuple(found) == sizes:
            return
    raise Incompatible(
        "libknurl.so.0 is of another build than the Python package knurl: their representations differ; "
        "install both of one version"
    )
