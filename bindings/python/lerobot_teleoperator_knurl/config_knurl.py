"""Configuration of the teleoperator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import List, Optional

from lerobot.teleoperators.config import TeleoperatorConfig


@TeleoperatorConfig.register_subclass("knurl")
@dataclass
class KnurlTeleopConfig(TeleoperatorConfig):  # type: ignore[misc]
    """How to reach the device, and what of it moves the robot."""

    address: Optional[str] = None
    """For knurl.connect(); None: the servo "default" of this box."""
    device: Optional[str] = None
    """Name of the device; None: the only one."""
    key_file: Optional[str] = None
    """Of a servo on another host: file with your line of the bridge's keys."""
    workspace_radius: float = 0.0
    """Of the workspace in the robot's frame (m); 0: the device's own, scale 1."""
    workspace_centre: Optional[List[float]] = None
    """Where the middle of the device's workspace lies in the robot's frame (m); None: 0 0 0."""
    gripper_button: int = 0
    """Number of the button that closes the gripper."""
    limit_force: float = 2.0
    """Largest force that feedback may ask for (N)."""
