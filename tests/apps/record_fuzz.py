#!/usr/bin/python3
"""`knurl replay` and `knurl record --salvage` of recordings that somebody changed: each ends, with success or with one
line that says what is wrong, and in bounded memory. Checksums are left out of the changed files (they may be), so that what
lies behind them is reached.   record_fuzz.py KNURL KNURLD [SEED]"""

import glob
import os
import pathlib
import random
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

CHUNK, MESSAGE, CHANNEL, HEADER, DATA_END = 6, 5, 4, 1, 15
HEAD = 22 + 8  # bytes: the header of a message, and of an input in it
PATIENCE = 60  # s; long enough for a build with sanitizers
MOST_MEMORY = 1_500_000  # KiB


def records(data, at):
    while at + 9 <= len(data):
        length = struct.unpack_from("<Q", data, at + 1)[0]
        yield data[at], data[at + 9:at + 9 + length]
        at += 9 + length
        if data[at - 9 - length] == DATA_END:
            return


def record(op, content):
    return bytes([op]) + struct.pack("<Q", len(content)) + content


class Recorded:
    """A short recording of an application that holds the device, and the flight record of its servo, which is killed."""

    def __init__(self, folder):
        self.folder = folder
        environment = dict(os.environ, KNURL_RUNTIME_DIR=folder, KNURL_STATE_DIR=folder)
        servo = subprocess.Popen([KNURLD, "--device", "sim:premium15,tremor=0.3"], env=environment,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            deadline = time.monotonic() + PATIENCE
            while b"premium15" not in subprocess.run([KNURL, "ls"], env=environment, capture_output=True).stdout:
                assert time.monotonic() < deadline, "the servo does not start"
            path = os.path.join(folder, "whole.mcap")
            recorder = subprocess.Popen([KNURL, "record", path], env=environment, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.PIPE)
            assert b"recording device" in recorder.stderr.readline()
            subprocess.run([KNURL, "latency", "--connect", "knurl:default", "--updates", "20"], env=environment, check=True,
                           capture_output=True)
            recorder.send_signal(signal.SIGINT)
            recorder.communicate(timeout=PATIENCE)
        finally:
            servo.kill()
            servo.wait()
        while not (saved := glob.glob(os.path.join(folder, "flight-*.csv"))):
            assert time.monotonic() < deadline, "the guardian saves nothing"
        self.flight = pathlib.Path(saved[0]).read_bytes()
        self.whole = pathlib.Path(path).read_bytes()
        self.before, self.messages = b"", []
        for op, content in records(self.whole, 8):
            if op == CHANNEL and b"/knurl/inputs" in content:
                self.inputs = struct.unpack_from("<H", content)[0]
            if op == CHUNK:
                name = struct.unpack_from("<I", content, 28)[0]
                plain = subprocess.run(["zstd", "-dcq"], input=content[32 + name + 8:], capture_output=True, check=True).stdout
                self.messages += [m for kind, m in records(plain, 0) if kind == MESSAGE]
            elif op != DATA_END and not (op > CHUNK and op != 12):
                self.before += record(op, content)
        self.by_type = {}
        for i, message in enumerate(self.messages):
            if message[0] == self.inputs:
                self.by_type.setdefault(struct.unpack_from("<H", message, 22)[0], []).append(i)

    def file_of(self, messages):
        """Uncompressed, and no checksum."""
        body = b"".join(record(MESSAGE, m) for m in messages)
        chunk = struct.pack("<QQQII", 0, 0, len(body), 0, 0) + struct.pack("<Q", len(body)) + body
        return self.whole[:8] + self.before + record(CHUNK, chunk) + record(DATA_END, bytes(4))


def changed(rng, message):
    """One input, changed where a reader looks: numbers, lengths, its type."""
    data = bytearray(message)
    what = rng.randrange(5) if len(data) >= HEAD + 8 else 3
    if what == 0:
        data[rng.randrange(22, len(data))] = rng.choice((0, 1, 127, 128, 255))
    elif what == 1:
        at = HEAD + 8 * rng.randrange((len(data) - HEAD) // 8)
        data[at:at + 8] = rng.choice((struct.pack("<d", float("nan")), struct.pack("<d", 1e300), b"\xff" * 8, bytes(8),
                                      struct.pack("<Q", rng.getrandbits(64)), struct.pack("<Q", rng.randrange(4096))))
    elif what == 2:
        del data[rng.randrange(22, len(data)):]
    elif what == 3:
        data += bytes(rng.randrange(1, 200))
    else:
        data[22] = rng.randrange(12)
    return bytes(data)


class RecordFuzz(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.recorded = Recorded(cls.temporary.name)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def setUp(self):
        self.rng = random.Random(SEED)

    def ends_well(self, data, *words):
        """Exit code 0, or 1 with one line for a person."""
        path = os.path.join(self.recorded.folder, "changed")
        pathlib.Path(path).write_bytes(data)
        end = subprocess.run([KNURL, *(path if w == "FILE" else w for w in words)], capture_output=True, timeout=PATIENCE,
                             cwd=self.recorded.folder)
        said = end.stderr.decode(errors="replace")
        lines = [line for line in said.splitlines() if "cut off; its first" not in line]
        self.assertIn(end.returncode, (0, 1), said)
        if end.returncode == 1:
            self.assertEqual(len(lines), 1, said)
            self.assertTrue(lines[0].startswith("knurl "), said)
        return end.returncode, said

    def test_without_checksums_the_unchanged_replays(self):
        self.assertEqual(self.ends_well(self.recorded.file_of(self.recorded.messages), "replay", "FILE")[0], 0)
        self.assertGreater(len(self.recorded.by_type), 4, "claims, commands and batches are in it")

    def test_changed_inputs(self):
        refused = 0
        for _ in range(60):
            messages = list(self.recorded.messages)
            for _ in range(self.rng.choice((1, 1, 3))):
                i = self.rng.choice(self.recorded.by_type[self.rng.choice(sorted(self.recorded.by_type))])
                messages[i] = changed(self.rng, messages[i])
            refused += self.ends_well(self.recorded.file_of(messages), "replay", "FILE")[0]
        self.assertGreater(refused, 10, "changes that nobody sees change nothing")

    def test_changed_bytes_of_the_file(self):
        whole = self.recorded.file_of(self.recorded.messages)
        for _ in range(30):
            data = bytearray(whole)
            for _ in range(self.rng.choice((1, 4))):  # mostly near the front, which has lengths and names
                data[self.rng.randrange(self.rng.choice((600, 6000, len(data))))] = self.rng.randrange(256)
            if self.rng.random() < 0.3:
                del data[self.rng.randrange(len(data)):]
            self.ends_well(bytes(data), "replay", "FILE", "--csv", "out.csv")

    def test_changed_flight_records(self):
        refused = 0
        for _ in range(20):
            data = bytearray(self.recorded.flight)
            for _ in range(self.rng.choice((1, 4))):
                at = self.rng.randrange(self.rng.choice((800, len(data))))
                data[at:at + self.rng.choice((0, 1, 40))] = self.rng.choice((b"", b",", b"\n", b"nan", b"9" * 400, b"\0"))
            refused += self.ends_well(bytes(data), "record", "--salvage", "FILE", "out.mcap")[0]
        self.assertGreater(refused, 3)

    def test_zz_memory_was_bounded(self):
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, MOST_MEMORY)


if __name__ == "__main__":
    KNURL, KNURLD = sys.argv[1:3]
    SEED = int(sys.argv[3]) if len(sys.argv) > 3 else random.randrange(2**32)
    print("seed", SEED)
    unittest.main(argv=sys.argv[:1])
