"""Knurl: a haptics server for Linux, from Python.

    import knurl, numpy as np

    with knurl.connect() as client, client.claim() as hand:     # or: with knurl.simulated() as servo, servo.connect() ...
        floor = hand.add(knurl.Plane(normal=(0, 0, 1), offset=0.005, stiffness=800))   # m, N/m
        hand.arm()
        for report in hand.reports(rate=60):                     # newest one 60 times a second
            floor.offset = 0.005 + 0.002 * np.sin(report.time)   # sent with the next commit, which reports() does

The servo computes the force 1000 times a second or more; this program describes what the hand feels. Lengths are in
m, forces in N, angles in rad, times in s; the frame is the world of the claim.
"""

from __future__ import annotations

from typing import Any

from . import _api, _kinds
from ._version import __version__

# As __init__.pyi tells it to type checkers; a star here would hide misspelt names from linters.
for _module in (_kinds, _api):
    for _name in _module.__all__:
        if _name in vars(_module):
            globals()[_name] = vars(_module)[_name]

__all__ = [*_kinds.__all__, *_api.__all__, "__version__"]


def __getattr__(name: str) -> Any:
    """What few programs need is imported when it is first used."""
    if name not in _api.__all__:
        raise AttributeError(f"module 'knurl' has no attribute '{name}'")
    value = globals()[name] = getattr(_api, name)
    return value
