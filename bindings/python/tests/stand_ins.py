"""Stand-ins for LeRobot, Isaac Lab and torch, which cannot be had where these tests run.

They have what the published base classes have of names, signatures, abstract methods and behaviour (LeRobot's
Teleoperator and TeleoperatorConfig; Isaac Lab's DeviceBase and DeviceCfg, of 2025), and nothing more. They prove that
the classes here keep those contracts, not that they run with the packages.
"""

import abc
import pathlib
import sys
import tempfile
import types
from dataclasses import dataclass, field
from typing import Optional

import numpy as np


def module(name, **names):
    made = types.ModuleType(name)
    vars(made).update(names)
    sys.modules[name] = made
    return made


class DeviceNotConnectedError(ConnectionError):
    pass


class DeviceAlreadyConnectedError(ConnectionError):
    pass


@dataclass
class TeleoperatorConfig(abc.ABC):
    """There it is a draccus.ChoiceRegistry, of keyword arguments alone."""

    id: Optional[str] = None
    calibration_dir: Optional[pathlib.Path] = None
    choices = {}

    @classmethod
    def register_subclass(cls, name):
        def register(subclass):
            cls.choices[name] = subclass
            return subclass

        return register

    @property
    def type(self):
        return next(name for name, kind in self.choices.items() if kind is type(self))


class Teleoperator(abc.ABC):
    def __init__(self, config):
        self.id = config.id
        self.calibration_dir = config.calibration_dir or pathlib.Path(tempfile.gettempdir())
        self.calibration = {}

    def __str__(self):
        return f"{self.id} {self.__class__.__name__}"

    def __enter__(self):
        self.connect()
        return self

    def __exit__(self, exc_type, exc_value, traceback):
        self.disconnect()

    def __del__(self):
        try:
            if self.is_connected:
                self.disconnect()
        except Exception:
            pass


def _abstract(name):
    def method(self, *arguments, **options):
        raise NotImplementedError

    method.__name__ = name
    return abc.abstractmethod(method)


for _name in ("action_features", "feedback_features", "is_connected", "is_calibrated"):
    setattr(Teleoperator, _name, property(_abstract(_name)))
for _name in ("connect", "calibrate", "configure", "get_action", "send_feedback", "disconnect"):
    setattr(Teleoperator, _name, _abstract(_name))
Teleoperator.__abstractmethods__ = frozenset(
    "action_features feedback_features is_connected is_calibrated connect calibrate configure get_action send_feedback disconnect".split())


@dataclass
class DeviceCfg:
    sim_device: str = "cpu"
    retargeters: list = field(default_factory=list)


class DeviceBase(abc.ABC):
    def __init__(self, retargeters=None):
        self._retargeters = retargeters or []

    @abc.abstractmethod
    def reset(self):
        raise NotImplementedError

    @abc.abstractmethod
    def add_callback(self, key, func):
        raise NotImplementedError

    def push_force(self, forces, names=None, frame="world", position=None):
        return

    def _get_raw_data(self):
        raise NotImplementedError

    def advance(self):
        raw = self._get_raw_data()
        if not self._retargeters:
            return raw
        return np.concatenate([retargeter.retarget(raw) for retargeter in self._retargeters], -1)


class Tensor:
    """A torch.Tensor of forces, as much as push_force sees of it."""

    def __init__(self, numbers):
        self.numbers = np.asarray(numbers, np.float32)

    def detach(self):
        return self

    cpu = detach

    def numpy(self):
        return self.numbers

    def tolist(self):
        return self.numbers.tolist()


def install():
    """Puts them where the packages would be."""
    module("torch", float32=np.float32, tensor=lambda numbers, dtype, device: np.array(numbers, dtype))
    module("isaaclab")
    module("isaaclab.devices")
    module("isaaclab.devices.device_base", DeviceBase=DeviceBase, DeviceCfg=DeviceCfg)
    module("lerobot")
    module("lerobot.teleoperators")
    module("lerobot.teleoperators.config", TeleoperatorConfig=TeleoperatorConfig)
    module("lerobot.teleoperators.teleoperator", Teleoperator=Teleoperator)
    module("lerobot.utils")
    module("lerobot.utils.errors", DeviceAlreadyConnectedError=DeviceAlreadyConnectedError,
           DeviceNotConnectedError=DeviceNotConnectedError)
