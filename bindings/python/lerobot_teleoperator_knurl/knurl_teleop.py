"""The teleoperator: the hand's pose is the action, the robot's force the feedback."""

from __future__ import annotations

import math
from typing import Any, Dict, Optional, Tuple

from lerobot.teleoperators.teleoperator import Teleoperator
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError

import knurl

from .config_knurl import KnurlTeleopConfig

_POSE = ("ee.x", "ee.y", "ee.z", "ee.wx", "ee.wy", "ee.wz")
_GRIPPER = "ee.gripper_pos"
_FORCE = ("force.x", "force.y", "force.z")
_OPEN, _CLOSED = 100.0, 0.0


def rotation_vector(orientation: Any) -> Tuple[float, float, float]:
    """Axis times angle (rad, 0 to pi) of a unit quaternion w x y z."""
    w, x, y, z = (float(number) for number in orientation)
    if w < 0:
        w, x, y, z = -w, -x, -y, -z
    sine = math.sqrt(x * x + y * y + z * z)
    factor = 2.0 if sine < 1e-12 else 2.0 * math.atan2(sine, w) / sine
    return x * factor, y * factor, z * factor


class KnurlTeleop(Teleoperator):  # type: ignore[misc]
    """Position (m), rotation vector (rad) and gripper (0 closed, 100 open) of the hand; forces (N) back to it.

    Feedback is a force that a loop sends 30 to 60 times a second; the servo fades from each to the next. What must feel
    hard, like the table under the robot, is better added to `hand` as a knurl.Plane or mesh: the servo renders it.
    """

    config_class = KnurlTeleopConfig
    name = "knurl"

    def __init__(self, config: KnurlTeleopConfig) -> None:
        super().__init__(config)
        self.config = config
        self._client: Optional[knurl.Client] = None
        self._hand: Optional[knurl.Hand] = None
        self._force: Optional[knurl.ConstantForce] = None

    @property
    def hand(self) -> knurl.Hand:
        """The claim, to add what is felt besides the feedback."""
        if self._hand is None:
            raise DeviceNotConnectedError(f"{self} is not connected; call connect()")
        return self._hand

    @property
    def action_features(self) -> Dict[str, type]:
        """Names and types of get_action()'s values."""
        return dict.fromkeys((*_POSE, _GRIPPER), float)

    @property
    def feedback_features(self) -> Dict[str, type]:
        """Names and types of send_feedback()'s values (N)."""
        return dict.fromkeys(_FORCE, float)

    @property
    def is_connected(self) -> bool:
        """The servo is there, and the device is claimed."""
        return self._hand is not None and self._hand.connected

    @property
    def is_calibrated(self) -> bool:
        """The servo calibrates its devices."""
        return True

    def calibrate(self) -> None:
        """Nothing: the servo calibrates its devices."""

    def configure(self) -> None:
        """Adds the feedback's force, and allows force."""
        self._force = self.hand.add(knurl.ConstantForce())
        self.hand.arm()

    def connect(self, calibrate: bool = True) -> None:
        """Claims the device. While the robot's loop stands still, a thread says that this program is alive."""
        if self._hand is not None:
            raise DeviceAlreadyConnectedError(f"{self} is connected already")
        config = self.config
        self._client = knurl.connect(config.address, key_file=config.key_file)
        try:
            self._hand = self._client.claim(config.device, alive="interpreter", workspace_radius=config.workspace_radius,
                                            workspace_centre=config.workspace_centre or (0.0, 0.0, 0.0))
            self.configure()
        except BaseException:
            self.disconnect()
            raise

    def get_action(self) -> Dict[str, float]:
        """The hand's pose in the robot's frame, and the gripper."""
        report = self.hand.latest() or self.hand.newest(1.0)
        if report is None:
            raise DeviceNotConnectedError(f"{self}: the servo gives no reports")
        self.hand.commit()
        pose = (*(float(number) for number in report.position), *rotation_vector(report.orientation))
        closed = report.buttons >> self.config.gripper_button & 1
        return {**dict(zip(_POSE, pose)), _GRIPPER: _CLOSED if closed else _OPEN}

    def send_feedback(self, feedback: Dict[str, Any]) -> None:
        """The force on the hand (N) until the next call; what is missing is 0. Shortened to `limit_force`."""
        force = [float(feedback.get(name, 0.0)) for name in _FORCE]
        size = math.sqrt(sum(part * part for part in force))
        scale = min(1.0, self.config.limit_force / size) if size > 0 else 1.0
        hand = self.hand
        assert self._force is not None
        self._force.force = [part * scale for part in force]
        hand.commit()

    def disconnect(self) -> None:
        """Releases the device: the force fades."""
        client, self._client, self._hand, self._force = self._client, None, None, None
        if client is not None:
            client.close()
