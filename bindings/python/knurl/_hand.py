"""A claimed device: what the hand feels is added here, changed, and committed."""

from __future__ import annotations

import contextlib
import ctypes as c
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, Optional, Sequence, TypeVar, cast

from . import _alive
from . import _structs as s
from ._assets import AssetMaterial, SentShape, heights_of_image, pack_heights, pack_mesh, sent_of
from ._device import Limits, Timing, limits_of, timing_of
from ._errors import BadParameters, CallbackFailed
from ._feedback import Feedback, Followed, followed_of, give_answer
from ._lazy import floats
from ._library import check, lib
from ._observer import SLICE, Observer, slices
from ._representation import Owner, Representation

if TYPE_CHECKING:
    from typing import Literal

    from ._feedback import Model
    from ._lazy import Array

    OnSilence = Literal["fade", "hold", "move"]
    Alive = Literal["loop", "interpreter", "always"]

_R = TypeVar("_R", bound=Representation)
_SILENCE = {"fade": 0, "hold": 1, "move": 2}


def add_options(probe: int, on_silence: str, silence_time: float, feedback: bool) -> s.AddOptions:
    """The C struct of the options of add()."""
    if on_silence not in _SILENCE:
        raise BadParameters(f"on_silence is {on_silence!r}: it is one of {', '.join(_SILENCE)}")
    return s.AddOptions(probe=probe, on_silence=_SILENCE[on_silence], silence_time=silence_time, feedback=int(feedback))


class Hand(Observer, Owner):
    """An application's hold on a device. Made by `client.claim()`; ends with the `with` block, or close()."""

    def __init__(self, client: Any, handle: int, alive: "Alive") -> None:
        super().__init__(client, handle)
        self._changed: Dict[int, Representation] = {}
        self._number = c.c_uint64()
        self._number_at = c.byref(self._number)
        self._groups = 0
        self._model: Optional["Model"] = None
        self._model_error: Optional[BaseException] = None
        self._callback: Any = None
        self.keep_alive(alive)

    def __enter__(self) -> "Hand":
        return self

    def close(self) -> None:
        """The force fades and the device is free. More than once does nothing."""
        self._callback = None
        super().close()

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
        """Adds a representation, in force from the next cycle on. Returns a copy that is bound to this hand.

        probe: on which it acts, 0 to 15. on_silence: what it does when this program commits no more: "fade", "hold"
        (goes on acting), or "move" (moves on for `silence_time`, s, then fades). feedback: False: its wrench is not
        reported. Raises BadParameters with field, value and range.
        """
        bound: _R = representation._clone()
        options = add_options(probe, on_silence, silence_time, feedback)
        number = c.c_uint64()
        check(lib.knurl_add(self._handle, bound._KIND, bound._packed(), c.byref(options), c.byref(number)))
        bound._bind(self, number.value)
        return bound

    def place_probe(self, probe: int, offset: Sequence[float] = (0.0, 0.0, 0.0), radius: float = 0.0) -> None:
        """Places a probe (0 to 15) on the hand: offset (m) in the frame of the device's tool, radius (m)."""
        at = s.Vec3(*map(float, offset))
        check(lib.knurl_place_probe(self._handle, probe, c.byref(at), radius))

    @contextlib.contextmanager
    def together(self) -> Iterator[None]:
        """Commands inside (add, remove, place_probe, arm) take effect in one cycle, or none does.

        If the block raises, nothing is sent. Do not call commit() inside.
        """
        check(lib.knurl_begin_group(self._handle))
        try:
            yield
        except BaseException:
            check(lib.knurl_cancel_group(self._handle))
            raise
        check(lib.knurl_end_group(self._handle))

    def commit(self) -> int:
        """Sends all changes since the last commit as one batch, which takes effect in one cycle; "I am alive".

        Returns the batch's number. A change that is out of range raises BadParameters: it is taken back, nothing is
        sent, and the other changes go with the next commit.
        """
        if self._changed:
            self._send_changes()
        code = lib.knurl_commit(self._handle, self._number_at)
        if code:
            check(code)
        return self._number.value

    def _turn(self) -> None:
        self.commit()

    def wait_applied(self, number: int = 0, timeout: float = 1.0) -> bool:
        """Waits until the batch `number` (0: the newest committed) has taken effect; False: not in `timeout` (s)."""
        for wait in slices(timeout):
            code = lib.knurl_wait_applied(self._handle, number, wait)
            check(code)
            if code == 0:
                return True
        return False

    # ------------------------------------------------------------------ the claim

    def arm(self) -> None:
        """Allows force: it ramps up over 0.5 s once the hand is slow. Waits for the servo's answer, at most a second."""
        check(lib.knurl_arm(self._handle))

    def disarm(self) -> None:
        """Takes this claim's force away."""
        check(lib.knurl_disarm(self._handle))

    def reset_fault(self) -> None:
        """Leaves a fault: the device is idle then, without force, until arm()."""
        check(lib.knurl_reset_fault(self._handle))

    def keep_alive(self, alive: "Alive") -> None:
        """What keeps the claim alive, so that its force does not fade while nobody commits.

        "loop": commits alone. "interpreter": as long as Python runs threads, plus a second. "always": as long as
        this process runs, also where it hangs: for a force that may stay when nobody controls it.
        """
        if alive == "loop":
            check(lib.knurl_keep_alive(self._handle, -1))
        elif alive == "interpreter":
            check(lib.knurl_keep_alive(self._handle, _alive.GRACE_NS))
            _alive.watch(self)
        elif alive == "always":
            check(lib.knurl_keep_alive(self._handle, 0))
        else:
            raise BadParameters(f"alive is {alive!r}: it is one of loop, interpreter, always")

    def progress(self) -> None:
        """Says that the program makes progress, though it does not commit: for alive="interpreter"."""
        check(lib.knurl_progress(self._handle))

    @property
    def limits(self) -> Limits:
        """What stiffness and force are clamped to, in world units."""
        row = s.LimitsRow()
        check(lib.knurl_limits_of(self._handle, c.byref(row)))
        return limits_of(row)

    @property
    def timing(self) -> Timing:
        """How late this application is, as measured by the servo."""
        row = s.TimingRow()
        check(lib.knurl_timing_of(self._handle, c.byref(row)))
        return timing_of(row)

    @property
    def predicted_position(self) -> "Array":
        """Where the hand will be (m, world frame) when an update computed now is half-way through its life."""
        at = s.Vec3()
        check(lib.knurl_predicted_position(self._handle, c.byref(at)))
        return floats(at)

    # ------------------------------------------------------------------ assets

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
        """Sends a triangle mesh, and waits until the servo has it; knurl.Shape(asset=sent.asset) then places it.

        vertices: (n, 3), of `scale` (m); faces: (m, 3), counter-clockwise as seen from free space. Or one object that
        has both, as those of trimesh. face_materials: a number for each face, into `materials`. exact: corners in
        double precision. crossings: False saves the search for faces that cross. The claim goes on being renewed.
        """
        mesh = pack_mesh(vertices, faces, face_materials, materials, scale, weld, exact, crossings)
        return self._send_asset(lib.knurl_begin_sending_mesh, mesh)

    def send_heights(
        self,
        heights: Any,
        dx: float,
        dy: Optional[float] = None,
        corner: Sequence[float] = (0.0, 0.0, 0.0),
        material: Optional[AssetMaterial] = None,
    ) -> SentShape:
        """Sends a height field, and waits until the servo has it. heights[row, column] (m): columns along x, rows along y.

        dx, dy: from one height to the next (m; dy as dx). corner: where heights[0, 0] is, at height 0 (m).
        """
        return self._send_asset(lib.knurl_begin_sending_heights, pack_heights(heights, dx, dy, corner, material))

    def send_image(self, image: Any, size: float, height: float, corner: Optional[Sequence[float]] = None) -> SentShape:
        """Sends an image as a height field `size` wide (m): black is 0, white is `height` (m). Centred, unless `corner`."""
        return self.send_heights(*heights_of_image(image, size, height, corner))

    def _send_asset(self, begin: Callable[..., int], packed: Any) -> SentShape:
        sending = c.c_void_p()
        check(begin(self._handle, c.byref(packed.row), c.byref(sending)))
        row = s.SentRow()
        try:
            while True:
                code = lib.knurl_sending_done(sending, int(SLICE * 1e9), c.byref(row))
                if code <= 0:
                    sending.value = None  # it was answered, which closed it
                    check(code)
                    return sent_of(row)
                check(lib.knurl_commit(self._handle, None))
        finally:
            if sending.value is not None:
                lib.knurl_close(sending)

    def forget(self, asset: int) -> None:
        """Forgets an asset of which no representation is made any more: its number and memory are free again."""
        check(lib.knurl_forget(self._handle, asset))

    # ------------------------------------------------------------------ for representations

    def _set(self, representation: Representation) -> None:
        code = lib.knurl_set(self._handle, representation._id, representation._KIND, representation._packed())
        if code:
            check(code)

    def _remove(self, representation: Representation) -> None:
        check(lib.knurl_remove(self._handle, representation._id))

    def _feedback(self, representation: Representation) -> Optional[Feedback]:
        row = s.FeedbackRow()
        code = lib.knurl_feedback_of(self._handle, representation._id, c.byref(row))
        check(code)
        return Feedback(row) if code == 0 else None

    def _applied_stiffness(self, representation: Representation) -> Optional[float]:
        stiffness = c.c_double()
        code = lib.knurl_applied_stiffness(self._handle, representation._id, c.byref(stiffness))
        check(code)
        return stiffness.value if code == 0 else None

    def _follow(self, representation: Representation, model: "Model", step: float) -> Followed:
        if self._changed.pop(id(representation), None) is not None:
            representation._send()
        if self._callback is None:
            self._callback = s.SurfaceModel(self._evaluate)
        row = s.FollowedRow()
        self._model, self._model_error = model, None
        try:
            code = lib.knurl_follow(self._handle, representation._id, self._callback, None, step, c.byref(row))
            if self._model_error is not None:
                raise self._model_error
            if code == CallbackFailed.code:
                # _evaluate did not finish, and caught nothing. Python runs signal handlers also between the callback's
                # entry and its `try`; ctypes then prints what they raise, and drops it. That is Ctrl-C.
                raise KeyboardInterrupt
            check(code)
        finally:
            self._model = self._model_error = None
        packed = representation._packed()
        check(lib.knurl_get(self._handle, representation._id, representation._KIND, packed))
        representation._load(packed)
        representation.__dict__["_accepted"] = packed.raw
        return followed_of(row)

    def _evaluate(self, _: Any, near: Any, out: Any) -> int:
        """The C library's callback. What the model raises is raised by follow()."""
        try:
            model = cast("Model", self._model)
            give_answer(model(floats(near.contents).copy()), out.contents)
            return 0
        except BaseException as error:  # also KeyboardInterrupt: nothing may leave a C callback
            self._model_error = error
            return 1
