#!/usr/bin/env python3
"""A peer of Foxglove's WebSocket protocol with nothing but Python's own library: subscribes to every channel, decodes each
message by the definition that was advertised, and prints what it saw as JSON.

`client.py HOST PORT SUBPROTOCOL MESSAGES [PATH]`: reads until every topic that is said to be live has brought so many messages."""

import base64
import hashlib
import json
import os
import socket
import struct
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import ros2msg


class WebSocket:
    """RFC 6455, as much of it as a client needs."""

    def __init__(self, host, port, subprotocols, path="/", origin=None):
        self.socket = socket.create_connection((host, port), timeout=30)
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [f"GET {path} HTTP/1.1", f"Host: {host}:{port}", "Upgrade: websocket", "Connection: Upgrade",
                 f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13"]
        if subprotocols:
            lines.append("Sec-WebSocket-Protocol: " + ", ".join(subprotocols))
        if origin:
            lines.append(f"Origin: {origin}")
        self.socket.sendall("\r\n".join(lines + ["", ""]).encode())
        self.buffer = b""
        while b"\r\n\r\n" not in self.buffer:
            more = self.socket.recv(65536)
            if not more:
                break
            self.buffer += more
        head, _, self.buffer = self.buffer.partition(b"\r\n\r\n")
        self.status = int(head.split()[1])
        self.headers = dict(line.lower().split(": ", 1) for line in head.decode().split("\r\n")[1:] if ": " in line)
        if self.status != 101:
            return
        accept = base64.b64encode(hashlib.sha1((key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest()).decode()
        assert self.headers["sec-websocket-accept"] == accept.lower()
        self.subprotocol = self.headers.get("sec-websocket-protocol")

    def _take(self, n):
        while len(self.buffer) < n:
            more = self.socket.recv(1 << 20)
            if not more:
                raise EOFError
            self.buffer += more
        taken, self.buffer = self.buffer[:n], self.buffer[n:]
        return taken

    def send(self, data, op=None):
        data, op = (data.encode(), 1) if isinstance(data, str) else (data, op or 2)
        mask = os.urandom(4)
        size = len(data)
        head = bytes([0x80 | op]) + (bytes([0x80 | size]) if size < 126 else
                                     struct.pack(">BH", 0xFE, size) if size < 65536 else struct.pack(">BQ", 0xFF, size))
        self.socket.sendall(head + mask + bytes(b ^ mask[i & 3] for i, b in enumerate(data)))

    def receive(self):
        """A text or bytes; None: it was closed."""
        whole, kind = b"", None
        while True:
            try:
                first, size = self._take(2)
            except (EOFError, ConnectionError):
                return None
            assert first & 0x70 == 0 and size < 0x80, "neither compressed nor masked"
            if size == 126:
                size, = struct.unpack(">H", self._take(2))
            elif size == 127:
                size, = struct.unpack(">Q", self._take(8))
            data, op = self._take(size), first & 15
            if op == 8:
                return None
            if op == 9:
                self.send(data, 10)
            if op >= 8:
                continue
            kind, whole = op or kind, whole + data
            if first & 0x80:
                return whole.decode() if kind == 1 else whole


class Foxglove:
    """Channels, subscriptions and decoded messages."""

    def __init__(self, *where, **how):
        self.web = WebSocket(*where, **how)
        self.channels, self.subscriptions, self.statuses, self.info = {}, {}, [], None

    def next(self):
        """(topic, ns, message) of a data message; None of any other."""
        said = self.web.receive()
        if said is None:
            raise EOFError
        if isinstance(said, str):
            message = json.loads(said)
            op = message.pop("op")
            if op == "serverInfo":
                self.info = message
            elif op == "advertise":
                for channel in message["channels"]:
                    if channel["schemaEncoding"] == "ros2msg":
                        channel["parsed"] = ros2msg.parse(channel["schemaName"], channel["schema"])
                    self.channels[channel["id"]] = channel
            elif op == "unadvertise":
                for one in message["channelIds"]:
                    del self.channels[one]
            elif op == "status":
                self.statuses.append(message)
            return None
        op, subscription, ns = struct.unpack_from("<BIQ", said)
        assert op == 1
        channel = self.channels[self.subscriptions[subscription]]
        body = said[13:]
        if channel["encoding"] == "json":
            return channel["topic"], ns, json.loads(body)
        return channel["topic"], ns, ros2msg.decode(*channel["parsed"], body)

    def subscribe(self, *channels):
        wanted = []
        for channel in channels:
            self.subscriptions[len(self.subscriptions) + 1] = channel
            wanted.append({"id": len(self.subscriptions), "channelId": channel})
        self.web.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))


def main():
    host, port, subprotocol, enough = sys.argv[1], int(sys.argv[2]), sys.argv[3], int(sys.argv[4])
    peer = Foxglove(host, port, [subprotocol], path=sys.argv[5] if len(sys.argv) > 5 else "/")
    if peer.web.status != 101:
        print(json.dumps({"status": peer.web.status}))
        return
    while len(peer.channels) < 10:
        peer.next()
    peer.subscribe(*peer.channels)
    seen = {channel["topic"]: [] for channel in peer.channels.values()}
    slow = ("scene", "parameters", "diagnostics")  # sent when they change, or once a second
    while any(len(messages) < (1 if topic.endswith(slow) else enough) for topic, messages in seen.items()):
        if (found := peer.next()) is not None:
            seen[found[0]].append(found[1:])
    print(json.dumps({"subprotocol": peer.web.subprotocol, "info": peer.info, "statuses": peer.statuses, "messages": seen,
                      "schemas": {channel["topic"]: channel["schemaName"] for channel in peer.channels.values()}}))


if __name__ == "__main__":
    main()
