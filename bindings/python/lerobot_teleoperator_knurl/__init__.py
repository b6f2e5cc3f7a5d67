"""A haptic device that Knurl serves as a teleoperator of LeRobot: `--teleop.type=knurl`.

LeRobot imports third-party packages whose names begin with lerobot_teleoperator_. Written from LeRobot's published
contract and tested against a stand-in of it: the package itself was not to be had.
"""

from .config_knurl import KnurlTeleopConfig
from .knurl_teleop import KnurlTeleop

__all__ = ["KnurlTeleop", "KnurlTeleopConfig"]
