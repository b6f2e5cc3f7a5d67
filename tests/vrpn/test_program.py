#!/usr/bin/python3
"""knurl-vrpn beside a knurld with a simulated hand that can be moved, and clients of client.py.

    tests/vrpn/test_program.py --knurld PROGRAM --knurl-vrpn PROGRAM --knurl PROGRAM [unittest's arguments]
"""

import argparse
import math
import os
import pathlib
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from client import COOKIE, PATIENCE, TYPES, Client, field, message, name_payload, plane, text_of

PROGRAMS = argparse.Namespace()
K_MAX = None  # of the simulated device (N/m)


class Program:
    """A program whose lines are kept."""

    def __init__(self, words, environment):
        self.lines, self.news = [], threading.Condition()
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment)
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        with self.process.stdout as output:
            for line in output:
                with self.news:
                    self.lines.append(line)
                    self.news.notify_all()
        with self.news:
            self.lines.append("")  # its end
            self.news.notify_all()

    def says(self, pattern, since=0):
        """Waits for a line with that pattern: its match."""
        def found():
            for line in self.lines[since:]:
                match = re.search(pattern, line)
                if match:
                    return match
            return self.lines[-1:] == [""]

        with self.news:
            match = self.news.wait_for(found, PATIENCE)
        assert match and match is not True, f"no line has {pattern!r}: {''.join(self.lines)}"
        return match

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(PATIENCE)
        self.reader.join()
        return code


class Served(unittest.TestCase):
    """A servo with one hand, and a server of its own for each test."""

    options = ["--force-peer", "localhost"]

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="knurl-vrpn-")
        hand = os.path.join(cls.folder.name, "hand")
        os.mkfifo(hand, 0o600)
        cls.environment = os.environ | {"KNURL_RUNTIME_DIR": cls.folder.name, "KNURL_STATE_DIR": cls.folder.name}
        cls.servo = Program([PROGRAMS.knurld, "--device", f"right=sim:premium15,live={hand},seed=3"], cls.environment)
        global K_MAX
        K_MAX = float(cls.servo.says(r"k_max (\d+) N/m")[1])
        cls.servo.says("ready")
        cls.hand = os.open(hand, os.O_RDWR)

    @classmethod
    def tearDownClass(cls):
        os.close(cls.hand)
        cls.servo.end()
        cls.folder.cleanup()

    def setUp(self):
        self.clients = []
        self.server = Program([PROGRAMS.knurl_vrpn, "--listen", "127.0.0.1:0", *self.options], self.environment)
        self.port = int(self.server.says(r"Phantom0@127.0.0.1:(\d+)")[1])

    def tearDown(self):
        for client in self.clients:
            client.close()
        self.assertEqual(self.server.end(), 0, "".join(self.server.lines))

    def client(self, **how):
        made = Client(self.port, **how)
        self.clients.append(made)
        return made

    def connected(self, **how):
        made = self.client(**how)
        if made.udp_in:
            self.assertTrue(made.has_port())
        return made

    def event(self, kind, code, value):
        os.write(self.hand, struct.pack("qqHHi", 0, 0, kind, code, value) + struct.pack("qqHHi", 0, 0, 0, 0, 0))

    def move(self, client, height):
        """Moves the person's hand by a wheel of 2 mm a count until the device is at that height (m)."""
        for _ in range(60):
            then = time.time() + 0.2  # until when the hand comes to rest
            pose = client.wait("pose", lambda _: client.stamp > then)
            far = height - struct.unpack(">2i7d", pose)[3]
            if abs(far) < 1.2e-3:
                return
            self.event(2, 8, max(-1, min(1, round(far / 2e-3))))
        self.fail(f"the hand is {far} m from where it shall be")


class Reports(Served):
    options = []

    def test_a_client_is_connected_back_and_gets_datagrams(self):
        client = self.connected()
        self.assertIn("Phantom0", client.their_senders.values())
        pose = client.wait("pose")
        self.assertEqual(len(pose), 64)
        for kind, size in (("velocity", 72), ("force", 24), ("scp", 56)):
            self.assertEqual(len(client.wait(kind)), size)
        self.assertEqual(struct.unpack_from(">i", client.got[TYPES["states"]][0])[0], 8)

    def test_a_client_that_connects_itself_gets_all_by_tcp_and_no_port(self):
        client = self.connected(tcp=True)
        self.assertEqual(len(client.wait("pose")), 64)
        self.assertIsNone(client.server_udp)

    def test_a_ping_is_answered(self):
        client = self.connected()
        client.send("ping")
        self.assertEqual(client.wait("pong"), b"")
        self.assertIsNotNone(client.wait("states"))

    def test_the_workspace_is_a_box_around_its_middle(self):
        client = self.connected()
        client.wait("pose")
        client.send("ask_workspace")
        low_high = struct.unpack(">6d", client.wait("workspace"))
        for low, high in zip(low_high[:3], low_high[3:]):
            self.assertGreater(high - low, 0.05)

    def test_a_button_is_told(self):
        client = self.connected()
        client.wait("pose")
        self.event(1, 0x110, 1)
        self.assertEqual(struct.unpack(">2i", client.wait("change")), (0, 1))
        self.event(1, 0x110, 0)
        self.assertEqual(struct.unpack(">2i", client.wait("change")), (0, 0))

    def test_the_hand_moves_along_the_clients_axes(self):
        client = self.connected()
        before = struct.unpack(">2i7d", client.wait("pose"))[3]
        self.move(client, before + 0.01)  # up
        self.move(client, before)

    def test_no_force_without_the_operators_word(self):
        client = self.connected()
        client.wait("pose")
        client.send("plane", plane(0, 1, 0, -1, 1.0), udp=True)
        severity, line = text_of(client.wait("text"))
        self.assertEqual(severity, 2)
        self.assertIn("--force-peer 127.0.0.1", line)
        self.assertEqual(struct.unpack(">i", client.wait("force_error"))[0], 3)
        for _ in range(100):
            self.assertEqual(client.force(), (0, 0, 0))

    def test_the_servo_has_nothing_to_do_while_nobody_is_connected(self):
        """No client, no observer: nothing that a cycle would wake or look at."""
        def listed():
            return "knurl-vrpn observes" in subprocess.run([PROGRAMS.knurl, "ls"], capture_output=True, text=True, env=self.environment, check=False).stdout

        self.assertFalse(listed())
        client = self.connected()
        client.wait("pose")
        self.assertTrue(listed())
        client.close()
        end = time.monotonic() + PATIENCE
        while listed():
            self.assertLess(time.monotonic(), end)

    def test_two_clients_and_many_get_reports(self):
        clients = [self.connected(tcp=bool(i % 2)) for i in range(8)]
        for each in clients:
            self.assertIsNotNone(each.wait("pose"))


class Forces(Served):
    def felt(self, client, good):
        found = client.wait("force", lambda payload: good(struct.unpack(">3d", payload)))
        if found is None:
            said = [text_of(each) for each in client.got.get(TYPES["text"], [])]
            self.fail(f"the last force is {struct.unpack('>3d', client.got[TYPES['force']][-1])} N at "
                      f"{struct.unpack('>2i7d', client.got[TYPES['pose']][-1])[2:5]} m; the client was told {said}; "
                      f"the server says {self.server.lines}, the servo {self.servo.lines[-3:]}")
        return found

    def gone(self, client):
        return self.felt(client, lambda force: force == (0, 0, 0))

    def test_a_plane_pushes_by_its_law(self):
        """Held by a person's spring, the force is k times the depth below y = h."""
        client = self.connected()
        self.move(client, 0)
        share = 0.1
        client.send("plane", plane(0, 1, 0, -0.005, share), udp=True)
        self.assertTrue(self.felt(client, lambda force: force[1] > 0.3), "it is armed and ramps up")
        errors = []

        def compare(name, payload):
            """Pose and force of one report: k depth, once the ramp is over and the hand rests."""
            if name == TYPES["pose"]:
                compare.y = struct.unpack(">2i7d", payload)[3]
            if name == TYPES["force"]:
                errors.append(abs(struct.unpack(">3d", payload)[1] - share * K_MAX * (0.005 - compare.y)))
            return len(errors) > 50 and max(errors[-50:]) < 0.02

        self.assertTrue(client.until(compare), f"the last errors: {errors[-5:]} N")
        client.send("plane", plane(0, 0, 0, 0, share))
        self.assertTrue(self.gone(client))

    def test_a_plane_that_is_not_touched_gives_nothing_and_its_contact_point_lies_on_it(self):
        client = self.connected()
        self.move(client, 0)
        client.send("plane", plane(0, 1, 0, -0.005, 0.2), udp=True)
        self.assertTrue(self.felt(client, lambda force: force[1] > 0.3))
        self.assertTrue(client.wait("scp", lambda payload: abs(struct.unpack(">7d", payload)[1] - 0.005) < 1e-4))
        client.send("plane", plane(0, 1, 0, 0.05, 0.2), udp=True)
        self.assertTrue(self.gone(client))

    def test_a_field_pushes_and_stops(self):
        client = self.connected(tcp=True)
        self.move(client, 0)
        client.send("field", field(force=(0.3, 0, 0), radius=0.2))
        self.assertTrue(self.felt(client, lambda force: abs(force[0] - 0.3) < 0.03))
        client.send("field", field())
        self.assertTrue(self.gone(client))

    def test_a_field_as_clients_make_constraints_of_it(self):
        client = self.connected()
        self.move(client, 0)
        jacobian = [0] * 9
        jacobian[4] = -100
        client.send("field", field(origin=(0, 0.004, 0), jacobian=jacobian, radius=100.0), udp=True)
        self.assertTrue(self.felt(client, lambda force: force[1] > 0.1))
        client.send("field", field())
        self.assertTrue(self.gone(client))

    def test_a_buzz_is_felt_for_its_time(self):
        client = self.connected()
        self.move(client, 0)
        client.send("effect", struct.pack(">2I6f", 0, 6, 0.5, 5, 0.6, 1, 0, 0))  # 0.5 N, 5 Hz, 0.6 s, to the right
        for sign in (1, -1, 1, -1):
            self.assertTrue(self.felt(client, lambda force, sign=sign: sign * force[0] > 0.2))
        self.assertTrue(self.gone(client))

    def test_a_constraint_holds(self):
        client = self.connected()
        self.move(client, 0)
        for kind, payload in (("mode", struct.pack(">i", 1)), ("point", struct.pack(">3f", 0, 0.005, 0)),
                              ("spring", struct.pack(">f", 100)), ("enable", struct.pack(">i", 1))):
            client.send(kind, payload)
        self.assertTrue(self.felt(client, lambda force: force[1] > 0.1))
        client.send("enable", struct.pack(">i", 0))
        self.assertTrue(self.gone(client))

    def test_a_trimesh_is_felt_and_cleared(self):
        """A plate of 20 cm whose top lies 5 mm above the hand that comes down on it."""
        client = self.connected()
        self.move(client, 0.012)
        corners = [(x, y, z) for y in (-0.03, 0.005) for x in (-0.1, 0.1) for z in (-0.1, 0.1)]
        faces = [(4, 5, 6), (5, 7, 6), (0, 2, 1), (1, 2, 3), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2),
                 (2, 4, 6), (1, 3, 5), (3, 7, 5)]
        for i, corner in enumerate(corners):
            client.send("vertex", struct.pack(">2i3f", 0, i, *corner))
        for i, face in enumerate(faces):
            client.send("triangle", struct.pack(">8i", 0, i, *face, -1, -1, -1))
        client.send("update", struct.pack(">i4f", 0, 0.2, 0, 0, 0))
        client.send("ping")  # the mesh is on its way
        client.wait("pong")
        for _ in range(6):
            self.event(2, 8, -1)  # by 12 mm: it would be 5 mm below the top
            then = time.time() + 0.1
            client.wait("pose", lambda _: client.stamp > then)
        self.assertTrue(self.felt(client, lambda force: force[1] > 0.3))
        client.send("clear", struct.pack(">i", 0))
        self.assertTrue(self.gone(client))


    def test_a_client_that_is_killed_leaves_no_force(self):
        """It is another process: its death closes its sockets, and nothing else."""
        watcher = self.connected()
        self.move(watcher, 0)
        code = ("import sys; sys.path.insert(0, sys.argv[1]); from client import *; c = Client(int(sys.argv[2])); c.has_port();"
                "c.send('plane', plane(0, 1, 0, -0.01, 0.1), udp=True); print('there', flush=True); c.wait('text')")
        victim = subprocess.Popen([sys.executable, "-c", code, str(pathlib.Path(__file__).parent), str(self.port)],
                                  stdout=subprocess.PIPE, text=True)
        try:
            self.assertEqual(victim.stdout.readline(), "there\n")
            self.assertTrue(self.felt(watcher, lambda force: force[1] > 0.3))
        finally:
            victim.kill()
            victim.wait()
            victim.stdout.close()
        self.assertTrue(self.gone(watcher))
        # And the next one may.
        watcher.send("plane", plane(0, 1, 0, -0.01, 0.1), udp=True)
        self.assertTrue(self.felt(watcher, lambda force: force[1] > 0.3))

    def test_a_client_that_only_reads_keeps_its_plane(self):
        client = self.connected()
        self.move(client, 0)
        client.send("plane", plane(0, 1, 0, -0.005, 0.1), udp=True)
        self.assertTrue(self.felt(client, lambda force: force[1] > 0.3))
        for _ in range(5000):  # reports: more than the 3.5 s after which a silent claim fades, for good
            client.force()
        # On a machine that kept knurl-vrpn off its CPUs the force has faded meanwhile, and it is back now.
        self.assertTrue(self.felt(client, lambda force: force[1] > 0.3))

    def test_a_second_client_is_told(self):
        first, second = self.connected(), self.connected()
        self.move(first, 0)
        first.send("plane", plane(0, 1, 0, -0.005, 0.1), udp=True)
        self.assertTrue(self.felt(first, lambda force: force[1] > 0.2))
        second.send("plane", plane(0, -1, 0, -0.5, 1.0), udp=True)
        severity, line = text_of(second.wait("text"))
        self.assertEqual(severity, 2)
        self.assertIn("is commanded by the client 127.0.0.1:", line)
        self.assertEqual(struct.unpack(">i", second.wait("force_error"))[0], 3)
        for _ in range(50):
            self.assertGreater(first.force()[1], 0.1)


class Silence(Served):
    options = ["--force-peer", "localhost", "--silent-after", "0.5"]

    def test_a_client_that_must_speak_and_does_not_loses_its_force_until_it_speaks(self):
        client = self.connected()
        self.move(client, 0)

        def felt(good):
            return client.wait("force", lambda payload: good(struct.unpack(">3d", payload)[1]))

        client.send("plane", plane(0, 1, 0, -0.005, 0.1), udp=True)
        self.assertTrue(felt(lambda force: force > 0.3))
        self.assertTrue(felt(lambda force: force == 0), "it says nothing")
        client.send("ping")
        self.assertTrue(felt(lambda force: force > 0.3), "it is there again, and so is its plane")


class Hostile(Served):
    """What brings other servers of VRPN down, or lets strangers in."""

    def alive(self):
        other = self.connected()
        self.assertIsNotNone(other.wait("pose"))
        other.send("ping")
        self.assertIsNotNone(other.wait("pong"))
        other.close()

    def test_a_length_below_24_in_a_datagram(self):
        client = self.connected()
        for length in (0, 1, 23, 0x7FFFFFFF, 0xFFFFFFFF):
            client.udp_out.sendto(struct.pack(">6I", length, 0, 0, 0, 0, 0), ("127.0.0.1", client.server_udp))
        client.udp_out.sendto(bytes(24), ("127.0.0.1", self.port))
        self.server.says("an impossible length")
        self.alive()
        self.assertIsNotNone(client.wait("pose"), "the client is served on")

    def test_a_length_below_24_by_tcp(self):
        client = self.connected()
        client.send("ping", length=3)
        self.assertRaises((EOFError, ConnectionError), lambda: client.until(lambda *_: False))
        self.server.says("impossible length")
        self.alive()

    def test_one_byte_of_a_cookie(self):
        half = socket.create_connection(("127.0.0.1", self.port))
        half.sendall(b"v")
        self.alive()
        self.server.says("has not said which version of VRPN it speaks")
        half.close()

    def test_half_a_message(self):
        client = self.connected(tcp=True)
        client.tcp.sendall(message(5, 40)[:17])
        self.alive()
        client.tcp.sendall(message(5, client.types["ping"], b"")[17:17])
        client.close()

    def test_a_client_that_does_not_read(self):
        slow = self.connected(tcp=True)
        slow.tcp.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        slow.tcp.settimeout(0.01)
        # Each ping has an answer of 100 bytes that is never read.
        pings = message(5, slow.types["ping"]) * 500
        try:
            for _ in range(2000):
                slow.tcp.sendall(pings)
                if any("does not read" in line for line in self.server.lines):
                    break
        except (TimeoutError, socket.timeout, ConnectionError):
            pass
        self.alive()
        self.server.says("does not read what it is sent")
        self.alive()

    def test_a_strangers_datagram(self):
        """From another port of the same host, once the client's is known, and from another address of it."""
        client = self.connected()
        self.move(client, 0)
        client.send("plane", plane(0, 1, 0, 1, 0.1), udp=True)  # far below
        client.send("ping")
        client.wait("pong")
        for address in ("127.0.0.1", "127.0.0.2"):
            stranger = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            stranger.bind((address, 0))
            stranger.sendto(message(5, client.types["plane"], plane(0, 1, 0, -1, 1.0), 100), ("127.0.0.1", client.server_udp))
            stranger.close()
        self.server.says("a datagram of a stranger")
        for _ in range(200):
            self.assertEqual(client.force(), (0, 0, 0))

    def test_a_datagram_that_was_overtaken(self):
        client = self.connected()
        self.move(client, 0)
        client.send("plane", plane(0, 1, 0, 1, 0.1), udp=True, sequence=9)
        client.send("plane", plane(0, 1, 0, -1, 1.0), udp=True, sequence=8)
        for _ in range(300):
            self.assertEqual(client.force(), (0, 0, 0))

    def test_a_name_that_is_longer_than_its_message(self):
        for kind in (-1, -2):
            client = self.connected()
            client.tcp.sendall(message(6, kind, struct.pack(">i", 0x7FFFFFFF) + b"\0\0\0\0"))
            self.assertRaises((EOFError, ConnectionError), lambda: client.until(lambda *_: False))
        self.server.says("has a wrong length")
        self.alive()

    def test_an_id_of_2000(self):
        for number in (2000, -1, 0x7FFFFFFF):
            client = self.connected()
            client.tcp.sendall(message(number, -1, name_payload("x")))
            self.assertRaises((EOFError, ConnectionError), lambda: client.until(lambda *_: False))
        self.alive()

    def test_a_request_for_another_host_is_not_followed(self):
        """The connection goes to whoever sent the datagram, whatever address it holds; and to no port below 1024."""
        victim = socket.create_server(("127.0.0.3", 0))
        victim.settimeout(1)
        ask = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        ask.sendto(f"127.0.0.3 {victim.getsockname()[1]}\0".encode(), ("127.0.0.1", self.port))
        self.server.says("cannot be connected to")
        self.assertRaises((TimeoutError, socket.timeout), victim.accept)
        ask.sendto(b"127.0.0.1 80\0", ("127.0.0.1", self.port))
        self.server.says("is no request for a connection")
        victim.close()
        ask.close()
        self.alive()

    def test_datagrams_for_another_host_are_not_sent(self):
        """client.py describes 10.1.2.3, and gets its datagrams all the same: Reports has it. A port below 1024 ends it."""
        client = self.connected()
        client.tcp.sendall(message(53, -3, b"127.0.0.1\0"))
        self.assertRaises((EOFError, ConnectionError), lambda: client.until(lambda *_: False))
        self.server.says("it wants datagrams at port 53")

    def test_many_clients_do_not_make_each_other_wait(self):
        """Ten silent half-open ones, and one that is served."""
        halves = [socket.create_connection(("127.0.0.1", self.port)) for _ in range(10)]
        self.alive()
        for each in halves:
            each.close()

    def test_no_more_clients_of_a_host_than_may_be(self):
        many = [socket.create_connection(("127.0.0.1", self.port)) for _ in range(60)]
        self.server.says("is refused: there are")
        for each in many:
            each.close()
        end = time.monotonic() + PATIENCE
        while True:
            try:
                self.alive()
                break
            except (OSError, AssertionError, EOFError):
                self.assertLess(time.monotonic(), end)

    def test_a_force_that_is_no_number_is_one_line_to_the_client_and_no_force(self):
        client = self.connected()
        client.wait("pose")
        for _ in range(1000):
            client.send("plane", plane(0, 1, 0, 0, math.nan), udp=True)
        severity, line = text_of(client.wait("text"))
        self.assertEqual((severity, line), (2, "vrpn_ForceDevice Plane: plane 0: kspring is nan; it must be 0 to 1e+09"))
        for _ in range(300):
            self.assertEqual(client.force(), (0, 0, 0))
        self.assertEqual(len(client.got[TYPES["text"]]), 1, "a loop at the client makes one line")
        self.assertLess(sum("kspring" in line for line in self.server.lines), 3)

    def test_a_client_of_vrpn_06_is_one_line(self):
        client = self.client(tcp=True, cookie=COOKIE.replace(b"07.38", b"06.04"))
        self.server.says(r"client 127.0.0.1:\d+: it speaks 'vrpn: ver. 06.04', and this server 'vrpn: ver. 07.38': use a client of VRPN 07")
        self.assertEqual(len(client.tcp.recv(100)), 24, "the server's cookie")
        self.assertEqual(client.tcp.recv(100), b"", "and no more")

    def test_a_request_for_remote_logging_is_one_line(self):
        self.client(tcp=True, cookie=COOKIE.replace(b"  0", b"  2"))
        self.server.says("connect without remote logging")

    def test_a_sender_that_is_not_there_is_said(self):
        self.connected(sender="Tracker9")
        self.server.says("it asks for 'Tracker9'; this server has Phantom0")

    def test_random_bytes(self):
        import random

        seed = int(time.time())
        print("seed", seed)
        chance = random.Random(seed)
        for _ in range(30):
            client = self.connected(tcp=bool(chance.randrange(2)))
            try:
                for _ in range(20):
                    payload = chance.randbytes(chance.choice((0, 4, 20, 40, 64, 1000)))
                    bytes_ = message(chance.randrange(-2, 9), chance.randrange(-6, 70), payload)
                    if client.udp_out and chance.random() < 0.5:
                        client.udp_out.sendto(bytes_, ("127.0.0.1", client.server_udp))
                    else:
                        client.tcp.sendall(bytes_)
            except ConnectionError:
                pass
            client.close()
        self.alive()


class Starting(unittest.TestCase):
    """What it says where it cannot, or has to wait."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="knurl-vrpn-")
        self.environment = os.environ | {"KNURL_RUNTIME_DIR": self.folder.name, "KNURL_STATE_DIR": self.folder.name}

    def tearDown(self):
        self.folder.cleanup()

    def refused(self, *words):
        done = subprocess.run([PROGRAMS.knurl_vrpn, *words], capture_output=True, text=True, env=self.environment, timeout=PATIENCE, check=False)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertNotEqual(done.returncode, 0)
        return done.stderr

    def test_a_port_in_use(self):
        taken = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        self.assertIn(f"UDP port 127.0.0.1:{port} is in use", self.refused("--listen", f"127.0.0.1:{port}"))
        taken.close()

    def test_wrong_words(self):
        self.assertIn("'300.1.2.3' is no address", self.refused("--force-peer", "300.1.2.3"))
        self.assertIn("'10.0.0.0/33' is no address", self.refused("--peer", "10.0.0.0/33"))
        self.assertIn("is no name of a sender", self.refused("--sender", "a@b=right", "--listen", "127.0.0.1:0"))
        self.assertIn("named twice", self.refused("--sender", "a=x", "--sender", "a=y", "--listen", "127.0.0.1:0"))

    def test_without_a_servo_it_says_so_and_waits(self):
        server = Program([PROGRAMS.knurl_vrpn, "--listen", "127.0.0.1:0", "--force-peer", "localhost"], self.environment)
        port = int(server.says(r"Phantom0@127.0.0.1:(\d+)")[1])
        client = Client(port)
        client.has_port()
        server.says("knurld")
        client.send("plane", plane(0, 1, 0, 0, 1.0), udp=True)
        self.assertIn("the device is not there yet", text_of(client.wait("text"))[1])
        servo = Program([PROGRAMS.knurld, "--device", "sim:cartesian3"], self.environment)
        self.assertIsNotNone(client.wait("pose"), "it has come")
        client.close()
        server.end()
        servo.end()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--knurld", required=True)
    parser.add_argument("--knurl-vrpn", required=True)
    parser.add_argument("--knurl", required=True)
    PROGRAMS, rest = parser.parse_known_args()
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)
