"""Reports: one cycle of a device, in the claim's world frame (of an observer: in the device's)."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING, Any

from . import _structs as s
from ._lazy import floats, numpy

if TYPE_CHECKING:
    from ._lazy import Array


class DeviceState(enum.IntEnum):
    """State of a device."""

    DISCONNECTED = 0
    """It does not answer; no force."""
    IDLE = 1
    """Positions are read; no force."""
    ARMED = 2
    """Claimed and calibrated, gain 0; it waits for a slow hand."""
    RAMP_UP = 3
    """The force ramps up."""
    ACTIVE = 4
    """The whole force."""
    RAMP_DOWN = 5
    """The force ramps down."""
    FAULT = 6
    """No force, latched until a reset."""


class ReportFlags(enum.IntFlag):
    """Bits of Report.flags."""

    CLAMPED = 1
    """The supervisor reduced the wrench in this cycle."""
    STALE = 2
    """No new joint sample in this cycle."""
    GUARDIAN = 4
    """The guardian had put the motors to zero before this cycle."""
    TOUCHING = 8
    """A surface is touched."""
    NEAR_SINGULAR = 16
    """The arm hardly moves, and pushes badly, in one direction."""
    AT_JOINT_LIMIT = 32
    """A joint is within 1 % of its range of a stop."""


class Faults(enum.IntFlag):
    """Bits of Report.faults."""

    NOT_FINITE = 1 << 0
    SLEW = 1 << 1
    SPEED = 1 << 2
    POWER = 1 << 3
    UNPLUGGED = 1 << 4
    BAD_SAMPLES = 1 << 5
    ENCODER_JUMP = 1 << 6
    CLOCK_JUMP = 1 << 7
    KINEMATICS = 1 << 8
    GUARDIAN = 1 << 9
    OVERLOAD = 1 << 10
    UNGUARDED = 1 << 11


class Report:
    """One cycle of a device. Vectors are arrays of 3 (m, m/s, N, N m), quaternions of 4 (w x y z)."""

    __slots__ = ("_origin_ns", "_row")

    def __init__(self, row: s.ReportRow, origin_ns: int) -> None:
        self._row: Any = row
        self._origin_ns = origin_ns

    @property
    def time(self) -> float:
        """Seconds of the servo's monotonic clock since the first report that this hand gave: `read_ns`, counted from there."""
        return float((self._row.read_ns - self._origin_ns) * 1e-9)

    @property
    def cycle(self) -> int:
        """Number of the cycle."""
        return int(self._row.cycle)

    @property
    def deadline_ns(self) -> int:
        """When the cycle should have begun (ns of the servo's CLOCK_MONOTONIC)."""
        return int(self._row.deadline_ns)

    @property
    def read_ns(self) -> int:
        """When the joint sample had been read (ns)."""
        return int(self._row.read_ns)

    @property
    def write_ns(self) -> int:
        """When the efforts had been written (ns)."""
        return int(self._row.write_ns)

    @property
    def joints(self) -> Array:
        """Positions of the joints (rad; m if prismatic), 8 of them."""
        return floats(self._row.joints)

    @property
    def position(self) -> Array:
        """Position of the tip (m)."""
        return floats(self._row.position)

    @property
    def orientation(self) -> Array:
        """Orientation of the tip."""
        return floats(self._row.orientation)

    @property
    def velocity(self) -> Array:
        """Velocity of the tip, smooth (m/s)."""
        return floats(self._row.velocity)

    @property
    def slow_velocity(self) -> Array:
        """Velocity of the tip by a first-order filter of 20 Hz, for prediction (m/s)."""
        return floats(self._row.slow_velocity)

    @property
    def angular_velocity(self) -> Array:
        """Angular velocity of the tip (rad/s)."""
        return floats(self._row.angular_velocity)

    @property
    def scene_force(self) -> Array:
        """Sum of the scenes' forces before the supervisor (N)."""
        return floats(self._row.scene_force)

    @property
    def scene_torque(self) -> Array:
        """Sum of the scenes' torques about `position` (N m)."""
        return floats(self._row.scene_torque)

    @property
    def sent_force(self) -> Array:
        """Force after the supervisor (N)."""
        return floats(self._row.sent_force)

    @property
    def sent_torque(self) -> Array:
        """Torque after the supervisor (N m)."""
        return floats(self._row.sent_torque)

    @property
    def contact_point(self) -> Array:
        """Contact point (m) of probe 0 of the first claim in contact; else the probe's position."""
        return floats(self._row.contact_point)

    @property
    def state(self) -> DeviceState:
        """State of the device."""
        return DeviceState(self._row.state)

    @property
    def faults(self) -> Faults:
        """Why the device is in a fault; 0: it is in none."""
        return Faults(self._row.faults)

    @property
    def buttons(self) -> int:
        """Bit mask of the buttons that are down."""
        return int(self._row.buttons)

    @property
    def flags(self) -> ReportFlags:
        """What was special in this cycle."""
        return ReportFlags(self._row.flags)

    @property
    def touching(self) -> bool:
        """A surface is touched in this cycle."""
        return bool(self._row.flags & ReportFlags.TOUCHING.value)

    @property
    def late_count(self) -> int:
        """Cycles so far whose write ended after the next deadline."""
        return int(self._row.late_count)

    @property
    def presses(self) -> int:
        """A bit per button that flips whenever the button goes down."""
        return int(self._row.presses)

    @property
    def touches(self) -> int:
        """How often a touch began, so far."""
        return int(self._row.touches)

    @property
    def missed(self) -> int:
        """Reports that this reader never saw, in all."""
        return int(self._row.missed)

    @property
    def unread(self) -> int:
        """Newer reports that are there."""
        return int(self._row.unread)

    def __repr__(self) -> str:
        x, y, z = self._row.position
        state = self._row.state
        name = DeviceState(state).name.lower() if state <= 6 else str(state)
        return f"<knurl.{type(self).__name__} cycle {self.cycle} at ({x:.5f}, {y:.5f}, {z:.5f}) m, {name}>"


class Frame(Report):
    """The newest report, and what happened since the call of newest() before."""

    __slots__ = ("_frame",)

    def __init__(self, frame: s.FrameRow, origin_ns: int) -> None:
        super().__init__(frame.report, origin_ns)
        self._frame: Any = frame

    @property
    def pressed(self) -> int:
        """A bit for each button that went down at least once."""
        return int(self._frame.pressed)

    @property
    def released(self) -> int:
        """A bit for each button that came up at least once."""
        return int(self._frame.released)

    @property
    def touched(self) -> bool:
        """The hand touched a surface of any claim on the device, though it may not touch it now."""
        return bool(self._frame.touched)

    @property
    def touches(self) -> int:
        """Number of contacts that began since the frame before (a Report's counts all)."""
        return int(self._frame.touches)

    @property
    def skipped(self) -> int:
        """Cycles between the two frames."""
        return int(self._frame.skipped)


_dtype: Any = None


def report_dtype() -> Any:
    """The structured type of what drain() returns: knurl_report, with its names and offsets."""
    global _dtype
    if _dtype is None:
        dtype = numpy().dtype(s.ReportRow)
        assert dtype.itemsize == 400 and dtype.fields["cycle"][1] == 8, "knurl_report is laid out otherwise here"
        _dtype = dtype
    return _dtype
