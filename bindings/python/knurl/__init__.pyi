from . import _api as _api, _kinds as _kinds, _reports as _reports
from ._api import *
from ._kinds import *
from ._version import __version__ as __version__
