"""The devices for robot learners, against stand-ins of the contracts (stand_ins.py says what that proves)."""

import inspect
import math
import os
import random
import unittest

import numpy as np
import stand_ins
from support import ServoCase

import knurl

stand_ins.install()

from lerobot_teleoperator_knurl import KnurlTeleop, KnurlTeleopConfig  # noqa: E402
from lerobot_teleoperator_knurl.knurl_teleop import rotation_vector  # noqa: E402

from knurl.isaaclab import KnurlDevice, KnurlDeviceCfg  # noqa: E402



class Scene(ServoCase):
    HAND = [(0, 0.01, 0.02, 0.03), (1000, 0.01, 0.02, 0.03)]

    def settled(self, wanted):
        """Waits until the scene's force is `wanted` (N)."""
        client = self.connected()
        with client.observe() as observer:
            first = observer.next_report(10).cycle
            for report in observer.reports(timeout=20):
                if report.state == knurl.DeviceState.ACTIVE and np.allclose(report.scene_force, wanted, atol=1e-6):
                    return
                self.assertLess(report.cycle - first, 10000, f"{report}: {report.scene_force} N, not {wanted}")


    def until_near(self, read, wanted, tolerance):
        """The hand may still swing from the test before: reads until it is there. Each read is of a newer cycle."""
        for _ in range(20000):
            found = read()
            if np.allclose(found, wanted, atol=tolerance):
                return
        self.fail(f"the hand is at {found}, not at {wanted}")


class LeRobot(Scene):
    def made(self, **more):
        teleop = KnurlTeleop(KnurlTeleopConfig(id="anna", address=self.servo.address, **more))
        self.addCleanup(teleop.disconnect)
        return teleop

    def test_the_contract(self):
        self.assertEqual(KnurlTeleopConfig().type, "knurl")
        self.assertIs(KnurlTeleop.config_class, KnurlTeleopConfig)
        self.assertEqual(KnurlTeleop.name, "knurl")
        self.assertEqual(KnurlTeleop.__name__ + "Config", KnurlTeleopConfig.__name__)
        self.assertFalse(inspect.isabstract(KnurlTeleop))
        self.assertEqual(list(inspect.signature(KnurlTeleop.connect).parameters), ["self", "calibrate"])

    def test_a_loop(self):
        teleop = self.made()
        self.assertFalse(teleop.is_connected)
        self.assertEqual(set(teleop.feedback_features), {"force.x", "force.y", "force.z"})
        with teleop:
            self.assertTrue(teleop.is_connected and teleop.is_calibrated)
            action = teleop.get_action()
            self.assertEqual(set(action), set(teleop.action_features))
            self.assertTrue(all(type(value) is kind for value, kind in zip(action.values(), teleop.action_features.values())))
            self.until_near(lambda: list(teleop.get_action().values())[:3], (0.01, 0.02, 0.03), 2e-3)
            self.assertEqual(action["ee.gripper_pos"], 100.0)
            teleop.send_feedback({"force.x": 0.5, "force.z": -0.25})
            self.settled((0.5, 0, -0.25))
            teleop.send_feedback({"force.y": 30.0})  # shortened
            self.settled((0, 2, 0))
            teleop.hand.add(knurl.Plane(stiffness=300, offset=-0.1))
        self.assertFalse(teleop.is_connected)

    def test_the_workspace(self):
        with self.made(workspace_radius=0.4, workspace_centre=[0.3, 0, 0.2]) as teleop:
            self.until_near(lambda: list(teleop.get_action().values())[:3], (0.34, 0.08, 0.32), 8e-3)

    def test_not_connected_and_twice(self):
        teleop = self.made()
        for call in (teleop.get_action, lambda: teleop.send_feedback({}), lambda: teleop.hand):
            with self.assertRaises(stand_ins.DeviceNotConnectedError):
                call()
        teleop.connect()
        with self.assertRaises(stand_ins.DeviceAlreadyConnectedError):
            teleop.connect()
        with self.assertRaises(knurl.DeviceHeld):
            self.made().connect()
        teleop.disconnect()
        teleop.connect()

    def test_rotation_vectors(self):
        rng = random.Random(5)
        for _ in range(100):
            axis = np.array([rng.gauss(0, 1) for _ in range(3)])
            axis /= np.linalg.norm(axis)
            angle = rng.uniform(0, math.pi)
            sign = rng.choice((-1, 1))
            quaternion = sign * np.array((math.cos(angle / 2), *(math.sin(angle / 2) * axis)))
            np.testing.assert_allclose(rotation_vector(quaternion), angle * axis, atol=1e-12)
        self.assertEqual(rotation_vector((1, 0, 0, 0)), (0, 0, 0))


class IsaacLab(Scene):
    def made(self, **more):
        device = KnurlDevice(KnurlDeviceCfg(address=self.servo.address, **more), getattr(self, "retargeters", None))
        self.addCleanup(device.close)
        return device

    def test_advance(self):
        device = self.made()
        self.until_near(lambda: device.advance()[:3], (0.01, 0.02, 0.03), 2e-3)
        command = device.advance()
        self.assertEqual((command.shape, command.dtype), ((10,), np.float32))
        np.testing.assert_allclose(command[3:7], (0, 0, 0, 1), atol=1e-6)
        np.testing.assert_array_equal(command[7:], 0)

    def test_retargeters(self):
        class Half:
            def retarget(self, raw):
                return raw[:3] / 2

        self.retargeters = [Half(), Half()]
        self.until_near(self.made().advance, (0.005, 0.01, 0.015) * 2, 1e-3)

    def test_forces(self):
        device = self.made()
        device.push_force(stand_ins.Tensor([(0.5, 0, 0), (0, 0.25, 0)]))
        self.settled((0.5, 0.25, 0))
        device.push_force({"left": stand_ins.Tensor((0, 0, 1)), "right": [0, 0, 0.5]}, position="right")
        self.settled((0, 0, 0.5))
        device.push_force({"left": [0, 0, 9], "right": [0, 0, 9]})
        self.settled((0, 0, 2))
        device.reset()
        self.settled((0, 0, 0))
        with self.assertRaisesRegex(knurl.BadParameters, "must be finite"):
            device.push_force([(float("nan"), 0, 0)])

    def test_callbacks(self):
        """The simulated hand has no button; so the report says it was pressed."""
        device, calls = self.made(), []
        device.add_callback("b", lambda: calls.append("b"))
        with self.assertRaisesRegex(knurl.BadParameters, "button 'd' is not there; there are a, b, c"):
            device.add_callback("d", print)
        newest = device._hand.newest

        def pressed(timeout):
            frame = newest(timeout)
            frame._frame.pressed = 2
            return frame

        device._hand.newest = pressed
        self.assertEqual(device.advance()[8], 1.0)
        self.assertEqual(calls, ["b"])

    def test_a_held_device_leaves_no_connection(self):
        self.claimed()
        files = len(os.listdir("/proc/self/fd"))
        with self.assertRaises(knurl.DeviceHeld):
            self.made()
        self.assertEqual(len(os.listdir("/proc/self/fd")), files)


if __name__ == "__main__":
    unittest.main()
