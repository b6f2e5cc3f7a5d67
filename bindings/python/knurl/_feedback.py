"""What a representation does to the hand, and what follow() found."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Sequence, Tuple, Union

from . import _structs as s
from ._errors import BadParameters
from ._lazy import floats

if TYPE_CHECKING:
    from ._lazy import Array


class FeedbackFlags(enum.IntFlag):
    """Bits of Feedback.flags."""

    TOUCHING = 1
    """It acts on the hand in this cycle."""
    STIFFNESS_CLAMPED = 2
    """It is less stiff than was set."""
    INFEASIBLE = 4
    """Its contact set contradicts itself; the force is bounded."""
    FADING = 8
    """A change is still being cross-faded."""
    SILENT = 16
    """Its application has fallen silent."""


class Feedback:
    """What a representation does to the hand. The application's end feels the opposite."""

    __slots__ = ("_row",)

    def __init__(self, row: s.FeedbackRow) -> None:
        self._row: Any = row

    @property
    def force(self) -> Array:
        """Force on the hand (N), world frame."""
        return floats(self._row.force)

    @property
    def torque(self) -> Array:
        """Torque on the hand (N m), about the probe's position."""
        return floats(self._row.torque)

    @property
    def contact_point(self) -> Array:
        """Contact point (m)."""
        return floats(self._row.contact_point)

    @property
    def stiffness(self) -> float:
        """Stiffness as applied (N/m)."""
        return float(self._row.stiffness)

    @property
    def tangential_stiffness(self) -> float:
        """Stiffness of its friction as applied (N/m); 0: it has none."""
        return float(self._row.tangential_stiffness)

    @property
    def share(self) -> float:
        """Share of `force` that reached the hand (0 to 1)."""
        return float(self._row.share)

    @property
    def damping_share(self) -> float:
        """Share of the force's damping part that reached the hand (0 to 1)."""
        return float(self._row.damping_share)

    @property
    def cycle(self) -> int:
        """Cycle to which this belongs."""
        return int(self._row.cycle)

    @property
    def flags(self) -> FeedbackFlags:
        """How it acts."""
        return FeedbackFlags(self._row.flags)

    @property
    def touching(self) -> bool:
        """It acts on the hand in this cycle."""
        return bool(self._row.flags & FeedbackFlags.TOUCHING.value)

    def __repr__(self) -> str:
        x, y, z = self._row.force
        return f"<knurl.Feedback cycle {self.cycle}: ({x:.3f}, {y:.3f}, {z:.3f}) N, touching: {self.touching}>"


@dataclass
class SurfacePoint:
    """Where a model is nearest to a point."""

    foot: Sequence[float]
    """Nearest point of the surface (m), world frame."""
    normal: Sequence[float]
    """Normal there, towards free space; of any length but 0."""
    curvature: float = 0.0
    """Curvature along `axis` (1/m). Positive: hollow."""
    curvature2: float = 0.0
    """Curvature across `axis` (1/m)."""
    axis: Sequence[float] = (0.0, 0.0, 0.0)
    """Tangent direction of `curvature`; 0 0 0: that curvature in every direction."""


if TYPE_CHECKING:
    Answer = Union[SurfacePoint, Tuple[Any, Any]]
    Model = Callable[["Array"], Answer]


@dataclass(frozen=True)
class Followed:
    """What follow() found."""

    faces: int
    """Planes or caps that it set, 0 to 3; 0: there is no report yet."""
    asked: int
    """Evaluations of the model."""
    look_ahead: float
    """Share of the look-ahead that passed the check: 1, 1/2, 1/4 or 0."""
    trust: float
    """Factor by which the look-ahead was shortened before."""
    kept_side: bool
    """The nearest face was not the one by which the hand came in: the last face stays."""
    undersampled: bool
    """Between two updates the hand passes more of the surface than a plane or cap can follow."""


def followed_of(row: Any) -> Followed:
    """From the C struct."""
    return Followed(row.faces, row.asked, row.look_ahead, row.trust, bool(row.kept_side), bool(row.undersampled))


def give_answer(answer: Any, out: Any) -> None:
    """Writes what a model returned into the C struct."""
    if not isinstance(answer, SurfacePoint):
        foot, normal = answer
        answer = SurfacePoint(foot, normal)
    out.foot[:] = [float(number) for number in answer.foot]
    out.normal[:] = [float(number) for number in answer.normal]
    if not any(out.normal):
        raise BadParameters("the model's normal is 0 0 0: give the direction towards free space, of any length but 0")
    out.axis[:] = [float(number) for number in answer.axis]
    out.curvature = answer.curvature
    out.curvature2 = answer.curvature2
