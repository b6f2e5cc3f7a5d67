"""The servo's own cycle in this process, on a virtual clock: for tests, plots and programs that learn."""

from __future__ import annotations

import ctypes as c
from typing import TYPE_CHECKING, Any, Dict, Optional, Sequence, TypeVar

from . import _structs as s
from ._assets import AssetMaterial, SentShape, heights_of_image, pack_heights, pack_mesh, sent_of
from ._errors import BadParameters, Refused, error_of
from ._feedback import Feedback
from ._hand import add_options
from ._lazy import floats, numpy
from ._library import offline
from ._reports import ReportFlags
from ._representation import Owner, Representation

if TYPE_CHECKING:
    from ._feedback import Followed, Model
    from ._hand import OnSilence
    from ._lazy import Array, Table

_R = TypeVar("_R", bound=Representation)


class Cycle:
    """One cycle: what the hand felt. Vectors are arrays of 3 (m, m/s, N, N m)."""

    __slots__ = ("_row",)

    def __init__(self, row: s.CycleRow) -> None:
        self._row: Any = row

    @property
    def time(self) -> float:
        """Time (s); the first cycle is at 0."""
        return float(self._row.time)

    @property
    def position(self) -> Array:
        """Position of the hand (m)."""
        return floats(self._row.position)

    @property
    def velocity(self) -> Array:
        """Velocity of the hand, smooth (m/s)."""
        return floats(self._row.velocity)

    @property
    def force(self) -> Array:
        """Force of the scene on the hand (N)."""
        return floats(self._row.force)

    @property
    def torque(self) -> Array:
        """Torque on the hand (N m), about `position`."""
        return floats(self._row.torque)

    @property
    def contact_point(self) -> Array:
        """Contact point (m) of probe 0; without contact, the probe itself."""
        return floats(self._row.contact_point)

    @property
    def flags(self) -> ReportFlags:
        """What was special in this cycle."""
        return ReportFlags(self._row.flags)

    @property
    def touching(self) -> bool:
        """A surface is touched in this cycle."""
        return bool(self._row.flags & ReportFlags.TOUCHING.value)

    @property
    def buttons(self) -> int:
        """Bit mask of the buttons that are down."""
        return int(self._row.buttons)


class Offline(Owner):
    """A servo in this process, on a virtual clock: the same cycle as of a running one, as fast as the processor is.

    device: None for a probe that is exactly where step() puts it, or a simulated device with a hand of its own
    ("sim:premium15"), whose limits then hold. rate: cycles a second (Hz). Changes are in force in the next cycle.

        servo = knurl.Offline()
        servo.add(knurl.Plane(stiffness=800))
        servo.step((0, 0, -0.001)).force        # 0.8 N along z
    """

    def __init__(self, device: Optional[str] = None, rate: float = 1000.0, representations: int = 128) -> None:
        self._lib = offline()
        self._handle: Optional[int] = None
        self._changed: Dict[int, Representation] = {}
        self._added: Dict[int, Representation] = {}
        self._pose = s.PoseRow(orientation=s.Quat(1, 0, 0, 0))
        self._pose_at = c.byref(self._pose)
        options = s.OfflineOptions()
        self._lib.knurl_offline_default_options(c.byref(options))
        options.rate, options.representations = rate, representations
        handle = c.c_void_p()
        address = None if device is None else device.encode()
        self._check(self._lib.knurl_offline_open(address, c.byref(options), c.byref(handle)))
        self._handle = handle.value

    def _check(self, code: int) -> None:
        if code < 0:
            raise error_of(code, self._lib.knurl_offline_error().decode(errors="replace"))

    # ------------------------------------------------------------------ life

    def close(self) -> None:
        """Ends it. More than once does nothing."""
        handle, self._handle = self._handle, None
        if handle is not None:
            self._lib.knurl_offline_close(handle)

    def __enter__(self) -> "Offline":
        return self

    def __exit__(self, *error: Any) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_handle", None) is not None:
            self.close()

    def reset(self) -> None:
        """Everything as at first: no representation, time 0. Assets stay."""
        self._check(self._lib.knurl_offline_reset(self._handle))
        self._changed.clear()
        for representation in self._added.values():
            representation._unbind()
        self._added.clear()

    # ------------------------------------------------------------------ what is felt

    def add(
        self,
        representation: _R,
        *,
        probe: int = 0,
        on_silence: "OnSilence" = "fade",
        silence_time: float = 0.1,
        feedback: bool = True,
    ) -> _R:
        """Adds a representation, in force in the next cycle. Returns a copy that is bound to this servo; see Hand.add."""
        bound: _R = representation._clone()
        options = add_options(probe, on_silence, silence_time, feedback)
        number = c.c_uint64()
        self._check(self._lib.knurl_offline_add(self._handle, bound._KIND, bound._packed(), c.byref(options), c.byref(number)))
        bound._bind(self, number.value)
        self._added[id(bound)] = bound
        return bound

    def place_probe(self, probe: int, offset: Sequence[float] = (0.0, 0.0, 0.0), radius: float = 0.0) -> None:
        """Places a probe (0 to 15) on the hand: offset and radius (m)."""
        at = s.Vec3(*map(float, offset))
        self._check(self._lib.knurl_offline_place_probe(self._handle, probe, c.byref(at), radius))

    def send_mesh(
        self,
        vertices: Any,
        faces: Any = None,
        *,
        face_materials: Any = None,
        materials: Optional[Sequence[AssetMaterial]] = None,
        scale: float = 1.0,
        weld: float = 1e-6,
        exact: bool = False,
        crossings: bool = True,
    ) -> SentShape:
        """As Hand.send_mesh."""
        packed = pack_mesh(vertices, faces, face_materials, materials, scale, weld, exact, crossings)
        return self._sent(self._lib.knurl_offline_send_mesh, packed)

    def send_heights(
        self,
        heights: Any,
        dx: float,
        dy: Optional[float] = None,
        corner: Sequence[float] = (0.0, 0.0, 0.0),
        material: Optional[AssetMaterial] = None,
    ) -> SentShape:
        """As Hand.send_heights."""
        return self._sent(self._lib.knurl_offline_send_heights, pack_heights(heights, dx, dy, corner, material))

    def send_image(self, image: Any, size: float, height: float, corner: Optional[Sequence[float]] = None) -> SentShape:
        """As Hand.send_image."""
        return self.send_heights(*heights_of_image(image, size, height, corner))

    def _sent(self, send: Any, packed: Any) -> SentShape:
        row = s.SentRow()
        self._check(send(self._handle, c.byref(packed.row), c.byref(row)))
        return sent_of(row)

    # ------------------------------------------------------------------ cycles

    def step(
        self,
        position: Optional[Sequence[float]] = None,
        orientation: Optional[Sequence[float]] = None,
        velocity: Optional[Sequence[float]] = None,
        angular_velocity: Optional[Sequence[float]] = None,
        buttons: int = 0,
    ) -> Cycle:
        """One cycle with the probe there (m; w x y z; m/s; rad/s). Without velocities the servo measures them.

        With a device that has a hand of its own: step(), without a position.
        """
        if self._changed:
            self._send_changes()
        row = s.CycleRow()
        if position is None:
            pose: Any = None
        else:
            pose = self._pose_at
            self._put_pose(position, orientation, velocity, angular_velocity, buttons)
        code = self._lib.knurl_offline_step(self._handle, pose, c.byref(row))
        if code:
            self._check(code)
        return Cycle(row)

    def _put_pose(self, position: Any, orientation: Any, velocity: Any, angular_velocity: Any, buttons: int) -> None:
        pose = self._pose
        x, y, z = position
        pose.position[:] = (x, y, z)
        pose.orientation[:] = (1.0, 0.0, 0.0, 0.0) if orientation is None else tuple(orientation)
        pose.has_velocity = 0 if velocity is None and angular_velocity is None else 1
        if pose.has_velocity:
            pose.velocity[:] = (0.0, 0.0, 0.0) if velocity is None else tuple(velocity)
            pose.angular_velocity[:] = (0.0, 0.0, 0.0) if angular_velocity is None else tuple(angular_velocity)
        pose.buttons = buttons

    def run(self, positions: Any, velocities: Any = None) -> "Table":
        """Many cycles in one call, as a structured array with the names of Cycle.

        positions: (n, 3), m; or (n, 7): x y z qw qx qy qz; or, with a device that has a hand of its own, n.
        velocities: (n, 3), m/s; None: the servo measures them.
        """
        np = numpy()
        if self._changed:
            self._send_changes()
        poses = None if np.ndim(positions) == 0 else _poses(np, positions, velocities)
        count = int(positions) if poses is None else len(poses)
        cycles: "Table" = np.zeros(count, np.dtype(s.CycleRow))
        cycles["size"] = cycles.dtype.itemsize
        at = None if poses is None else poses.ctypes.data
        if count:
            self._check(self._lib.knurl_offline_run(self._handle, at, count, cycles.ctypes.data))
        return cycles

    # ------------------------------------------------------------------ for representations

    def _set(self, representation: Representation) -> None:
        self._check(self._lib.knurl_offline_set(self._handle, representation._id, representation._KIND, representation._packed()))

    def _remove(self, representation: Representation) -> None:
        self._check(self._lib.knurl_offline_remove(self._handle, representation._id))
        self._added.pop(id(representation), None)

    def _feedback(self, representation: Representation) -> Optional[Feedback]:
        row = s.FeedbackRow()
        code = self._lib.knurl_offline_feedback_of(self._handle, representation._id, c.byref(row))
        self._check(code)
        return Feedback(row) if code == 0 else None

    def _applied_stiffness(self, representation: Representation) -> Optional[float]:
        feedback = self._feedback(representation)
        return None if feedback is None else feedback.stiffness

    def _follow(self, representation: Representation, model: "Model", step: float) -> "Followed":
        raise Refused("follow() predicts for a running servo; an Offline servo has no delay: assign the plane itself")


def _poses(np: Any, positions: Any, velocities: Any) -> Any:
    given = np.asarray(positions, dtype=np.float64)
    if given.ndim != 2 or given.shape[1] not in (3, 7):
        raise BadParameters(f"positions: an array of shape (n, 3) or (n, 7) is needed; this one has {given.shape}")
    poses = np.zeros(len(given), np.dtype(s.PoseRow))
    poses["position"] = given[:, :3]
    poses["orientation"] = given[:, 3:] if given.shape[1] == 7 else (1.0, 0.0, 0.0, 0.0)
    if velocities is not None:
        speeds = np.asarray(velocities, dtype=np.float64)
        if speeds.shape != (len(given), 3):
            raise BadParameters(f"velocities: an array of shape ({len(given)}, 3) is needed; this one has {speeds.shape}")
        poses["velocity"] = speeds
        poses["has_velocity"] = 1
    return poses
