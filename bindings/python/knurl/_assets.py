"""Meshes and height fields from arrays, as the library takes them."""

from __future__ import annotations

import ctypes as c
from dataclasses import dataclass
from typing import Any, List, Optional, Sequence, Tuple

from . import _structs as s
from ._device import triple
from ._errors import BadParameters
from ._lazy import numpy


@dataclass(frozen=True)
class AssetMaterial:
    """What a material makes of the representation's stiffness, damping and friction: factors."""

    stiffness: float = 1.0
    """On the stiffness, 0 to 1."""
    damping: float = 1.0
    """On the damping, 0 or more."""
    friction: float = 1.0
    """On the friction, 0 or more."""


@dataclass(frozen=True)
class SentShape:
    """What the servo made of a mesh or height field."""

    asset: int
    """Number of the asset, for knurl.Shape(asset=...)."""
    faces: int
    """Faces that are left after mending."""
    bytes: int
    """Bytes of the servo's memory that it takes."""
    low: Tuple[float, float, float]
    """Lowest corner of its bounding box (m)."""
    high: Tuple[float, float, float]
    """Highest corner of its bounding box (m)."""
    vertices_welded: int
    """Vertices that became one with another."""
    faces_dropped: int
    """Faces that were dropped: without area, given twice, with a vertex that is not finite or far away."""
    faces_turned: int
    """Faces that were wound against their neighbours, and were turned."""
    edges_open: int
    """Edges with one face: the mesh is not closed."""
    edges_non_manifold: int
    """Edges with more than two faces."""
    faces_crossed: int
    """Faces that others cross."""
    parts: int
    """Parts that hang together."""


_COUNTS = ("asset", "faces", "bytes", "vertices_welded", "faces_dropped", "faces_turned", "edges_open",
           "edges_non_manifold", "faces_crossed", "parts")


def sent_of(row: Any) -> SentShape:
    """From the C struct."""
    return SentShape(low=triple(row.low), high=triple(row.high), **{name: getattr(row, name) for name in _COUNTS})


class Packed:
    """A C struct, and the arrays to which it points."""

    def __init__(self, row: s.Sized) -> None:
        self.row = row
        self._kept: List[Any] = []

    def point(self, member: str, array: Any) -> None:
        """Lets a member point to the array's first number."""
        self._kept.append(array)
        setattr(self.row, member, array.ctypes.data if hasattr(array, "ctypes") else c.addressof(array))


def _reals(np: Any, numbers: Any) -> Any:
    """As float32 where it is that already, else as float64."""
    array = np.asarray(numbers)
    return np.ascontiguousarray(array, dtype=np.float32 if array.dtype == np.float32 else np.float64)


def _point_to_reals(packed: Packed, np: Any, member: str, array: Any) -> None:
    packed.point(member + "_float" if array.dtype == np.float32 else member, array)


def _material_row(material: AssetMaterial) -> s.AssetMaterialRow:
    return s.AssetMaterialRow(material.stiffness, material.damping, material.friction)


def _triangles(np: Any, faces: Any, vertices: int) -> Any:
    given = np.asarray(faces)
    if given.ndim != 2 or given.shape[1] != 3 or given.dtype.kind not in "iu":
        raise BadParameters(f"faces: an array of whole numbers, three a triangle, is needed; this one is {given.dtype} of shape {given.shape}")
    if given.size and (given.min() < 0 or given.max() >= vertices):
        raise BadParameters(f"faces: vertex {int(given.max() if given.max() >= vertices else given.min())} is not there; there are {vertices}")
    return np.ascontiguousarray(given, dtype=np.uint32)


def pack_mesh(
    vertices: Any,
    faces: Any,
    face_materials: Any,
    materials: Optional[Sequence[AssetMaterial]],
    scale: float,
    weld: float,
    exact: bool,
    crossings: bool,
) -> Packed:
    """knurl_mesh of arrays, or of an object that has `vertices` and `faces`, as trimesh's have."""
    np = numpy()
    if faces is None:
        if not (hasattr(vertices, "vertices") and hasattr(vertices, "faces")):
            raise BadParameters("send_mesh: give vertices and faces, or an object that has both")
        vertices, faces = vertices.vertices, vertices.faces
    at = _reals(np, vertices)
    if at.ndim != 2 or at.shape[1] != 3:
        raise BadParameters(f"vertices: an array of x y z is needed, of shape (n, 3); this one has {at.shape}")
    triangles = _triangles(np, faces, len(at))
    packed = Packed(s.MeshRow(vertex_count=len(at), triangle_count=len(triangles), scale=scale, weld=weld,
                              exact=int(exact), no_crossings=int(not crossings)))
    _point_to_reals(packed, np, "vertices", at)
    packed.point("triangles", triangles)
    if materials:
        rows = (s.AssetMaterialRow * len(materials))(*map(_material_row, materials))
        packed.point("materials", rows)
        packed.row.material_count = len(materials)
    if face_materials is not None:
        numbers = np.ascontiguousarray(face_materials, dtype=np.uint8)
        if numbers.shape != (len(triangles),):
            raise BadParameters(f"face_materials: one number for each of the {len(triangles)} faces is needed, not {numbers.shape}")
        packed.point("triangle_materials", numbers)
    return packed


def pack_heights(heights: Any, dx: float, dy: Optional[float], corner: Sequence[float], material: Optional[AssetMaterial]) -> Packed:
    """knurl_heights of an array [row, column]: row by row along y, x first in each."""
    np = numpy()
    at = _reals(np, heights)
    if at.ndim != 2:
        raise BadParameters(f"heights: an array of rows and columns is needed; this one has the shape {at.shape}")
    packed = Packed(s.HeightsRow(columns=at.shape[1], rows=at.shape[0], dx=dx, dy=dx if dy is None else dy,
                                 corner=s.Vec3(*map(float, corner))))
    _point_to_reals(packed, np, "heights", at)
    if material is not None:
        packed.row.material = _material_row(material)
    return packed


def heights_of_image(
    image: Any, size: float, height: float, corner: Optional[Sequence[float]] = None
) -> Tuple[Any, float, float, Sequence[float]]:
    """heights (m), dx, dy, corner of an image `size` wide (m): black is 0, white is `height` (m).

    The picture's first row is the far one (largest y). Centred on the origin, unless `corner` (m) says where its low
    left corner lies. image: an array of grey, or of colours (their mean counts), of 8 or 16 bits or of 0 to 1, or an
    object that numpy.asarray takes, as Pillow's.
    """
    np = numpy()
    picture = np.asarray(image)
    white = float(np.iinfo(picture.dtype).max) if picture.dtype.kind in "iu" else 1.0
    grey = picture.astype(np.float64) / white
    if grey.ndim == 3:
        grey = grey[..., :3].mean(axis=2)
    if grey.ndim != 2 or min(grey.shape) < 2:
        raise BadParameters(f"image: rows and columns, 2 or more of each, are needed; this one has the shape {picture.shape}")
    rows, columns = grey.shape
    d = size / (columns - 1)
    middle = (-size / 2, -d * (rows - 1) / 2, 0.0)
    return np.ascontiguousarray(grey[::-1] * height), d, d, middle if corner is None else corner
