"""A device for NVIDIA Isaac Lab, after its DeviceBase: advance(), add_callback(), reset(), push_force().

Needs the packages isaaclab and torch. Written from Isaac Lab's published contract and tested against a stand-in of it:
the packages themselves were not to be had.

Positions and forces are in the world of the claim: by default the device's own frame (m, N), x towards the user,
y right, z up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Tuple

import torch
from isaaclab.devices.device_base import DeviceBase, DeviceCfg

from ._client import connect
from ._errors import BadParameters, Disconnected
from ._kinds import ConstantForce
from ._lazy import numpy


@dataclass
class KnurlDeviceCfg(DeviceCfg):  # type: ignore[misc]
    """How to reach the device."""

    address: Optional[str] = None
    """For knurl.connect(); None: the servo "default" of this box."""
    device: Optional[str] = None
    """Name of the device; None: the only one."""
    workspace_radius: float = 0.0
    """Of the workspace in the simulation (m); 0: the device's own, scale 1."""
    workspace_centre: Tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Where the middle of the device's workspace lies in the simulation (m)."""
    limit_force: float = 2.0
    """Largest force that is pushed (N)."""
    key_file: Optional[str] = None
    """Of a servo on another host: file with your line of the bridge's keys."""


class KnurlDevice(DeviceBase):  # type: ignore[misc]
    """A haptic device that Knurl serves, for SE(3) commands with force feedback.

    advance() gives [x, y, z, qx, qy, qz, qw, a, b, c]: position (m), orientation, and 1.0 for each of the first three
    buttons that is down, or was since the call before. It also tells the servo that the program is alive; while a
    simulation step takes long, a thread does.
    """

    KEYS = ("a", "b", "c")

    def __init__(self, cfg: KnurlDeviceCfg, retargeters: Optional[List[Any]] = None) -> None:
        super().__init__(retargeters)
        self._torch_device = cfg.sim_device
        self._limit = cfg.limit_force
        self._callbacks: Dict[str, Callable[[], None]] = {}
        self._client = connect(cfg.address, key_file=cfg.key_file)
        try:
            self._hand = self._client.claim(cfg.device, alive="interpreter", workspace_radius=cfg.workspace_radius,
                                            workspace_centre=cfg.workspace_centre)
            self._force = self._hand.add(ConstantForce())
            self._hand.arm()
        except BaseException:
            self._client.close()
            raise

    def close(self) -> None:
        """Releases the device: the force fades."""
        self._client.close()

    def reset(self) -> None:
        """No force, from the next cycle on."""
        self._push((0.0, 0.0, 0.0))

    def add_callback(self, key: Any, func: Callable[[], None]) -> None:
        """`func()` is called in advance() when the button "a", "b" or "c" went down."""
        if key not in self.KEYS:
            raise BadParameters(f"button {key!r} is not there; there are {', '.join(self.KEYS)}")
        self._callbacks[key] = func

    def push_force(
        self, forces: Any, names: Optional[List[str]] = None, frame: str = "world", position: Any = None
    ) -> None:
        """The sum of these forces (N) acts on the hand until the next call, shortened to `limit_force`.

        forces: of shape (n, 3), or {name: force}, of which `position` (a name or names) selects. The frames "world" and
        "device" have the same axes.
        """
        np = numpy()
        if isinstance(forces, dict):
            chosen = list(forces) if position is None else [position] if isinstance(position, str) else list(position)
            forces = [forces[name] for name in chosen]
            forces = [one.tolist() if hasattr(one, "tolist") else one for one in forces]
        elif hasattr(forces, "detach"):
            forces = forces.detach().cpu().numpy()
        total = np.asarray(forces, dtype=np.float64).reshape(-1, 3).sum(axis=0)
        size = float(np.linalg.norm(total))
        if not size < float("inf"):
            raise BadParameters(f"push_force: the force is {total}: it must be finite")
        self._push(total * min(1.0, self._limit / size) if size > 0 else total)

    def _push(self, force: Any) -> None:
        self._force.force = force
        self._hand.commit()

    def _get_raw_data(self) -> Any:
        frame = self._hand.newest(0.1)
        if frame is None:
            raise Disconnected("the servo gives no reports")
        self._hand.commit()
        down = frame.buttons | frame.pressed
        for bit, key in enumerate(self.KEYS):
            if frame.pressed >> bit & 1 and key in self._callbacks:
                self._callbacks[key]()
        w, x, y, z = frame.orientation
        command = [*frame.position, x, y, z, w, *(float(down >> bit & 1) for bit in range(len(self.KEYS)))]
        return torch.tensor(command, dtype=torch.float32, device=self._torch_device)
