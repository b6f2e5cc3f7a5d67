"""`alive="interpreter"`: a thread that says, as long as Python runs threads at all, that the program makes progress.

The renewing itself is done by a thread of the C library, which needs no interpreter: see knurl_keep_alive.
"""

from __future__ import annotations

import os
import threading
import weakref
from typing import Any, Optional

from ._library import lib

EVERY = 0.05
"""How often the thread calls (s)."""
GRACE_NS = 1_000_000_000
"""For how long the C library goes on without a call (ns)."""

_hands: "weakref.WeakSet[Any]" = weakref.WeakSet()
_lock = threading.Lock()
_thread: Optional[threading.Thread] = None
_process = 0


def _run() -> None:
    stop = threading.Event()
    while not stop.wait(EVERY):
        with _lock:
            now = list(_hands)
        for hand in now:
            if lib.knurl_progress(hand._handle) < 0:  # closed
                with _lock:
                    _hands.discard(hand)


def watch(hand: Any) -> None:
    """From now on this hand is alive while the interpreter is."""
    global _thread, _process
    with _lock:
        _hands.add(hand)
        if _thread is None or _process != os.getpid():  # threads do not come along in a fork
            _process = os.getpid()
            _thread = threading.Thread(target=_run, name="knurl-progress", daemon=True)
            _thread.start()
