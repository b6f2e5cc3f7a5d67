"""What all representations have in common. The kinds themselves are in _kinds.py, made from the library's tables.

A representation that was added to a hand is the same dataclass, bound to the claim: an assignment to one of its
parameters, or to one of a part (`floor.friction.dynamic = 0.3`), is sent with the next commit.
"""

from __future__ import annotations

import ctypes as c
import math
import operator
import struct
from typing import TYPE_CHECKING, Any, Callable, ClassVar, Dict, Optional, Sequence, Tuple, Type, TypeVar, Union

from ._errors import BadParameters, Stale
from ._library import check, lib

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from ._feedback import Feedback, Followed, Model

    Vector = Union[Sequence[float], npt.NDArray[Any]]
    Matrix = Union[Sequence[Sequence[float]], npt.NDArray[Any]]
    Points = Union[Sequence[Sequence[float]], npt.NDArray[Any]]
    Number = Union[float, np.floating[Any]]
else:
    Vector = Matrix = Points = Sequence

AUTOMATIC = -1.0
"""Value of `recovery` and `friction.static_`: the library chooses."""

_R = TypeVar("_R", bound="Representation")
Converter = Callable[[Any], Any]


class Owner:
    """What a representation may be added to: a Hand, or an Offline servo."""

    _changed: Dict[int, "Representation"]

    def _set(self, representation: "Representation") -> None:
        raise NotImplementedError

    def _remove(self, representation: "Representation") -> None:
        raise NotImplementedError

    def _feedback(self, representation: "Representation") -> Optional["Feedback"]:
        raise NotImplementedError

    def _applied_stiffness(self, representation: "Representation") -> Optional[float]:
        raise NotImplementedError

    def _follow(self, representation: "Representation", model: "Model", step: float) -> "Followed":
        raise NotImplementedError

    def _send_changes(self) -> None:
        """Gives the library all that was assigned. What it refuses is taken back, and raised."""
        while self._changed:
            _, representation = self._changed.popitem()
            representation._send()


class Record:
    """A group of parameters. Assignment converts (arrays become tuples) and tells the representation."""

    _CONVERT: ClassVar[Dict[str, Converter]] = {}
    _NAME: ClassVar[str] = ""

    if not TYPE_CHECKING:  # a type checker knows the parameters; this would tell it that every name is one

        def __setattr__(self, name: str, value: Any) -> None:
            convert = self._CONVERT.get(name)
            if convert is None:
                raise AttributeError(f"{self._NAME} has no parameter '{name}'; it has {', '.join(self._CONVERT)}")
            try:
                value = convert(value)
            except (TypeError, ValueError, OverflowError) as error:
                raise BadParameters(f"{self._NAME}: {name} is {value!r}: {error}") from None
            mine = self.__dict__
            if isinstance(value, Record):
                value.__dict__["_root"] = self
            mine[name] = value
            root = mine.get("_root")
            if root is not None:
                root._touch()

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(self.__dict__[name] == other.__dict__[name] for name in self._CONVERT)

    __hash__ = None  # type: ignore[assignment]  # what is equal now may differ after an assignment

    def __repr__(self) -> str:
        usual = type(self)().__dict__
        differ = (name for name in self._CONVERT if self.__dict__[name] != usual[name])
        return f"{type(self).__name__}({', '.join(f'{name}={self.__dict__[name]!r}' for name in differ)})"

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{self._NAME}: '{name}' cannot be deleted")

    def __reduce__(self) -> Tuple[Any, ...]:
        # A copy, or what comes out of a pickle, belongs to no hand.
        return type(self), tuple(self.__dict__[name] for name in self._CONVERT)

    def _clone(self) -> Any:
        return type(self)(*(self.__dict__[name] for name in self._CONVERT))


class Representation(Record):
    """Something that the hand feels. Made as a template; `hand.add` returns a bound copy of it."""

    _KIND: ClassVar[int] = -1
    _FORMAT: ClassVar[struct.Struct] = struct.Struct("<Q")
    _ROWS: ClassVar[Tuple[Tuple[str, str, str, Any], ...]] = ()

    if TYPE_CHECKING:
        _id: int

    # ------------------------------------------------------------------ what a user calls

    def validate(self) -> None:
        """Raises BadParameters for what `hand.add` would refuse: field, value, range. Needs no servo."""
        check(lib.knurl_validate(self._KIND, self._packed()))

    @classmethod
    def made_of(cls: Type[_R], material: str, **parameters: Any) -> _R:
        """A surface that feels like that material: `Plane.made_of("rubber", offset=0.005)`.

        `parameters` win over the material's. The names are in `knurl.materials`.
        """
        made = cls()
        buffer = made._packed()
        check(lib.knurl_made_of(cls._KIND, material.encode(), buffer))
        made._load(buffer)
        for name, value in parameters.items():
            setattr(made, name, value)
        return made

    def set(self, **parameters: Any) -> None:
        """Assigns several parameters, and checks them at once: all of them, or BadParameters and none."""
        before = self._packed_bytes()
        try:
            for name, value in parameters.items():
                setattr(self, name, value)
            self.validate()
        except Exception:
            self._load(before)
            raise

    @property
    def added(self) -> bool:
        """True: it is on a hand (or an Offline servo), and was not removed."""
        return "_owner" in self.__dict__

    @property
    def feedback(self) -> Optional["Feedback"]:
        """What it does to the hand in the newest cycle; None: the servo has not evaluated it yet."""
        return self._bound_to()._feedback(self)

    @property
    def applied_stiffness(self) -> Optional[float]:
        """Stiffness after clamping to what the device allows (N/m); None: the servo has not answered yet."""
        return self._bound_to()._applied_stiffness(self)

    def remove(self) -> None:
        """Takes it off the hand: it fades over its `recovery`."""
        owner = self._bound_to()
        owner._changed.pop(id(self), None)
        owner._remove(self)
        self._unbind()

    def follow(self, model: "Model", step: float = 0.0) -> "Followed":
        """Evaluates `model` where the hand will be when this update takes effect, and sets it. Planes and caps.

        `model(near)`: near is an array of 3 (m, world frame); it returns a SurfacePoint, or (foot, normal). `step`
        (m): other than 0, curvatures are measured from how the normals turn that far apart. An exception in the
        model leaves follow() as it is, and nothing is set. The parameters are those that were set, afterwards.
        """
        return self._bound_to()._follow(self, model, step)

    # ------------------------------------------------------------------ for hands

    def _values(self) -> Tuple[Any, ...]:
        """The parameters in the order of the C struct, flat."""
        raise NotImplementedError

    def _packed(self) -> "c.Array[c.c_char]":
        """The C struct of the parameters, in memory of this object."""
        mine = self.__dict__
        size = self._FORMAT.size
        buffer: Optional["c.Array[c.c_char]"] = mine.get("_buffer")
        if buffer is None:
            buffer = mine["_buffer"] = c.create_string_buffer(size)
        self._FORMAT.pack_into(buffer, 0, size, *self._values())
        return buffer

    def _packed_bytes(self) -> bytes:
        return self._FORMAT.pack(self._FORMAT.size, *self._values())

    def _load(self, packed: Any) -> None:
        """Takes the parameters from a C struct. Tells no hand."""
        values = self._FORMAT.unpack_from(packed)
        at = 1  # behind the size
        mine = self.__dict__
        for part, name, kind, detail in self._ROWS:
            holder = mine[part].__dict__ if part else mine
            at, holder[name] = _UNPACK[kind](values, at, detail)

    def _touch(self) -> None:
        owner = self.__dict__.get("_owner")
        if owner is not None:
            owner._changed[id(self)] = self

    def _bind(self, owner: Owner, number: int) -> None:
        mine = self.__dict__
        mine["_owner"] = owner
        mine["_id"] = number
        mine["_root"] = self
        mine["_accepted"] = self._packed_bytes()

    def _unbind(self) -> None:
        del self.__dict__["_owner"], self.__dict__["_root"]

    def _bound_to(self) -> Owner:
        owner: Optional[Owner] = self.__dict__.get("_owner")
        if owner is None:
            raise Stale(f"this {self._NAME} is on no hand: it was not added, or was removed; hand.add() returns one that is")
        return owner

    def _send(self) -> None:
        mine = self.__dict__
        try:
            self._bound_to()._set(self)
        except BadParameters:
            self._load(mine["_accepted"])
            raise
        mine["_accepted"] = mine["_buffer"].raw


# ---------------------------------------------------------------------- conversions of assigned values


def real(value: Any) -> float:
    """A number."""
    return float(value)


def integer(value: Any) -> int:
    """A whole number of 32 bits."""
    number = operator.index(value)
    if not 0 <= number < 1 << 32:
        raise ValueError("it must be a whole number, 0 to 4294967295")
    return number


def _floats(value: Any, count: int, what: str) -> Tuple[float, ...]:
    numbers = tuple(map(float, value))
    if len(numbers) != count:
        raise ValueError(f"{what} has {count} numbers, not {len(numbers)}")
    return numbers


def vector(value: Any) -> Tuple[float, ...]:
    """x, y, z."""
    return _floats(value, 3, "a vector")


def quaternion(value: Any) -> Tuple[float, ...]:
    """w, x, y, z."""
    return _floats(value, 4, "a quaternion (w x y z)")


class choice:
    """One of some names."""

    def __init__(self, *names: str) -> None:
        self.names = names

    def __call__(self, value: Any) -> str:
        if value not in self.names:
            raise ValueError("it is one of " + ", ".join(self.names))
        return str(value)


class matrix:
    """Rows of numbers."""

    def __init__(self, size: int) -> None:
        self.size = size

    def __call__(self, value: Any) -> Tuple[Tuple[float, ...], ...]:
        rows = tuple(_floats(row, self.size, "a row of the matrix") for row in value)
        if len(rows) != self.size:
            raise ValueError(f"the matrix has {self.size} rows, not {len(rows)}")
        return rows


class points:
    """Up to so many points."""

    def __init__(self, most: int) -> None:
        self.most = most

    def __call__(self, value: Any) -> Tuple[Tuple[float, ...], ...]:
        given = tuple(vector(point) for point in value)
        if len(given) > self.most:
            raise ValueError(f"there is room for {self.most} points, not {len(given)}")
        return given


class part:
    """A group of parameters of its own, which is copied."""

    def __init__(self, kind: Type[Record]) -> None:
        self.kind = kind

    def __call__(self, value: Any) -> Any:
        if not isinstance(value, self.kind):
            raise TypeError(f"give a knurl.{self.kind.__name__}")
        return value._clone()


# ---------------------------------------------------------------------- to and from the C struct


def flat(rows: Any) -> Tuple[float, ...]:
    """A matrix row by row."""
    return tuple(number for row in rows for number in row)


def padded(given: Any, most: int) -> Tuple[Any, ...]:
    """Points, room for `most` of them, and how many there are."""
    return flat(given) + (0.0,) * (3 * (most - len(given))) + (len(given),)


def _take_matrix(values: Any, at: int, size: int) -> Tuple[int, Any]:
    rows = tuple(tuple(values[at + size * row : at + size * (row + 1)]) for row in range(size))
    return at + size * size, rows


def _take_points(values: Any, at: int, most: int) -> Tuple[int, Any]:
    end = at + 3 * most
    used = values[end]
    return end + 1, tuple(tuple(values[at + 3 * i : at + 3 * i + 3]) for i in range(used))


_UNPACK: Dict[str, Callable[[Any, int, Any], Tuple[int, Any]]] = {
    "real": lambda values, at, _: (at + 1, values[at]),
    "integer": lambda values, at, _: (at + 1, values[at]),
    "choice": lambda values, at, names: (at + 1, names[values[at]]),
    "vector": lambda values, at, _: (at + 3, tuple(values[at : at + 3])),
    "quaternion": lambda values, at, _: (at + 4, tuple(values[at : at + 4])),
    "matrix": _take_matrix,
    "points": _take_points,
}

INFINITY = math.inf
"""A stiffness: as stiff as the device allows."""
