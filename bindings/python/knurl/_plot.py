"""A picture of a recording. Needs matplotlib."""

from __future__ import annotations

import io
from typing import Any, Optional

from ._errors import BadParameters
from ._recording import Recording
from ._reports import ReportFlags


def plot(recording: Any, path: Optional[str] = None) -> Any:
    """Draws position, force and contact over time. Returns the matplotlib figure; path: saves it there, too.

    recording: a knurl.Recording, or an array as hand.drain() or Offline.run() gives it.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise ImportError("knurl.plot draws with matplotlib, which is not installed: apt install python3-matplotlib") from None
    reports = recording.reports if isinstance(recording, Recording) else recording
    if not len(reports):
        raise BadParameters("plot: the recording is empty")
    live = "read_ns" in reports.dtype.names
    time = (reports["read_ns"] - reports["read_ns"][0]) * 1e-9 if live else reports["time"]
    force = reports["sent_force" if live else "force"]

    class Picture(Figure):  # type: ignore[misc]
        """A notebook that has not imported pyplot does not know how to show a Figure."""

        def _repr_png_(self) -> bytes:
            png = io.BytesIO()
            self.savefig(png, format="png")
            return png.getvalue()

    figure = Picture(figsize=(8, 5), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    touching = (reports["flags"] & ReportFlags.TOUCHING.value) != 0
    for axes, values, label in ((above, reports["position"] * 1e3, "position (mm)"), (below, force, "force (N)")):
        for axis, name in enumerate("xyz"):
            axes.plot(time, values[:, axis], label=name, linewidth=1)
        axes.fill_between(time, 0, 1, where=touching, transform=axes.get_xaxis_transform(), color="0.9", label="contact")
        axes.set_ylabel(label)
    above.legend(loc="upper right", ncol=4, frameon=False)
    below.set_xlabel("time (s)")
    if path is not None:
        figure.savefig(path)
    return figure
