"""What a servo says of a device, of a claim and of the way between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Tuple

Triple = Tuple[float, float, float]


@dataclass(frozen=True)
class Device:
    """A device of the servo, in its own frame: origin in the middle of the workspace, x away from the base, z up."""

    name: str
    """Name by which it is claimed."""
    address: str
    """Address that the servo opened: "sim:premium15"."""
    profile: str
    """Name of its profile or product."""
    serial: str
    """Serial number; empty: it has none."""
    rate: float
    """Rate of its loop (Hz)."""
    workspace_centre: Triple
    """Middle of the workspace (m)."""
    workspace_radius: float
    """Radius of the workspace (m)."""
    peak_force: float
    """Peak force (N)."""
    peak_torque: float
    """Peak torque (N m)."""
    max_stiffness: float
    """Largest stiffness (N/m)."""
    renders_torque: bool
    """False: torque is discarded."""
    senses_orientation: bool
    """False: the orientation is that of the base."""


@dataclass(frozen=True)
class Network:
    """What lies between an application and its servo; on one box all 0."""

    lost: int
    """Reports that never came."""
    late: int
    """Reports that came after a newer one, and were dropped."""
    duplicated: int
    """Copies of reports, which were dropped."""
    resent: int
    """Batches that were sent again because no answer had come."""
    round_trip: float
    """Shortest round trip of the last exchanges (s)."""
    clock_offset: float
    """The servo's CLOCK_MONOTONIC minus ours (s)."""
    clock_uncertainty: float
    """The offset is right within this (s)."""
    drift: float
    """How much faster the servo's clock runs (s/s)."""
    drift_uncertainty: float
    """The drift is right within this (s/s)."""
    encrypted: bool
    """What is sent is encrypted."""


@dataclass(frozen=True)
class Limits:
    """What the device and its rate allow, in world units."""

    max_stiffness: float
    """Largest stiffness (N/m)."""
    max_force: float
    """Peak force (N)."""
    max_torque: float
    """Peak torque (N m)."""
    max_torsion: float
    """Largest torsional stiffness (N m/rad)."""
    damping: float
    """The device's own damping (N s/m)."""
    mass: float
    """Apparent mass at the tip (kg); 0: not known."""
    lag: float
    """Sum of all delays (s)."""
    period: float
    """Nominal period of the servo (s)."""
    resolution: float
    """Resolution at the tip (m)."""
    metre: float
    """Metres of the world that one metre of the device is."""
    newton: float
    """Newtons of the world that one newton of the device is."""


@dataclass(frozen=True)
class Timing:
    """How late this application is, as measured by the servo."""

    age_at_use: float
    """Age of a report when the first force that was computed from its answer had been written (s); 0: not measured yet."""
    interval: float
    """Time between commits (s)."""
    batches: int
    """Batches that the servo has taken."""
    refused: int
    """Batches that the servo refused by its own check."""
    undersampled: int
    """Calls of follow() that were too seldom for the surface's curvature."""


def triple(numbers: Any) -> Triple:
    """x, y, z of the C struct."""
    x, y, z = numbers
    return x, y, z


def device_of(row: Any) -> Device:
    """From the C struct."""
    texts = {name: getattr(row, name).decode(errors="replace") for name in ("name", "address", "profile", "serial")}
    numbers = {name: getattr(row, name) for name in ("rate", "workspace_radius", "peak_force", "peak_torque", "max_stiffness")}
    return Device(
        **texts,
        **numbers,
        workspace_centre=triple(row.workspace_centre),
        renders_torque=bool(row.renders_torque),
        senses_orientation=bool(row.senses_orientation),
    )


def network_of(row: Any) -> Network:
    """From the C struct."""
    counts = {name: getattr(row, name) for name in ("lost", "late", "duplicated", "resent", "drift", "drift_uncertainty")}
    return Network(
        **counts,
        round_trip=row.round_trip_ns * 1e-9,
        clock_offset=row.clock_offset_ns * 1e-9,
        clock_uncertainty=row.clock_uncertainty_ns * 1e-9,
        encrypted=bool(row.encrypted),
    )


def limits_of(row: Any) -> Limits:
    """From the C struct."""
    return Limits(**{name: getattr(row, name) for name in Limits.__dataclass_fields__})


def timing_of(row: Any) -> Timing:
    """From the C struct."""
    return Timing(row.age_at_use_ns * 1e-9, row.interval_ns * 1e-9, row.batches, row.refused, row.undersampled)
