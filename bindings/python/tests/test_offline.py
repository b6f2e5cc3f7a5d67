"""The servo in this process, against closed forms."""

import unittest

import numpy as np

import knurl
from knurl._assets import heights_of_image

STEP = 1e-3  # s


class ClosedForms(unittest.TestCase):
    def test_a_plane(self):
        """F = k depth n, once the cross-fade of adding it is over; nothing above."""
        normal = np.array((1, 2, 2)) / 3
        servo = knurl.Offline()
        servo.add(knurl.Plane(normal=normal, offset=0.01, stiffness=800))
        rng = np.random.default_rng(3)
        places = rng.uniform(-0.02, 0.02, (500, 3))
        felt = servo.run(places, velocities=np.zeros((500, 3)))
        depth = 0.01 - places @ normal
        np.testing.assert_allclose(felt["force"], 800 * np.maximum(depth, 0)[:, None] * normal, atol=1e-9)
        np.testing.assert_array_equal((felt["flags"] & 8) != 0, depth > 0)
        np.testing.assert_allclose(felt["time"], np.arange(500) * STEP, atol=1e-12)

    def test_damping_along_the_normal_never_pulls(self):
        servo = knurl.Offline()
        servo.add(knurl.Plane(stiffness=500, damping=2))
        into = servo.step((0, 0, -0.002), velocity=(0, 0, -0.1))
        self.assertAlmostEqual(into.force[2], 500 * 0.002 + 2 * 0.1)
        out = servo.step((0, 0, -0.002), velocity=(0, 0, 3))
        self.assertEqual(out.force[2], 0)

    def test_a_spring(self):
        """F = k (anchor - x) for rest length 0."""
        servo = knurl.Offline()
        anchor = np.array((0.01, -0.02, 0.03))
        servo.add(knurl.Spring(anchor=anchor, stiffness=120, duration=0))
        rng = np.random.default_rng(4)
        places = rng.uniform(-0.05, 0.05, (200, 3))
        felt = servo.run(places, velocities=np.zeros((200, 3)))
        np.testing.assert_allclose(felt["force"], 120 * (anchor - places), atol=1e-9)

    def test_viscosity_and_gravity_and_a_constant_force(self):
        servo = knurl.Offline()
        servo.add(knurl.Viscosity(damping=3, recovery=0))
        servo.add(knurl.Gravity(mass=0.1, recovery=0))
        servo.add(knurl.ConstantForce(force=(1, 0, 0), torque=(0, 0.1, 0), recovery=0))
        felt = servo.step((0, 0, 0), velocity=(0.1, 0.2, 0))
        np.testing.assert_allclose(felt.force, (1 - 0.3, -0.6, -0.981), atol=1e-9)
        np.testing.assert_allclose(felt.torque, (0, 0.1, 0), atol=1e-9)

    def test_a_sphere_from_a_mesh_of_two_triangles_and_a_field_of_heights(self):
        for sent, shape in ((lambda servo: servo.send_mesh([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2), (0, 2, 3)]), knurl.Shape),
                            (lambda servo: servo.send_heights(np.zeros((3, 3)), 0.1, corner=(-0.1, -0.1, 0)), knurl.Shape),
                            (lambda servo: servo.send_image(np.zeros((4, 4)), 0.2, 0.1), knurl.Shape)):
            servo = knurl.Offline()
            asset = sent(servo).asset
            servo.add(shape(asset=asset, stiffness=600, recovery=0))
            path = np.zeros((50, 3))
            path[:, 2] = np.linspace(0.002, -0.002, 50)
            felt = servo.run(path)
            self.assertAlmostEqual(felt["force"][-1, 2], 600 * 0.002, places=5)


    def test_materials_of_faces(self):
        servo = knurl.Offline()
        square = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
        sent = servo.send_mesh(square, [(0, 1, 2), (0, 2, 3)], face_materials=[0, 1],
                               materials=[knurl.AssetMaterial(), knurl.AssetMaterial(stiffness=0.5)])
        servo.add(knurl.Shape(asset=sent.asset, stiffness=600, recovery=0))
        for x, share in ((0.5, 1), (-0.5, 0.5)):
            path = np.zeros((50, 3))
            path[:, 0], path[:, 1], path[:, 2] = x, -x, np.linspace(0.002, -0.002, 50)
            self.assertAlmostEqual(servo.run(path)["force"][-1, 2], share * 600 * 0.002, places=5)
            servo.run(path[::-1])

    def test_an_image_s_first_row_is_the_far_one(self):
        heights, dx, dy, corner = heights_of_image(np.array([[0, 0, 0], [255, 0, 0]], np.uint8), 0.02, 0.01)
        np.testing.assert_array_equal(heights, [[0.01, 0, 0], [0, 0, 0]])
        self.assertEqual((dx, dy, tuple(corner)), (0.01, 0.01, (-0.01, -0.005, 0.0)))
        for white in (np.full((2, 2, 4), 65535, np.uint16), np.ones((2, 2, 3)), np.ones((2, 2), bool) * 1.0):
            np.testing.assert_allclose(heights_of_image(white, 1, 0.5)[0], 0.5)


class Calls(unittest.TestCase):
    def test_run_is_the_same_as_steps(self):
        path = np.zeros((300, 3))
        path[:, 0], path[:, 2] = np.linspace(0, 0.01, 300), 0.002 * np.sin(np.linspace(0, 9, 300))
        felt = []
        for way in ("run", "steps"):
            servo = knurl.Offline()
            servo.add(knurl.Plane.made_of("sandpaper"))
            if way == "run":
                felt.append(servo.run(path)["force"])
            else:
                felt.append(np.array([servo.step(place).force.copy() for place in path]))
        np.testing.assert_array_equal(felt[0], felt[1])
        self.assertGreater(np.abs(felt[0][:, 0]).max(), 0)

    def test_assignment_is_in_force_in_the_next_cycle(self):
        servo = knurl.Offline()
        plane = servo.add(knurl.Plane(stiffness=500, recovery=0))
        self.assertAlmostEqual(servo.step((0, 0, -0.001)).force[2], 0.5)
        plane.stiffness = 1000
        self.assertAlmostEqual(servo.step((0, 0, -0.001), velocity=(0, 0, 0)).force[2], 1.0)
        self.assertTrue(plane.feedback.touching)
        self.assertEqual(plane.applied_stiffness, 1000)
        plane.stiffness = -1
        with self.assertRaisesRegex(knurl.BadParameters, "plane.stiffness = -1"):
            servo.step((0, 0, 0))
        self.assertEqual(plane.stiffness, 1000)
        plane.remove()
        for _ in range(200):
            felt = servo.step((0, 0, -0.001))
        self.assertEqual(felt.force[2], 0)

    def test_reset_gives_the_same_again(self):
        servo = knurl.Offline()
        results = []
        for _ in range(2):
            plane = servo.add(knurl.Plane.made_of("sand"))
            results.append(servo.run(np.linspace((0, 0, 0.001), (0.02, 0, -0.002), 400)).tobytes())
            servo.reset()
            self.assertFalse(plane.added)
        self.assertEqual(results[0], results[1])

    def test_a_device_with_a_hand_of_its_own(self):
        servo = knurl.Offline("sim:premium15", rate=2000)
        servo.add(knurl.Plane(stiffness=800, offset=0.001))
        felt = servo.run(3000)
        self.assertAlmostEqual(felt["time"][-1], 2999 / 2000)
        self.assertGreater(felt["force"][-1, 2], 0)
        self.assertEqual(servo.step().position.shape, (3,))
        with self.assertRaises(knurl.Error):
            servo.step((0, 0, 0))

    def test_turned_probes_and_buttons(self):
        servo = knurl.Offline()
        servo.place_probe(1, offset=(0, 0, -0.01))
        servo.add(knurl.Plane(stiffness=100, recovery=0), probe=1)
        half = np.sqrt(0.5)
        self.assertAlmostEqual(servo.step((0, 0, 0.005), velocity=(0, 0, 0), buttons=2).force[2], 0.5)
        felt = servo.run([(0, 0, 0.005, half, half, 0, 0)], velocities=[(0, 0, 0)])
        self.assertEqual(felt["force"][0, 2], 0)
        self.assertEqual(servo.step((0, 0, 1), buttons=2).buttons, 2)

    def test_bad_input(self):
        servo = knurl.Offline()
        for call in (lambda: servo.run(np.zeros((3, 4))), lambda: servo.run(np.zeros((3, 3)), velocities=np.zeros((2, 3))),
                     lambda: servo.run([(0, 0, np.nan)]), lambda: servo.step((np.inf, 0, 0)), servo.step,
                     lambda: servo.add(knurl.Plane(stiffness=-1)), lambda: knurl.Offline("sim:nonsense"), lambda: knurl.Offline(rate=-5),
                     lambda: servo.send_mesh(np.zeros((2, 3)), [(0, 1, 2)])):
            with self.assertRaises(knurl.Error) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))
        plane = servo.add(knurl.Plane(stiffness=1))
        with self.assertRaisesRegex(knurl.Refused, "follow"):
            plane.follow(lambda near: (near, near))
        servo.close()
        servo.close()
        for call in (lambda: servo.step((0, 0, 0)), servo.reset, plane.remove):
            with self.assertRaisesRegex(knurl.BadHandle, "closed"):
                call()


if __name__ == "__main__":
    unittest.main()
