"""Memory for the arrays of drain(): what a program has let go of is used again, since new pages cost more than the reports."""

from __future__ import annotations

import ctypes as c
from typing import TYPE_CHECKING, Any, List

from ._lazy import numpy
from ._reports import report_dtype

if TYPE_CHECKING:
    from ._lazy import Table

ROOM = 4096  # reports that the servo keeps
_BYTES = ROOM * 400
_FEW = ROOM // 8
_SPARE = 4  # of 1.6 MB, for each reader


class _Loan(c.c_char * _BYTES):  # type: ignore[misc]
    """Memory of a room as long as any array lies in it: NumPy keeps this object alive, and its end gives the room back."""

    spare: List[Any]
    room: Any

    def __del__(self) -> None:
        give_back(self.spare, self.room)


def give_back(spare: List[Any], room: Any) -> None:
    """Keeps it for the next drain(). From any thread: append is atomic."""
    if len(spare) < _SPARE:
        spare.append(room)


def take(spare: List[Any]) -> Any:
    """An array of ROOM reports in which no other array lies."""
    try:
        return spare.pop()
    except IndexError:
        return numpy().empty(ROOM, report_dtype())


def lend(spare: List[Any], room: Any, count: int) -> "Table":
    """The first `count` reports of the room, which comes back when nobody refers to them any more."""
    if count < _FEW:
        few: "Table" = room[:count].copy()
        give_back(spare, room)
        return few
    loan = _Loan.from_buffer(room)
    loan.spare, loan.room = spare, room
    many: "Table" = numpy().frombuffer(loan, report_dtype(), count)
    return many
