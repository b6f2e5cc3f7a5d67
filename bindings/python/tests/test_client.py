"""The client end to end, on the local transport and through a bridge, without and with a key."""

import os
import select
import shutil
import sys
import tempfile
import threading
import traceback
import types
import unittest
from unittest import mock

import numpy as np
from support import PRESS, Bridge, ServoCase, run_python, until, until_active

import knurl

CUBE = 0.02 * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
CUBE_FACES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]


class EndToEnd:
    """Runs in each of the classes below, which say how to connect."""

    HAND = PRESS

    def test_a_wall_in_six_lines(self):
        hand = self.claimed()
        floor = hand.add(knurl.Plane(normal=(0, 0, 1), offset=0.0, stiffness=800))
        hand.arm()
        until_active(hand)
        felt = None
        for report in hand.reports(rate=60, timeout=10):
            floor.offset = 0.001 * np.sin(report.time)
            felt = floor.feedback
            if felt is not None and felt.touching and felt.force[2] > 0.1:
                break
            self.assertLess(report.time, 30)
        self.assertEqual(felt.stiffness, 800)
        self.assertEqual(felt.force.shape, (3,))
        self.assertAlmostEqual(felt.force[0], 0)
        self.assertEqual(floor.applied_stiffness, 800)

    def test_the_force_is_the_plane_s(self):
        hand = self.claimed()
        hand.add(knurl.Plane(stiffness=500))
        hand.arm()
        report = until(hand, lambda report: report.state == 4 and report.touching and abs(report.velocity[2]) < 1e-4, 20000)
        # the depth when the force was computed is the report's own; encoders have 30 um
        self.assertAlmostEqual(report.scene_force[2], -500 * report.position[2], delta=500 * 1e-4)
        self.assertTrue(report.flags & knurl.ReportFlags.TOUCHING)
        self.assertGreater(report.touches, 0)
        self.assertEqual(report.faults, 0)

    def test_stiffness_is_clamped_to_the_device(self):
        hand = self.claimed()
        wall = hand.add(knurl.Plane(stiffness=knurl.INFINITY, offset=-0.1))
        hand.commit()
        until(hand, lambda report: wall.applied_stiffness is not None)
        self.assertAlmostEqual(wall.applied_stiffness, hand.limits.max_stiffness, delta=1)
        self.assertLess(hand.limits.max_stiffness, 10000)

    def test_commit_takes_effect_in_one_cycle(self):
        hand = self.claimed()
        planes = [hand.add(knurl.Plane(stiffness=100, offset=-0.1)) for _ in range(5)]
        hand.commit()
        for plane in planes:
            plane.offset = -0.2
        number = hand.commit()
        self.assertTrue(hand.wait_applied(number, 5))
        self.assertTrue(hand.wait_applied(timeout=5))
        until(hand, lambda report: hand.timing.batches > 0)
        self.assertEqual(hand.timing.refused, 0)

    def test_together(self):
        hand = self.claimed()
        with hand.together():
            first = hand.add(knurl.Plane(stiffness=100, offset=-0.1))
            hand.add(knurl.Sphere(stiffness=100, center=(0, 0, -1)))
            hand.place_probe(1, offset=(0, 0, 0.01), radius=0.005)
        until(hand, lambda report: first.applied_stiffness is not None)
        with self.assertRaises(ZeroDivisionError):
            with hand.together():
                hand.place_probe(1, radius=0.004)
                hand.add(knurl.Plane(stiffness=100))
                1 / 0
        hand.commit()
        hand.close()
        small = self.claimed(representations=1)
        with self.assertRaises(ZeroDivisionError):
            with small.together():
                small.add(knurl.Plane(stiffness=100))
                1 / 0
        until(small, lambda report: report.cycle % 10 == 0)
        small.add(knurl.Plane(stiffness=100))  # there is room: the other one was not sent
        small.commit()

    def test_probes(self):
        hand = self.claimed()
        hand.place_probe(2, offset=(0, 0, -0.02), radius=0.001)
        floor = hand.add(knurl.Plane(stiffness=200, offset=-0.03), probe=2)
        hand.arm()
        until(hand, lambda report: (felt := floor.feedback) is not None and felt.touching is False)
        with self.assertRaises(knurl.Error):
            hand.place_probe(16)
        with self.assertRaises(knurl.Error):
            hand.add(knurl.Plane(stiffness=1), probe=16)
        with self.assertRaisesRegex(knurl.BadParameters, "on_silence is 'sleep': it is one of fade, hold, move"):
            hand.add(knurl.Plane(stiffness=1), on_silence="sleep")

    def test_reports_in_order_and_many_at_once(self):
        hand = self.claimed()
        before = None
        for number, report in enumerate(hand.reports(timeout=10)):
            if before is not None:
                self.assertEqual(report.cycle, before.cycle + 1 + report.missed - before.missed)
                self.assertGreaterEqual(report.time, before.time)
            before = report
            if number == 50:
                break
        table = hand.drain()
        self.assertEqual(table.dtype.itemsize, 400)
        select.select([hand], [], [], 10)
        while not len(table):
            table = hand.drain()
        self.assertEqual(table["position"].shape, (len(table), 3))
        self.assertGreater(table["cycle"][0], before.cycle)
        self.assertTrue((np.diff(table["cycle"].astype(np.int64)) >= 1).all())
        self.assertEqual(int(table["missed"][-1]), hand.missed)
        self.assertGreater(hand.seconds(table["read_ns"])[0], before.time)

    def test_newest_latest_and_descriptor(self):
        hand = self.claimed()
        frame = hand.newest(timeout=10)
        self.assertIsInstance(frame, knurl.Frame)
        self.assertTrue(select.select([hand.fileno()], [], [], 10)[0])
        later = hand.newest(timeout=10)
        self.assertGreater(later.cycle, frame.cycle)
        self.assertEqual(later.skipped, later.cycle - frame.cycle - 1)
        self.assertEqual((later.pressed, later.released), (0, 0))
        self.assertGreaterEqual(hand.latest().cycle, later.cycle)
        self.assertEqual(hand.next_report(timeout=10).position.shape, (3,))
        self.assertIn("knurl.Frame cycle", repr(frame))

    def test_devices_limits_timing_age_network(self):
        hand = self.claimed()
        device = hand.device
        self.assertEqual((device.profile, device.rate), ("premium15", 1000.0))
        self.assertIn(device, hand._client.devices())
        self.assertGreater(hand.limits.max_force, 1)
        age, within = hand.age(hand.newest(timeout=10))
        self.assertGreater(age + within, 0)
        self.assertEqual(hand.network.encrypted, self.ENCRYPTED)
        self.assertEqual(hand.predicted_position.shape, (3,))
        self.assertTrue(hand.connected and hand._client.connected)
        self.assertEqual(hand.reattachments, 0)

    def test_meshes_and_heights(self):
        hand = self.claimed()
        sent = hand.send_mesh(CUBE, CUBE_FACES)
        self.assertEqual((sent.faces, sent.parts, sent.edges_open), (12, 1, 0))
        np.testing.assert_allclose((sent.low, sent.high), ((-0.02,) * 3, (0.02,) * 3), atol=1e-8)
        same = hand.send_mesh(types.SimpleNamespace(vertices=CUBE.astype(np.float32), faces=np.array(CUBE_FACES)), scale=0.5,
                              face_materials=[0] * 11 + [1], materials=[knurl.AssetMaterial(), knurl.AssetMaterial(stiffness=0.5)])
        self.assertAlmostEqual(same.high[0], 0.01, places=6)
        cube = hand.add(knurl.Shape(asset=sent.asset, position=(0, 0, -0.02), stiffness=400))
        hand.arm()
        until(hand, lambda report: (felt := cube.feedback) is not None and felt.touching and felt.force[2] > 0.3, 20000)
        hills = hand.send_heights(np.zeros((4, 6)), dx=0.01, dy=0.02, corner=(-0.03, -0.03, 0))
        np.testing.assert_allclose(hills.high, (0.02, 0.03, 0), atol=1e-7)
        picture = hand.send_image(np.array([[0, 0, 0], [255, 0, 0]], np.uint8), size=0.02, height=0.01)
        np.testing.assert_allclose((picture.low, picture.high), ((-0.01, -0.005, 0), (0.01, 0.005, 0.01)), atol=1e-7)
        hand.forget(same.asset)
        with self.assertRaises(knurl.Error):
            hand.forget(sent.asset)

    def test_bad_meshes(self):
        hand = self.claimed()
        for vertices, faces, words in (
            (CUBE, [(0, 1, 8)], "faces: vertex 8 is not there; there are 8"),
            (CUBE, [(0, 1)], "three a triangle"),
            (CUBE, [(0.0, 1.0, 2.0)], "whole numbers"),
            (CUBE[:, :2], [(0, 1, 2)], "of shape \\(n, 3\\)"),
            (CUBE, None, "give vertices and faces, or an object that has both"),
        ):
            with self.assertRaisesRegex(knurl.BadParameters, words):
                hand.send_mesh(vertices, faces)
        for heights in (np.zeros(5), np.zeros((1, 5)), np.full((3, 3), np.nan)):
            with self.assertRaises(knurl.Error):
                hand.send_heights(heights, 0.01)
        with self.assertRaises(knurl.Error):
            hand.send_mesh(np.zeros((0, 3)), np.zeros((0, 3), int))

    def test_follow(self):
        hand = self.claimed()
        centre, radius = np.array((0.01, 0, -0.045)), 0.05

        def ball(near):
            normal = (near - centre) / np.linalg.norm(near - centre)
            return knurl.SurfacePoint(centre + radius * normal, normal, -1 / radius, -1 / radius)

        floor, cap = hand.add(knurl.Plane(stiffness=500)), hand.add(knurl.Cap(stiffness=100))
        hand.arm()
        found = None
        for report in hand.reports(rate=60, timeout=10):
            found = floor.follow(lambda near: (ball(near).foot, ball(near).normal))
            cap.follow(ball)
            if found.faces and floor.feedback is not None and floor.feedback.touching:
                break
            self.assertLess(report.time, 30)
        self.assertGreaterEqual(found.asked, 1)
        # what was set lies on the ball, and the parameters here are those that were set
        self.assertAlmostEqual(np.dot(floor.normal, centre) - floor.offset, -radius, delta=1e-6)
        floor.stiffness = 400
        hand.commit()
        self.assertTrue(hand.wait_applied(timeout=5))

    def test_an_exception_in_a_model_comes_out_of_follow(self):
        hand = self.claimed()
        floor = hand.add(knurl.Plane(stiffness=500, offset=-0.1))
        hand.newest(timeout=10)

        def broken(near):
            raise KeyError("the terrain has no such tile")

        try:
            floor.follow(broken)
            self.fail("follow() hid the exception")
        except KeyError as error:
            self.assertIn("broken", [frame.name for frame in traceback.extract_tb(error.__traceback__)])
        with self.assertRaises(TypeError):
            floor.follow(lambda near: None)
        with self.assertRaisesRegex(knurl.BadParameters, "normal is 0 0 0"):
            floor.follow(lambda near: (near, (0, 0, 0)))
        self.assertEqual(floor.offset, -0.1)
        hand.commit()
        with self.assertRaises(knurl.Error):
            hand.add(knurl.Sphere(stiffness=1)).follow(lambda near: (near, near))

    def test_an_interrupt_at_the_entry_of_a_model_comes_out_of_follow(self):
        """Python may run a signal's handler before the callback's first statement; ctypes drops what it raises."""
        hand = self.claimed()
        floor = hand.add(knurl.Plane(stiffness=500, offset=-0.1))
        hand.newest(timeout=10)

        def interrupted(*_):
            raise KeyboardInterrupt

        with mock.patch.object(hand, "_evaluate", interrupted), mock.patch.object(sys, "unraisablehook") as dropped:
            with self.assertRaises(KeyboardInterrupt):
                floor.follow(lambda near: (near, near))
        dropped.assert_called_once()
        self.assertEqual(floor.offset, -0.1)

    def test_two_threads(self):
        """One reads and measures while another one commits."""
        hand = self.claimed()
        floor = hand.add(knurl.Plane(stiffness=300, offset=-0.1))
        done, read = threading.Event(), []

        def reads():
            while not done.is_set():
                report = hand.newest(timeout=1)
                read.append(report.cycle if report is not None else 0)
                hand.timing

        thread = threading.Thread(target=reads)
        thread.start()
        for turn in range(300):
            floor.offset = -0.1 - turn * 1e-5
            number = hand.commit()
            if turn % 30 == 0:
                self.assertTrue(hand.wait_applied(number, 10))
        done.set()
        thread.join()
        self.assertEqual(read, sorted(read))
        self.assertEqual(hand.timing.refused, 0)

    def test_a_waiting_call_ends_when_another_thread_closes(self):
        hand = self.claimed()
        errors = []

        def waits():
            try:
                for _ in hand.reports():
                    pass
            except knurl.Error as error:
                errors.append(error)

        thread = threading.Thread(target=waits)
        thread.start()
        hand.newest(timeout=10)
        hand.close()
        thread.join(20)
        self.assertFalse(thread.is_alive())
        self.assertIsInstance(errors[0], knurl.BadHandle)

    def test_after_close(self):
        hand = self.claimed()
        floor = hand.add(knurl.Plane(stiffness=100))
        hand.close()
        hand.close()
        for call in (hand.commit, hand.arm, hand.newest, hand.latest, hand.drain, hand.fileno, floor.remove, lambda: hand.limits,
                     lambda: floor.feedback, lambda: hand.add(knurl.Plane()), lambda: hand.send_heights(np.zeros((3, 3)), 0.01)):
            with self.assertRaisesRegex(knurl.BadHandle, "closed"):
                call()
        client = self.connected()
        client.close()
        client.close()
        for call in (client.devices, client.claim, client.observe, lambda: client.servo_pid):
            with self.assertRaisesRegex(knurl.BadHandle, "closed"):
                call()

    def test_the_end_of_a_block_releases_the_device(self):
        client = self.connected()
        with client.claim() as hand:
            hand.commit()
        with self.assertRaises(knurl.BadHandle):
            hand.commit()
        with client.claim() as again:
            again.commit()
        with client.observe() as observer:
            pass
        with self.assertRaises(knurl.BadHandle):
            observer.latest()

    def test_closing_the_client_ends_its_claims(self):
        with self.connected() as client:
            hand = client.claim()
            hand.add(knurl.Plane(stiffness=100))
        with self.assertRaises(knurl.BadHandle):
            hand.commit()
        self.claimed()  # the device is free

    def test_a_held_device_and_an_observer(self):
        hand = self.claimed()
        client = self.connected()
        with self.assertRaises(knurl.DeviceHeld) as caught:
            client.claim()
        if not self.REMOTE:
            self.assertEqual(caught.exception.holder, os.getpid())
            self.assertIn(str(os.getpid()), str(caught.exception))
        with client.observe() as observer:
            self.assertGreater(until(observer, lambda report: True).cycle, 0)
            self.assertGreater(len(list(zip(range(5), observer.reports(rate=500, timeout=10)))), 4)
        with self.assertRaises(knurl.NoSuchDevice) as caught:
            client.claim("left")
        self.assertIn("premium15", str(caught.exception))
        hand.commit()

    def test_sharing(self):
        first = self.claimed(shared=True)
        second = self.claimed(shared=True)
        first.add(knurl.Plane(stiffness=300))
        second.add(knurl.Viscosity(damping=1))
        first.arm()
        second.arm()
        until_active(first)

    def test_the_world_of_a_claim(self):
        hand = self.claimed(workspace_radius=1.0, workspace_centre=(5, 0, 0))
        self.assertAlmostEqual(hand.limits.metre, 10)
        report = hand.newest(timeout=10)
        self.assertAlmostEqual(report.position[0], 5, delta=0.5)
        with self.assertRaises(knurl.Error):
            hand._client.claim(representations=0)

    def test_disarm_and_reset(self):
        hand = self.claimed()
        hand.arm()
        hand.disarm()
        with self.assertRaises(knurl.Refused):
            hand.reset_fault()
        with self.assertRaises(knurl.Error):
            hand._client.reset_fault("left")

    def test_bad_policies_and_rates(self):
        hand = self.claimed()
        with self.assertRaisesRegex(knurl.BadParameters, "alive is 'forever': it is one of loop, interpreter, always"):
            hand.keep_alive("forever")
        with self.assertRaises(knurl.BadParameters):
            next(hand.reports(rate=0))


class Local(EndToEnd, ServoCase):
    ENCRYPTED, REMOTE = False, False

    def test_an_application_on_the_same_servo_holds_it(self):
        self.claimed()
        done = run_python("import sys, knurl; knurl.connect(sys.argv[1]).claim()", self.servo.address)
        self.assertRegex(done.stderr.strip().splitlines()[-1], rf"^knurl._errors.DeviceHeld: .*{os.getpid()}")


class ThroughBridge(EndToEnd, ServoCase):
    ENCRYPTED, REMOTE = False, True
    KEY = False

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, folder)
        cls.bridge = Bridge(cls.servo, folder, cls.KEY)
        cls.addClassCleanup(cls.bridge.close)

    def connected(self, **options):
        options.setdefault("key_file", self.bridge.key_file)
        client = knurl.connect(self.bridge.address, wait=10, **options)
        self.addCleanup(client.close)
        return client


class ThroughBridgeWithKey(ThroughBridge):
    ENCRYPTED, KEY = True, True

    def test_without_the_key(self):
        with self.assertRaises(knurl.Permission) as caught:
            knurl.connect(self.bridge.address, wait=1)
        self.assertIn("key", str(caught.exception))
        with self.assertRaises(knurl.Error) as caught:
            knurl.connect(self.bridge.address, key_file="/nowhere.key", wait=1)
        self.assertIn("/nowhere.key", str(caught.exception))

    def test_fewer_reports(self):
        with self.connected(report_rate=50) as client, client.observe() as observer:
            first, *_, last = (observer.next_report(10).cycle for _ in range(20))
            self.assertGreater(last - first, 19 * 1000 / 50 / 2)


class Addresses(unittest.TestCase):
    def test_nobody_there(self):
        for address, kind in (("knurl:nobody", knurl.NoServo), ("knurl://127.0.0.1:1", knurl.NoServo), ("knurl:../up", knurl.Error),
                              ("knurl://", knurl.Error), ("/" + "long" * 40 + ".sock", knurl.Error)):
            with self.subTest(address=address), self.assertRaises(kind) as caught:
                knurl.connect(address, wait=0.02)
            self.assertNotIn("\n", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
