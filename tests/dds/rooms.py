#!/usr/bin/python3
"""A lab of servos in network namespaces, one each: how long until every view of it is right again.

    rooms.py KNURL_DDS KNURLD [--rooms N] [--without-servos] [--seconds S] [--json FILE]

Makes N namespaces (and takes them away again), joined by a bridge in another one. In each runs a knurl-dds, with a knurld unless
--without-servos. Each knurl-dds is asked, all the time, which servos it sees. Prints the time (s) from each event until all views
are right: from the start, after kill -9 of one, after its return, after its link was down for a shorter and for a longer time than
the lease of a participant, with 10 % of all packets lost (by the sender's engine), with two servos of one name, with a room whose link
has no multicast; and what the discovery costs in packets and bytes a second of a room. Ends with 1 where a view never becomes right. Needs root and `ip`: without them it says so
and ends with 77.
"""

import argparse
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SKIPPED = 77
PATIENCE = 60.0
LEASE = 5.0  # DomainOptions::lease


def ip(*words, check=True):
    return subprocess.run(["ip", *words], check=check, capture_output=True, text=True)


class Room:
    """One host of the lab."""

    def __init__(self, lab, number):
        self.lab, self.number = lab, number
        self.name = f"room{number}"
        self.space = f"{lab.prefix}{number}"
        self.link = f"{lab.prefix}h{number}"  # the end in the bridge's namespace
        self.address = f"10.77.{number // 200}.{number % 200 + 1}"
        self.folder = lab.folder / self.name
        self.folder.mkdir()
        self.dds = self.servo = None
        ip("netns", "add", self.space)
        lab.spaces.append(self.space)
        ip("-n", lab.bridge, "link", "add", self.link, "type", "veth", "peer", "name", "eth0", "netns", self.space)
        ip("-n", lab.bridge, "link", "set", self.link, "master", "br0", "up")
        self.mac = f"02:77:00:00:{number // 256:02x}:{number % 256:02x}"
        ip("-n", self.space, "link", "set", "eth0", "address", self.mac)
        ip("-n", self.space, "addr", "add", f"{self.address}/16", "dev", "eth0")
        ip("-n", self.space, "link", "set", "eth0", "up")
        ip("-n", self.space, "link", "set", "lo", "up")

    def run(self, *words):
        environment = dict(os.environ, KNURL_RUNTIME_DIR=str(self.folder), KNURL_STATE_DIR=str(self.folder))
        return subprocess.Popen(["ip", "netns", "exec", self.space, *words], env=environment, stdout=subprocess.DEVNULL,
                                stderr=open(self.folder / "log", "ab"), start_new_session=True)

    def start(self, name=None, loss=False, peers=()):
        if self.lab.servos and self.servo is None:
            self.servo = self.run(self.lab.knurld, "--name", "servo", "--device", "right=sim:cartesian3", "--rate", "500")
        self.dds = self.run(self.lab.program, "--servo", "servo", "--name", name or self.name, "--interface", "eth0", "--domain", "5",
                            "--bridge", f"{self.address}:4096", *(("--lose", "100") if loss else ()),
                            *(word for peer in peers for word in ("--peer", peer.address)))

    def says(self, words):
        """Waits until its knurl-dds has said this."""
        log, begin = self.folder / "log", time.monotonic()
        while words not in log.read_text():
            if time.monotonic() - begin > PATIENCE:
                raise SystemExit(f"rooms: {self.name} does not say '{words}': {log.read_text()[-2000:]}")
            time.sleep(0.01)  # between two looks

    def kill(self):
        """kill -9 of its knurl-dds; `ip netns exec` has become that program."""
        self.dds.kill()
        self.dds.wait()
        self.dds = None

    def stop(self):
        for process in (self.dds, self.servo):
            if process:
                process.send_signal(signal.SIGTERM)
        for process in (self.dds, self.servo):
            if process:
                process.wait()

    def view(self):
        """{name: state, as it is seen in this room}; None: it cannot be asked."""
        for path in self.folder.glob("*.registry"):
            try:
                with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as connection:
                    connection.settimeout(2)
                    connection.connect(str(path))
                    connection.recv(65536)
                    connection.send(b"list")
                    seen = []
                    while (message := connection.recv(65536)) not in (b".", b""):
                        servo = json.loads(message)
                        seen.append((servo["name"], servo["state"]))
                    return sorted(seen)
            except OSError:
                continue
        return None

    def carried(self):
        """Packets and bytes that its link has carried, both ways."""
        lines = ip("netns", "exec", self.space, "cat", "/proc/net/dev").stdout.splitlines()
        numbers = next(line for line in lines if "eth0:" in line).split(":")[1].split()
        return [int(numbers[1]), int(numbers[0]), int(numbers[9]), int(numbers[8])]

    def set_link(self, up):
        ip("-n", self.lab.bridge, "link", "set", self.link, "up" if up else "down")


class Lab:
    def __init__(self, arguments):
        self.program, self.knurld = arguments.knurl_dds, arguments.knurld
        self.servos = not arguments.without_servos
        self.prefix = f"kn{os.getpid() % 10000}x"
        self.folder = Path(tempfile.mkdtemp(prefix="knurl-rooms-"))
        self.spaces, self.rooms = [], []
        self.bridge = f"{self.prefix}br"

    def build(self, count):
        ip("netns", "add", self.bridge)
        self.spaces.append(self.bridge)
        ip("-n", self.bridge, "link", "add", "br0", "type", "bridge")
        ip("-n", self.bridge, "link", "set", "br0", "up")
        for number in range(count):
            self.rooms.append(Room(self, number))
        # All namespaces share one table of neighbours, in which 1024 have room; permanent ones do not count. Without this 33
        # rooms cannot all speak to each other, which says nothing of DDS.
        everybody = "".join(f"neigh replace {room.address} lladdr {room.mac} dev eth0 nud permanent\n" for room in self.rooms)
        for room in self.rooms:
            subprocess.run(["ip", "-n", room.space, "-batch", "-"], input=everybody, check=True, capture_output=True, text=True)

    def close(self):
        for room in self.rooms:
            room.stop()
        for space in self.spaces:
            ip("netns", "delete", space, check=False)
        shutil.rmtree(self.folder, ignore_errors=True)

    def until(self, what, wanted):
        """Time until each room's view is wanted(room)."""
        begin = time.monotonic()
        waiting, last = list(self.rooms), {}
        while waiting:
            for room in list(waiting):
                last[room.name] = room.view() if room.dds else wanted(room)
                if last[room.name] == wanted(room):
                    waiting.remove(room)
            if time.monotonic() - begin > PATIENCE:
                room = waiting[0]
                print((room.folder / "log").read_text()[-2000:], file=sys.stderr)
                raise SystemExit(f"rooms: {what}: {len(waiting)} views are wrong after {PATIENCE:g} s; {room.name} sees {last[room.name]}, not {wanted(room)}")
            time.sleep(0.01)  # between two looks
        took = time.monotonic() - begin
        print(f"{what:58} {took:6.2f} s", flush=True)
        return took


def traffic(lab, seconds):
    before = [room.carried() for room in lab.rooms]
    time.sleep(seconds)
    after = [room.carried() for room in lab.rooms]
    mean = [sum(b[i] - a[i] for a, b in zip(before, after)) / len(before) / seconds for i in range(4)]
    return {"packets_in": mean[0], "bytes_in": mean[1], "packets_out": mean[2], "bytes_out": mean[3]}


def try_all(lab, arguments):
    rooms, state = lab.rooms, "running" if lab.servos else "gone"
    everything = [(room.name, state) for room in rooms]

    def full(_):
        return sorted(everything)

    def without(gone):
        return lambda room: sorted(entry for entry in everything if entry[0] != gone.name)

    took = {}
    for room in rooms:
        room.start()
    took["start"] = lab.until(f"{len(rooms)} rooms start: all see all", full)
    first = rooms[0]
    first.kill()
    took["kill"] = lab.until("kill -9 of one: nobody sees it", without(first))
    first.start()
    took["restart"] = lab.until("it is started again: all see all", full)
    for name, down in (("short", 2.5), ("long", LEASE + 3)):
        first.set_link(False)
        took[f"down_{name}"] = lab.until(f"its link is down: nobody sees it, it sees itself ({name})",
                                         lambda room: [(first.name, state)] if room is first else without(first)(room))
        time.sleep(down)  # the link is down: that is what is tried
        first.set_link(True)
        took[f"up_{name}"] = lab.until(f"its link is up after {down:g} s: all see all", full)
    first.kill()
    lab.until("(it is gone)", without(first))
    for room in rooms[1:]:
        room.kill()
    for room in rooms:
        room.start(loss=True)
    took["start_loss"] = lab.until("10 % loss at all: they start, all see all", full)
    first.kill()
    took["kill_loss"] = lab.until("10 % loss: kill -9, nobody sees it", without(first))
    first.start(loss=True)
    took["restart_loss"] = lab.until("10 % loss: it is started again, all see all", full)
    for room in rooms:
        room.kill()
    for room in rooms:
        room.start()
    lab.until("(without loss again)", full)
    if len(rooms) > 1:
        first.kill()
        lab.until("(it is gone)", without(first))
        first.start(name=rooms[1].name)
        both = sorted([entry for entry in everything if entry[0] != first.name] + [(rooms[1].name, state)])
        took["clash"] = lab.until("it comes back with another's name: all see both", lambda room: both)
        first.kill()
        took["clash_over"] = lab.until("and is gone again", without(first))
        first.start()
        lab.until("(it is back)", full)
    if len(rooms) > 1:
        last = rooms[-1]
        last.kill()
        lab.until("(another one is gone)", without(last))
        ip("-n", last.space, "link", "set", "eth0", "multicast", "off")
        last.start()
        last.says("interface eth0 has no multicast, so nobody is found; name the other hosts as peers")
        last.kill()
        last.start(peers=rooms[:-1])
        took["no_multicast"] = lab.until("without multicast it names the others: all see all", full)
    print(f"discovery and state, of each of {len(rooms)} rooms:", flush=True)
    cost = traffic(lab, arguments.seconds)
    print(f"    in  {cost['packets_in']:8.1f} packets/s {cost['bytes_in']:10.0f} bytes/s\n"
          f"    out {cost['packets_out']:8.1f} packets/s {cost['bytes_out']:10.0f} bytes/s", flush=True)
    return {"rooms": len(rooms), "took_s": took, "traffic": cost}


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1].strip())
    parser.add_argument("knurl_dds")
    parser.add_argument("knurld")
    parser.add_argument("--rooms", type=int, default=3)
    parser.add_argument("--without-servos", action="store_true")
    parser.add_argument("--seconds", type=float, default=3)
    parser.add_argument("--json", default="")
    arguments = parser.parse_args()
    if os.geteuid() != 0 or not shutil.which("ip"):
        print("rooms: skipped: network namespaces need root and `ip`")
        sys.exit(SKIPPED)
    lab = Lab(arguments)
    try:
        try:
            lab.build(arguments.rooms)
        except subprocess.CalledProcessError as error:
            print(f"rooms: skipped: {' '.join(error.cmd)}: {error.stderr.strip()}")
            sys.exit(SKIPPED)
        result = try_all(lab, arguments)
        if arguments.json:
            Path(arguments.json).write_text(json.dumps(result, indent=2) + "\n")
    finally:
        lab.close()


if __name__ == "__main__":
    main()
