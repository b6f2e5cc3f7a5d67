"""What lasts: a servo that restarts, forks, Ctrl-C, many connects, garbage collection, a crash of this program."""

import gc
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest

from support import PRESS, ServoCase, run_python, until, until_active

import knurl


class Restart(ServoCase):
    def test_everything_is_added_again(self):
        hand = self.claimed()
        floor = hand.add(knurl.Plane(stiffness=500))
        hand.arm()
        until_active(hand)
        self.servo.kill()
        while hand.connected:
            hand.commit()
        self.assertIsNone(hand.newest(0))
        self.assertIsNone(hand.latest())
        floor.stiffness = 700  # kept for the servo's return
        hand.commit()
        with self.assertRaisesRegex(knurl.Disconnected, "no report came for 0.1 s: the servo is gone"):
            next(hand.reports(timeout=0.1))
        self.servo.start()
        report = next(hand.reports(rate=100, timeout=20))
        self.assertNotIn(report.state, (knurl.DeviceState.RAMP_UP, knurl.DeviceState.ACTIVE))  # off until arm()
        self.assertEqual(hand.reattachments, 1)
        until(hand, lambda report: floor.applied_stiffness == 700)
        hand.arm()
        until_active(hand)

    def test_a_loop_goes_on_when_the_servo_is_back(self):
        hand = self.claimed()
        loop = hand.reports(rate=200)
        next(loop)
        self.servo.kill()
        self.servo.start()
        while hand.reattachments == 0:
            next(loop)

    def test_without_reattaching(self):
        with self.servo.connect(reattach=False) as client, client.claim() as hand:
            hand.newest(10)
            self.servo.kill()
            while client.connected:
                pass
            self.servo.start()
            with self.assertRaises(knurl.Error):
                hand.arm()


class Fork(ServoCase):
    def test_a_child_has_no_claim(self):
        hand = self.claimed()
        floor = hand.add(knurl.Plane(stiffness=500))
        read, write = os.pipe()
        child = os.fork()
        if child == 0:
            answers = []
            for call in (hand.commit, hand.newest, floor.remove, lambda: hand._client.devices()):
                try:
                    call()
                    answers.append("nothing was raised")
                except knurl.Error as error:
                    answers.append(type(error).__name__)
            hand.close()
            del floor, hand
            gc.collect()
            try:  # a connection of its own is fine
                with self.servo.connect() as client:
                    answers.append(str(len(client.devices())))
            except BaseException as error:
                answers.append(repr(error))
            os.write(write, " ".join(answers).encode())
            os._exit(0)
        os.close(write)
        os.waitpid(child, 0)
        with os.fdopen(read) as answers:
            self.assertEqual(answers.read(), "AfterFork AfterFork AfterFork AfterFork 1")
        hand.commit()  # the parent's is as it was
        self.assertTrue(hand.wait_applied(timeout=10))


def claimed_soon(client):
    """A claim. The servo frees the places of closed ones when it comes to it: on a busy machine as many as a process may
    have can wait for that. Places that never become free fail the test."""
    end = time.monotonic() + 30
    while True:
        try:
            return client.claim()
        except knurl.Refused:
            if time.monotonic() > end:
                raise
            time.sleep(0.01)  # between two tries


class Many(ServoCase):
    def test_1000_connects_leave_no_memory_and_no_descriptor(self):
        def turns(count):
            for _ in range(count):
                with self.servo.connect(wait=0.05) as client, claimed_soon(client) as hand:
                    hand.add(knurl.Plane(stiffness=100))
                    hand.commit()

        def resident():
            gc.collect()
            with open("/proc/self/statm", encoding="ascii") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")

        turns(100)
        memory, files = resident(), len(os.listdir("/proc/self/fd"))
        turns(1000)
        self.assertLessEqual(len(os.listdir("/proc/self/fd")), files)
        self.assertLess(resident() - memory, 2 << 20)

    def test_what_nobody_holds_is_closed(self):
        client = self.connected()
        client.claim()  # released at once: nobody holds it
        gc.collect()
        hand = client.claim()
        hand.add(knurl.Plane(stiffness=1))
        del hand
        gc.collect()
        client.claim().close()


INTERRUPTED = """
import sys, knurl
with knurl.connect(sys.argv[1]) as client, client.claim() as hand:
    hand.add(knurl.Plane(stiffness=500))
    hand.arm()
    try:
        for number, report in enumerate(hand.reports({rate})):
            if number == 5:
                print("ready", flush=True)
                {then}
    except KeyboardInterrupt:
        print("interrupted", flush=True)
print("released", flush=True)
"""


class CtrlC(ServoCase):
    def interrupted(self, code):
        program = subprocess.Popen([sys.executable, "-c", code, self.servo.address], text=True, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        self.addCleanup(program.stdout.close)
        self.addCleanup(program.stderr.close)
        self.assertEqual(program.stdout.readline(), "ready\n")
        program.send_signal(signal.SIGINT)
        self.assertEqual(program.wait(30), 0, program.stderr.read())
        return program.stdout.read()

    def test_in_a_loop(self):
        for rate in ("", "rate=60"):
            self.assertEqual(self.interrupted(INTERRUPTED.format(rate=rate, then="pass")), "interrupted\nreleased\n")
            self.claimed().close()  # the device is free

    def test_while_it_waits_for_ever(self):
        code = INTERRUPTED.format(rate="", then="hand.disarm(); hand._turn = lambda: hand.wait_applied(1 << 62, 1e9); hand._turn()")
        self.assertEqual(self.interrupted(code), "interrupted\nreleased\n")

    def test_while_it_connects(self):
        code = """if True:
            import threading, time, knurl

            def tell():
                while not any(thread.name == "knurl-connect" for thread in threading.enumerate()):
                    time.sleep(0.001)
                print("ready", flush=True)

            threading.Thread(target=tell, daemon=True).start()
            try:
                knurl.connect("knurl:nobody", wait=1e4)
            except KeyboardInterrupt:
                pass"""
        self.assertEqual(self.interrupted(code), "")

    def test_in_a_model(self):
        code = INTERRUPTED.format(rate="", then="""
                def slow(near):
                    import time
                    while True: time.sleep(1)
                hand.add(knurl.Plane(stiffness=1, offset=-1)).follow(slow)""")
        self.assertEqual(self.interrupted(code), "interrupted\nreleased\n")


class Crash(ServoCase):
    HAND = PRESS

    def test_an_exception_lets_the_force_fade(self):
        """A model that raises ends the `with` block: the force goes down without a step, to nothing."""
        watch = self.connected().observe()
        with self.assertRaises(ZeroDivisionError):
            with self.servo.connect() as client, client.claim() as hand:
                floor = hand.add(knurl.Plane(stiffness=500))
                hand.arm()
                until(hand, lambda report: report.state == 4 and report.sent_force[2] > 0.5, 20000)
                watch.drain()
                floor.follow(lambda near: 1 / 0)
        reports = [watch.next_report(10)]
        while reports[-1].sent_force[2] > 0 or len(reports) < 100:
            reports.append(watch.next_report(10))
            self.assertLess(len(reports), 4000)
        for before, after in zip(reports, reports[1:]):
            milliseconds = max(1, (after.read_ns - before.read_ns) * 1e-6)  # more than one where the servo was late
            self.assertLess(abs(after.sent_force[2] - before.sent_force[2]) / milliseconds, 0.15)

    def test_a_killed_program_leaves_no_servo(self):
        code = "import knurl, os\nservo = knurl.simulated()\nprint(servo.pid, servo.address, flush=True)\nos.kill(os.getpid(), 9)"
        pid, address = run_python(code).stdout.split()
        self.addCleanup(shutil.rmtree, os.path.dirname(address))  # nobody was left to do it
        end = time.monotonic() + 30
        while os.path.exists(f"/proc/{pid}") and time.monotonic() < end:
            time.sleep(0.01)
        self.assertFalse(os.path.exists(f"/proc/{pid}"))


if __name__ == "__main__":
    unittest.main()
