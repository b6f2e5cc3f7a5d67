"""A client of VRPN 07 that is written from the protocol alone: it shares no code with the server that it tests.

    client = Client(port)               # or Client(port, tcp=True)
    client.send("vrpn_ForceDevice Plane", plane(...), udp=True)
    pose = client.wait("vrpn_Tracker Pos_Quat")
"""

import select
import socket
import struct
import time

COOKIE = b"vrpn: ver. 07.38  0" + bytes(5)
TYPES = {
    "ping": "vrpn_Base ping_message",
    "pong": "vrpn_Base pong_message",
    "text": "vrpn_Base text_message",
    "pose": "vrpn_Tracker Pos_Quat",
    "velocity": "vrpn_Tracker Velocity",
    "rate": "vrpn_Tracker set_update_rate",
    "ask_workspace": "vrpn_Tracker Request_Tracker_Workspace",
    "workspace": "vrpn_Tracker Workspace",
    "change": "vrpn_Button Change",
    "states": "vrpn_Button States",
    "force": "vrpn_ForceDevice Force",
    "scp": "vrpn_ForceDevice SCP",
    "force_error": "vrpn_ForceDevice Force_Error",
    "plane": "vrpn_ForceDevice Plane",
    "field": "vrpn_ForceDevice Force_Field",
    "vertex": "vrpn_ForceDevice setVertex",
    "triangle": "vrpn_ForceDevice setTriangle",
    "update": "vrpn_ForceDevice updateTrimeshChanges",
    "effect": "vrpn_ForceDevice Custom Effect",
    "clear": "vrpn_ForceDevice clearTrimesh",
    "enable": "vrpn_ForceDevice constraint_enable",
    "mode": "vrpn_ForceDevice constraint_mode",
    "point": "vrpn_ForceDevice constraint_point",
    "spring": "vrpn_ForceDevice constraint_KSpring",
}
PATIENCE = 20


def message(sender, kind, payload=b"", sequence=0, length=None):
    now = time.time()
    head = struct.pack(">IiiiiI", 24 + len(payload) if length is None else length, int(now), int(now % 1 * 1e6), sender, kind, sequence)
    return head + payload + bytes(-len(payload) % 8)


def name_payload(name):
    return struct.pack(">i", len(name) + 1) + name.encode() + b"\0"


def plane(a, b, c, d, kspring, kdamp=0.0, dynamic=0.0, static=0.0, index=0, recovery=10):
    return struct.pack(">8f2i", a, b, c, d, kspring, kdamp, dynamic, static, index, recovery)


def field(origin=(0, 0, 0), force=(0, 0, 0), jacobian=(0,) * 9, radius=0.0):
    return struct.pack(">16f", *origin, *force, *jacobian, radius)


def text_of(payload):
    """Severity and line."""
    return struct.unpack_from(">i", payload)[0], payload[8:].split(b"\0")[0].decode()


class Client:
    """Connected, and both ends have described themselves."""

    def __init__(self, port, tcp=False, sender="Phantom0", cookie=COOKIE, host="127.0.0.1"):
        self.stream = b""
        self.their_types, self.their_senders, self.got = {}, {}, {}
        self.sequence = {False: 0, True: 0}
        self.server_udp = None
        self.udp_in = self.udp_out = None
        if tcp:
            self.tcp = socket.create_connection((host, port))
        else:
            listener = socket.create_server((host, 0))
            listener.settimeout(PATIENCE)
            ask = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            ask.sendto(f"{host} {listener.getsockname()[1]}\0".encode(), (host, port))
            self.tcp, _ = listener.accept()
            listener.close()
            ask.close()
            self.udp_in = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self.udp_in.bind((host, 0))
            self.udp_out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)  # not the port that is described
        self.tcp.settimeout(PATIENCE)
        self.tcp.sendall(cookie)
        if cookie != COOKIE:
            return
        assert self._exactly(24)[:14] == b"vrpn: ver. 07."
        described = b""
        if self.udp_in:
            described += message(self.udp_in.getsockname()[1], -3, b"10.1.2.3\0")  # an address that is nobody's
        described += message(5, -1, name_payload(sender))
        self.types = {}
        for number, (short, name) in enumerate(TYPES.items(), 40):
            self.types[short] = number
            described += message(number, -2, name_payload(name))
        self.tcp.sendall(described)

    def _exactly(self, count):
        while len(self.stream) < count:
            more = self.tcp.recv(65536)
            if not more:
                raise EOFError
            self.stream += more
        taken, self.stream = self.stream[:count], self.stream[count:]
        return taken

    def send(self, kind, payload=b"", udp=False, sequence=None, length=None):
        if sequence is None:
            sequence = self.sequence[udp]
            self.sequence[udp] += 1
        bytes_ = message(5, self.types[kind], payload, sequence, length)
        if udp:
            self.udp_out.sendto(bytes_, ("127.0.0.1", self.server_udp))
        else:
            self.tcp.sendall(bytes_)

    def _whole(self):
        """The first message of the stream. None: it is not all there."""
        if len(self.stream) < 24:
            return None
        payload = struct.unpack(">I", self.stream[:4])[0] - 24
        padded = (payload + 7) // 8 * 8
        if len(self.stream) < 24 + padded:
            return None
        head = struct.unpack(">IiiiiI", self._exactly(24))
        return self._take(head, self._exactly(padded)[:payload])

    def messages(self):
        """What comes within 50 ms, by TCP first. EOFError: the server has closed."""
        one = self._whole()
        if one:
            return [one]
        sockets = [self.tcp] + ([self.udp_in] if self.udp_in else [])
        ready = select.select(sockets, [], [], 0.05)[0]
        if self.tcp in ready:
            more = self.tcp.recv(65536)
            if not more:
                raise EOFError
            self.stream += more
            return []
        return self._split(self.udp_in.recv(2000)) if ready else []

    def _split(self, datagram):
        found = []
        while datagram:
            head = struct.unpack(">IiiiiI", datagram[:24])
            found.append(self._take(head, datagram[24 : head[0]]))
            datagram = datagram[24 + (head[0] - 24 + 7) // 8 * 8 :]
        return found

    def _take(self, head, payload):
        _, seconds, microseconds, sender, kind, _ = head
        self.stamp = seconds + 1e-6 * microseconds  # of the newest message
        if kind in (-1, -2):
            count = struct.unpack_from(">i", payload)[0]
            table = self.their_senders if kind == -1 else self.their_types
            table[sender] = payload[4 : 4 + count - 1].decode()
        if kind == -3:
            self.server_udp = sender
        name = self.their_types.get(kind, kind)
        self.got.setdefault(name, []).append(payload)
        return name, payload

    def until(self, seen):
        """Reads until seen(name, payload) gives something for a message, and returns that. None: patience is over."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            for each in self.messages():
                found = seen(*each)
                if found is not None and found is not False:
                    return found
        return None

    def wait(self, kind, good=lambda payload: True):
        """The payload of the next message of that kind for which good(payload) is true."""
        return self.until(lambda name, payload: payload if name == TYPES[kind] and good(payload) else None)

    def has_port(self):
        """Reads what the server describes."""
        return self.until(lambda *_: self.server_udp is not None and TYPES["states"] in self.got)

    def force(self):
        """The newest force."""
        return struct.unpack(">3d", self.wait("force"))

    def close(self):
        for each in (self.tcp, self.udp_in, self.udp_out):
            if each:
                each.close()
