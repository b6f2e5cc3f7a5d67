"""The plain structs of knurl.h and knurl_offline.h, in their order. What each member means is said there.

A vector is an array of three doubles here, a quaternion one of four (w x y z): the same bytes.
"""

from __future__ import annotations

import ctypes as c
from typing import Any, cast

Vec3 = c.c_double * 3
Quat = c.c_double * 4


class Sized(c.Structure):
    """A struct that begins with its own size."""

    size: int

    def __init__(self, **members: Any) -> None:
        super().__init__(**members)
        self.size = c.sizeof(self)


class ConnectOptions(Sized):
    """knurl_connect_options"""

    _fields_ = [
        ("size", c.c_uint64),
        ("name", c.c_char_p),
        ("wait_ns", c.c_int64),
        ("reattach", c.c_uint32),
        ("hints", c.c_uint32),
        ("report_rate", c.c_double),
        ("key_file", c.c_char_p),
    ]


class DeviceRow(Sized):
    """knurl_device"""

    _fields_ = [
        ("size", c.c_uint64),
        ("name", c.c_char * 64),
        ("address", c.c_char * 128),
        ("profile", c.c_char * 64),
        ("serial", c.c_char * 64),
        ("rate", c.c_double),
        ("workspace_centre", Vec3),
        ("workspace_radius", c.c_double),
        ("peak_force", c.c_double),
        ("peak_torque", c.c_double),
        ("max_stiffness", c.c_double),
        ("renders_torque", c.c_uint32),
        ("senses_orientation", c.c_uint32),
    ]


class ClaimOptions(Sized):
    """knurl_claim_options"""

    _fields_ = [
        ("size", c.c_uint64),
        ("shared", c.c_uint32),
        ("representations", c.c_uint32),
        ("workspace_radius", c.c_double),
        ("workspace_centre", Vec3),
        ("update_interval_ns", c.c_int64),
    ]


class ReportRow(Sized):
    """knurl_report"""

    _fields_ = [
        ("size", c.c_uint64),
        ("cycle", c.c_uint64),
        ("deadline_ns", c.c_int64),
        ("read_ns", c.c_int64),
        ("write_ns", c.c_int64),
        ("joints", c.c_double * 8),
        ("position", Vec3),
        ("orientation", Quat),
        ("velocity", Vec3),
        ("slow_velocity", Vec3),
        ("angular_velocity", Vec3),
        ("scene_force", Vec3),
        ("scene_torque", Vec3),
        ("sent_force", Vec3),
        ("sent_torque", Vec3),
        ("contact_point", Vec3),
        ("state", c.c_uint32),
        ("faults", c.c_uint32),
        ("buttons", c.c_uint32),
        ("flags", c.c_uint32),
        ("late_count", c.c_uint64),
        ("presses", c.c_uint32),
        ("touches", c.c_uint32),
        ("missed", c.c_uint64),
        ("unread", c.c_uint64),
    ]


class FrameRow(Sized):
    """knurl_frame"""

    _fields_ = [
        ("size", c.c_uint64),
        ("pressed", c.c_uint32),
        ("released", c.c_uint32),
        ("touched", c.c_uint32),
        ("touches", c.c_uint32),
        ("skipped", c.c_uint64),
        ("report", cast(Any, ReportRow)),
    ]


class NetworkRow(Sized):
    """knurl_network"""

    _fields_ = [
        ("size", c.c_uint64),
        ("lost", c.c_uint64),
        ("late", c.c_uint64),
        ("duplicated", c.c_uint64),
        ("resent", c.c_uint64),
        ("round_trip_ns", c.c_int64),
        ("clock_offset_ns", c.c_int64),
        ("clock_uncertainty_ns", c.c_int64),
        ("drift", c.c_double),
        ("drift_uncertainty", c.c_double),
        ("encrypted", c.c_uint32),
        ("reserved", c.c_uint32),
    ]


class AddOptions(Sized):
    """knurl_add_options"""

    _fields_ = [
        ("size", c.c_uint64),
        ("probe", c.c_uint32),
        ("on_silence", c.c_uint32),
        ("silence_time", c.c_double),
        ("feedback", c.c_uint32),
        ("reserved", c.c_uint32),
    ]


class FeedbackRow(Sized):
    """knurl_feedback"""

    _fields_ = [
        ("size", c.c_uint64),
        ("force", Vec3),
        ("torque", Vec3),
        ("contact_point", Vec3),
        ("stiffness", c.c_double),
        ("tangential_stiffness", c.c_double),
        ("share", c.c_double),
        ("damping_share", c.c_double),
        ("cycle", c.c_uint64),
        ("flags", c.c_uint32),
        ("reserved", c.c_uint32),
    ]


class LimitsRow(Sized):
    """knurl_limits"""

    _fields_ = [
        ("size", c.c_uint64),
        ("max_stiffness", c.c_double),
        ("max_force", c.c_double),
        ("max_torque", c.c_double),
        ("max_torsion", c.c_double),
        ("damping", c.c_double),
        ("mass", c.c_double),
        ("lag", c.c_double),
        ("period", c.c_double),
        ("resolution", c.c_double),
        ("metre", c.c_double),
        ("newton", c.c_double),
    ]


class TimingRow(Sized):
    """knurl_timing"""

    _fields_ = [
        ("size", c.c_uint64),
        ("age_at_use_ns", c.c_int64),
        ("interval_ns", c.c_int64),
        ("batches", c.c_uint64),
        ("refused", c.c_uint64),
        ("undersampled", c.c_uint64),
    ]


class SurfacePointRow(c.Structure):
    """knurl_surface_point"""

    _fields_ = [
        ("foot", Vec3),
        ("normal", Vec3),
        ("curvature", c.c_double),
        ("curvature2", c.c_double),
        ("axis", Vec3),
    ]


class FollowedRow(Sized):
    """knurl_followed"""

    _fields_ = [
        ("size", c.c_uint64),
        ("faces", c.c_uint32),
        ("asked", c.c_uint32),
        ("look_ahead", c.c_double),
        ("trust", c.c_double),
        ("kept_side", c.c_uint32),
        ("undersampled", c.c_uint32),
    ]


class AssetMaterialRow(c.Structure):
    """knurl_asset_material"""

    _fields_ = [("stiffness", c.c_double), ("damping", c.c_double), ("friction", c.c_double)]


class MeshRow(Sized):
    """knurl_mesh"""

    _fields_ = [
        ("size", c.c_uint64),
        ("vertices", c.c_void_p),
        ("vertices_float", c.c_void_p),
        ("vertex_count", c.c_uint64),
        ("triangles", c.c_void_p),
        ("triangle_count", c.c_uint64),
        ("triangle_materials", c.c_void_p),
        ("materials", c.c_void_p),
        ("material_count", c.c_uint64),
        ("scale", c.c_double),
        ("weld", c.c_double),
        ("exact", c.c_uint32),
        ("no_crossings", c.c_uint32),
    ]


class HeightsRow(Sized):
    """knurl_heights"""

    _fields_ = [
        ("size", c.c_uint64),
        ("heights", c.c_void_p),
        ("heights_float", c.c_void_p),
        ("columns", c.c_uint32),
        ("rows", c.c_uint32),
        ("dx", c.c_double),
        ("dy", c.c_double),
        ("corner", Vec3),
        ("material", AssetMaterialRow),
    ]


class SentRow(Sized):
    """knurl_sent"""

    _fields_ = [
        ("size", c.c_uint64),
        ("asset", c.c_uint32),
        ("reserved", c.c_uint32),
        ("faces", c.c_uint64),
        ("bytes", c.c_uint64),
        ("low", Vec3),
        ("high", Vec3),
        ("vertices_welded", c.c_uint64),
        ("faces_dropped", c.c_uint64),
        ("faces_turned", c.c_uint64),
        ("edges_open", c.c_uint64),
        ("edges_non_manifold", c.c_uint64),
        ("faces_crossed", c.c_uint64),
        ("parts", c.c_uint64),
    ]


class FieldRow(Sized):
    """knurl_field"""

    _fields_ = [
        ("size", c.c_uint64),
        ("name", c.c_char_p),
        ("unit", c.c_char_p),
        ("meaning", c.c_char_p),
        ("type", c.c_uint32),
        ("count", c.c_uint32),
        ("offset", c.c_uint64),
        ("minimum", c.c_double),
        ("maximum", c.c_double),
        ("infinity_allowed", c.c_uint32),
        ("automatic_allowed", c.c_uint32),
    ]


class OfflineOptions(Sized):
    """knurl_offline_options"""

    _fields_ = [
        ("size", c.c_uint64),
        ("rate", c.c_double),
        ("representations", c.c_uint32),
        ("reserved", c.c_uint32),
    ]


class PoseRow(c.Structure):
    """knurl_pose"""

    _fields_ = [
        ("position", Vec3),
        ("orientation", Quat),
        ("velocity", Vec3),
        ("angular_velocity", Vec3),
        ("has_velocity", c.c_uint32),
        ("buttons", c.c_uint32),
    ]


class CycleRow(Sized):
    """knurl_cycle"""

    _fields_ = [
        ("size", c.c_uint64),
        ("time", c.c_double),
        ("position", Vec3),
        ("velocity", Vec3),
        ("force", Vec3),
        ("torque", Vec3),
        ("contact_point", Vec3),
        ("flags", c.c_uint32),
        ("buttons", c.c_uint32),
    ]


# int model(void* user, const knurl_vec3* near, knurl_surface_point* out)
SurfaceModel = c.CFUNCTYPE(c.c_int, c.c_void_p, c.POINTER(Vec3), c.POINTER(SurfacePointRow))
