"""Every kind as a dataclass: what the library's tables say, there and back, and what is refused."""

import copy
import dataclasses
import math
import pickle
import random
import unittest

import numpy as np
from support import ServoCase

import knurl
from knurl import _kinds


def example_of(kind, rng):
    """A representation with values that are legal and not the defaults."""
    made = kind()
    values = dict(stiffness=rng.uniform(100, 900), damping=rng.uniform(0.1, 2), recovery=rng.uniform(0.01, 0.3))
    for field in dataclasses.fields(kind):
        if field.name in values:
            setattr(made, field.name, values[field.name])
    if hasattr(made, "friction"):
        made.friction.static_, made.friction.dynamic, made.snag.seed, made.texture.pattern = 0.7, 0.25, 4294967295, "rings"
    return made


class Tables(unittest.TestCase):
    def test_all_kinds_of_the_library_are_there(self):
        names = {kind.__name__ for kind in _kinds.KINDS}
        self.assertLessEqual({"Plane", "Spring", "ConstantForce", "Cap", "Polygon", "HalfPlane", "Box", "Sphere", "Capsule",
                              "Cylinder", "Torus", "Taylor", "Taylor6", "Viscosity", "Gravity", "Magnet", "Constraint",
                              "Vibration", "Shape"}, names)
        for name in names:
            self.assertIs(getattr(knurl, name)._KIND, getattr(_kinds, name)._KIND)

    def test_every_parameter_has_a_text(self):
        with open(_kinds.__file__, encoding="utf-8") as file:
            text = file.read()
        for wanted in ("stiffness: float = 0.0\n    \"\"\"Force per depth (N/m); 0 to 1e+09, or INFINITY",
                       "recovery: float = AUTOMATIC", "offset: float = 0.0\n    \"\"\"n.x >= offset is free (m)"):
            self.assertIn(wanted, text)

    def test_defaults_are_the_library_s(self):
        self.assertEqual(knurl.Vibration().frequency, 100.0)
        self.assertEqual(knurl.Box().half_size, (0.05, 0.05, 0.05))
        self.assertEqual(len(knurl.Polygon().vertices), 4)
        self.assertEqual(knurl.Plane().friction.static_, knurl.AUTOMATIC)
        self.assertEqual(knurl.Gravity().acceleration, (0.0, 0.0, -9.81))

    def test_there_and_back(self):
        rng = random.Random(7)
        for kind in _kinds.KINDS:
            for made in (kind(), example_of(kind, rng)):
                with self.subTest(kind=kind.__name__):
                    back = kind()
                    back._load(made._packed_bytes())
                    self.assertEqual(back, made)

    def test_matrix_points_and_quaternion_lie_where_the_library_reads_them(self):
        field = knurl.Taylor6(jacobian=-np.eye(6) * np.arange(1, 7), orientation=(0, 1, 0, 0))
        back = knurl.Taylor6()
        back._load(field._packed_bytes())
        self.assertEqual(back.jacobian[5], (0, 0, 0, 0, 0, -6))
        self.assertEqual(back.orientation, (0, 1, 0, 0))
        triangle = knurl.Polygon(vertices=[(0, 0, 0), (1, 0, 0), (0, 1, 0)])
        triangle.validate()
        back = knurl.Polygon()
        back._load(triangle._packed_bytes())
        self.assertEqual(back.vertices, ((0, 0, 0), (1, 0, 0), (0, 1, 0)))

    def test_defaults_are_valid_where_they_need_nothing_else(self):
        for kind in _kinds.KINDS:
            with self.subTest(kind=kind.__name__):
                made = kind()
                if kind is knurl.Magnet:  # its default has no stiffness, so its pull never peaks
                    made.stiffness = 200
                made.validate()


class Assignment(unittest.TestCase):
    def test_arrays_tuples_and_lists(self):
        for normal in ((0, 0, 1), [0, 0, 1], np.array([0, 0, 1]), np.array([0, 0, 1], np.float32)):
            self.assertEqual(knurl.Plane(normal=normal).normal, (0.0, 0.0, 1.0))
        self.assertEqual(knurl.Plane(offset=np.float32(0.5)).offset, 0.5)
        self.assertEqual(knurl.Plane(stiffness=knurl.INFINITY).stiffness, math.inf)

    def test_a_wrong_shape_is_told_where_it_is_written(self):
        for parameters, words in (
            (dict(normal=(0, 0)), "plane: normal is (0, 0): a vector has 3 numbers, not 2"),
            (dict(normal=5), "plane: normal is 5"),
            (dict(offset="high"), "plane: offset is 'high'"),
            (dict(update="slowly"), "plane: update is 'slowly': it is one of fade, paper, last_depth"),
            (dict(friction=0.3), "plane: friction is 0.3: give a knurl.Friction"),
        ):
            with self.assertRaises(knurl.BadParameters) as caught:
                knurl.Plane(**parameters)
            self.assertIn(words, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))
        with self.assertRaises(knurl.BadParameters):
            knurl.Snag(seed=-1)
        with self.assertRaises(knurl.BadParameters):
            knurl.Taylor(jacobian=np.zeros((3, 2)))
        with self.assertRaises(knurl.BadParameters):
            knurl.Polygon(vertices=np.zeros((9, 3)))

    def test_a_misspelt_parameter_is_no_new_attribute(self):
        plane = knurl.Plane()
        with self.assertRaisesRegex(AttributeError, "plane has no parameter 'ofset'; it has normal, offset"):
            plane.ofset = 1
        with self.assertRaises(AttributeError):
            del plane.offset
        with self.assertRaises(TypeError):
            knurl.Plane(ofset=1)

    def test_ranges_are_the_library_s(self):
        for made, words in (
            (knurl.Plane(stiffness=-1), ("plane", "stiffness = -1 N/m", "0 to 1000000000")),
            (knurl.Plane(offset=math.nan), ("offset", "nan")),
            (knurl.Plane(normal=(0, 0, 0)), ("normal",)),
            (knurl.Plane(friction=knurl.Friction(static_=0.1, dynamic=0.2)), ("friction.static = 0.1", "friction.dynamic")),
            (knurl.Magnet(stiffness=100, max_force=5, max_distance=0.01), ("max_distance", "max_force / stiffness")),
            (knurl.Polygon(vertices=[(0, 0, 0), (1, 0, 0)]), ("vertices",)),
        ):
            with self.assertRaises(knurl.BadParameters) as caught:
                made.validate()
            for word in words:
                self.assertIn(word, str(caught.exception))
            self.assertIsInstance(caught.exception, ValueError)

    def test_set_takes_all_or_nothing(self):
        plane = knurl.Plane(stiffness=500)
        with self.assertRaises(knurl.BadParameters):
            plane.set(offset=0.1, stiffness=-5)
        self.assertEqual((plane.offset, plane.stiffness), (0.0, 500.0))
        plane.set(offset=0.1, stiffness=400)
        self.assertEqual((plane.offset, plane.stiffness), (0.1, 400.0))

    def test_a_representation_prints_what_is_not_usual(self):
        plane = knurl.Plane(offset=0.1, friction=knurl.Friction(dynamic=0.3))
        self.assertEqual(repr(plane), "Plane(offset=0.1, friction=Friction(dynamic=0.3))")
        self.assertEqual(eval(repr(plane), vars(knurl)), plane)
        self.assertNotEqual(plane, knurl.Plane())
        self.assertNotEqual(knurl.Spring(), knurl.Plane())

    def test_parts_are_copied(self):
        friction = knurl.Friction(dynamic=0.3)
        first, second = knurl.Plane(friction=friction), knurl.Box(friction=friction)
        first.friction.dynamic = 0.5
        self.assertEqual((friction.dynamic, second.friction.dynamic), (0.3, 0.3))

    def test_materials(self):
        self.assertIn("rubber", knurl.materials)
        rubber = knurl.Plane.made_of("rubber", offset=0.01)
        self.assertGreater(rubber.stiffness, 0)
        self.assertEqual(rubber.offset, 0.01)
        for kind in (knurl.Box, knurl.Shape, knurl.Cap):
            self.assertEqual(kind.made_of("rubber").friction, rubber.friction)
        with self.assertRaisesRegex(knurl.BadParameters, "no material is called 'gum'; there are concrete"):
            knurl.Plane.made_of("gum")
        with self.assertRaisesRegex(knurl.BadParameters, "no surface"):
            knurl.Spring.made_of("rubber")


class Bound(ServoCase):
    def test_every_kind_on_a_servo(self):
        hand = self.claimed()
        rng = random.Random(11)
        for kind in _kinds.KINDS:
            with self.subTest(kind=kind.__name__):
                template = example_of(kind, rng)
                if kind is knurl.Magnet:
                    template.max_distance = 0.1
                bound = hand.add(template)
                self.assertEqual(bound, template)
                self.assertTrue(bound.added)
                self.assertFalse(template.added)
                if hasattr(bound, "recovery"):
                    bound.recovery = 0.5
                hand.commit()
                self.assertTrue(hand.wait_applied())
                held = kind()
                self.read_back(hand, bound, held)
                self.assertEqual(held, bound)
                bound.remove()
                self.assertFalse(bound.added)

    def read_back(self, hand, bound, held):
        from knurl._library import check, lib

        packed = held._packed()
        check(lib.knurl_get(hand._handle, bound._id, bound._KIND, packed))
        held._load(packed)

    def test_a_part_s_assignment_is_sent(self):
        hand = self.claimed()
        floor = hand.add(knurl.Plane(stiffness=500))
        hand.commit()
        held = knurl.Plane()
        floor.friction.dynamic = 0.3
        hand.commit()
        self.read_back(hand, floor, held)
        self.assertEqual(held.friction.dynamic, 0.3)
        floor.texture = knurl.Texture(amplitude=1e-4)
        hand.commit()
        floor.texture.wavelength = 2e-3
        hand.commit()
        self.read_back(hand, floor, held)
        self.assertEqual((held.friction.dynamic, held.texture.amplitude, held.texture.wavelength), (0.3, 1e-4, 2e-3))

    def test_what_commit_refuses_is_taken_back(self):
        hand = self.claimed()
        floor, other = hand.add(knurl.Plane(stiffness=500)), hand.add(knurl.Plane(stiffness=400))
        other.offset = -0.01
        floor.stiffness = -1
        with self.assertRaisesRegex(knurl.BadParameters, "plane.stiffness = -1"):
            hand.commit()
        self.assertEqual(floor.stiffness, 500)
        hand.commit()
        self.assertTrue(hand.wait_applied())
        held = knurl.Plane()
        self.read_back(hand, other, held)
        self.assertEqual(held.offset, -0.01)
        with self.assertRaises(knurl.BadParameters):
            hand.add(knurl.Plane(stiffness=-1))

    def test_a_copy_is_on_no_hand(self):
        hand = self.claimed()
        floor = hand.add(knurl.Plane(stiffness=500))
        for twin in (copy.copy(floor), copy.deepcopy(floor), pickle.loads(pickle.dumps(floor)), dataclasses.replace(floor)):
            self.assertFalse(twin.added)
            self.assertEqual(twin, floor)
            with self.assertRaises(knurl.Stale):
                twin.feedback
        self.assertTrue(hand.add(floor).added)

    def test_a_removed_one_is_stale(self):
        hand = self.claimed()
        floor = hand.add(knurl.Plane(stiffness=500))
        floor.offset = 0.1
        floor.remove()
        hand.commit()
        for call in (floor.remove, lambda: floor.feedback, lambda: floor.applied_stiffness):
            with self.assertRaisesRegex(knurl.Stale, "this plane is on no hand"):
                call()


if __name__ == "__main__":
    unittest.main()
