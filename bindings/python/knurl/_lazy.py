"""NumPy, imported when the first array is wanted: `import knurl` alone stays short."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Array = npt.NDArray[np.float64]
    Table = npt.NDArray[Any]


def numpy() -> Any:
    """The module numpy."""
    import numpy

    return numpy


def floats(numbers: Any) -> "Array":
    """An array over the doubles of a struct, which it keeps alive."""
    import numpy

    array: "Array" = numpy.frombuffer(numbers)
    return array
