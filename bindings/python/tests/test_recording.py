"""Recordings: every cycle is there, and the same again from each kind of file."""

import csv
import importlib.util
import os
import re
import shutil
import sys
import tempfile
import unittest

import numpy as np
from support import PACKAGE, PRESS, ServoCase, until

import knurl
from knurl import _mcap

sys.path.insert(0, os.path.join(PACKAGE, "..", "..", "tests", "foxglove"))
import ros2msg  # noqa: E402


class Recordings(ServoCase):
    HAND = PRESS

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def recorded(self):
        hand = self.claimed(workspace_radius=1)
        hand.add(knurl.Plane(stiffness=50))
        with hand.record() as recording:
            first = hand.newest(10).cycle
            hand.arm()
            until(hand, lambda report: report.cycle > first + 1200)
        return recording, first

    def test_every_cycle_in_the_device_s_frame(self):
        recording, first = self.recorded()
        reports = recording.reports
        self.assertEqual(recording.missed, 0)
        np.testing.assert_array_equal(np.diff(reports["cycle"].astype(int)), 1)
        self.assertLessEqual(reports["cycle"][0], first + 100)
        self.assertGreater(reports["cycle"][-1], first + 1000)
        self.assertLess(np.abs(reports["position"]).max(), 0.05)  # not scaled, as the claim's world is
        self.assertEqual(recording.device, "premium15")
        recording.stop()

    def test_files(self):
        recording, _ = self.recorded()
        for ending in ("npz", "csv", "mcap"):
            with self.subTest(ending=ending):
                path = os.path.join(self.folder, "run." + ending)
                recording.save(path)
                loaded = knurl.load(path)
                for member in recording.reports.dtype.names:
                    if member not in ("missed", "unread"):  # of the reader, not of the report
                        np.testing.assert_array_equal(loaded.reports[member], recording.reports[member], member)
        self.assertEqual(knurl.load(os.path.join(self.folder, "run.mcap")).device, "premium15")
        with self.assertRaisesRegex(knurl.BadParameters, "give a name that ends in .npz, .csv, .mcap"):
            recording.save("run.txt")
        with self.assertRaises(knurl.BadParameters):
            knurl.load("run.txt")

    def test_columns_are_those_of_the_reference(self):
        recording, _ = self.recorded()
        path = os.path.join(self.folder, "run.csv")
        recording.save(path)
        with open(path, encoding="ascii") as file:
            head, row = list(zip(csv.reader(file), range(2)))
        with open(os.path.join(PACKAGE, "..", "..", "docs", "reference", "report.md"), encoding="utf-8") as file:
            listed = re.findall(r"^\| `(\w+)` \| .*\|$", file.read().split("## States")[0], re.M)
        self.assertEqual(len(head[0]), len(row[0]))
        self.assertEqual([name for name in head[0] if name in listed], listed)

    def test_the_schema_is_that_of_knurl_record(self):
        with open(os.path.join(PACKAGE, "..", "..", "runtime", "messages", "src", "schemas.cpp"), encoding="utf-8") as file:
            self.assertIn(_mcap._DEFINITION, file.read())

    def test_what_3d_views_need_is_what_the_reports_say(self):
        recording, _ = self.recorded()
        path = os.path.join(self.folder, "run.mcap")
        recording.save(path)
        schemas, topics, found = {}, {}, {}
        with open(path, "rb") as file:
            file.read(8)
            for op, content in _mcap._records(file):
                parts = _mcap._Content(content)
                if op == 3:
                    number, name, _ = parts.number("H"), parts.text(), parts.text()
                    schemas[number] = ros2msg.parse(name, parts.text())
                elif op == 4:
                    number, schema = parts.number("H"), parts.number("H")
                    topics[number] = (parts.text(), schemas[schema])
                elif op == 5:
                    topic, schema = topics[parts.number("H")]
                    parts.number("I")
                    found.setdefault(topic, []).append((parts.number("Q"), ros2msg.decode(*schema, content[22:])))
        reports = found.pop("/premium15/report")
        by_time = {ns: report for ns, report in reports}
        self.assertEqual(set(found), {"/premium15/measured_cp", "/premium15/measured_cf", "/tf"})
        for topic, parts in (("/premium15/measured_cp", ("pose", "position", "orientation", "position", "orientation")),
                             ("/premium15/measured_cf", ("wrench", "force", "torque", "sent_force", "sent_torque")),
                             ("/tf", ("transform", "translation", "rotation", "position", "orientation"))):
            self.assertAlmostEqual(len(found[topic]), len(reports) / 10, delta=len(reports) / 50)
            for ns, message in found[topic]:
                if topic == "/tf":
                    message, = message["transforms"]
                    self.assertEqual(message["child_frame_id"], "premium15_hand")
                stamp = message["header"]["stamp"]
                self.assertEqual((stamp["sec"] * 10**9 + stamp["nanosec"], message["header"]["frame_id"]), (ns, "premium15_base"))
                for part, member in zip(parts[1:3], parts[3:]):
                    self.assertEqual(message[parts[0]][part], by_time[ns][member], topic)

    def test_a_file_that_was_cut_off(self):
        recording, _ = self.recorded()
        path = os.path.join(self.folder, "run.mcap")
        recording.save(path)
        os.truncate(path, os.path.getsize(path) // 2)
        loaded = knurl.load(path)
        np.testing.assert_array_equal(loaded.reports["cycle"], recording.reports["cycle"][: len(loaded)])
        self.assertGreater(len(loaded), 100)
        with open(path, "wb") as file:
            file.write(b"no recording")
        with self.assertRaisesRegex(knurl.BadParameters, "this is no MCAP file"):
            knurl.load(path)
        recording.save(os.path.join(self.folder, "run.csv"))
        with open(os.path.join(self.folder, "run.csv"), "w", encoding="ascii") as file:
            file.write("a,b\n1,2\n")
        with self.assertRaisesRegex(knurl.BadParameters, "line 1"):
            knurl.load(os.path.join(self.folder, "run.csv"))

    def test_the_last_seconds(self):
        hand = self.claimed()
        with hand.ring(seconds=0.3) as ring:
            first = hand.newest(10).cycle
            until(hand, lambda report: report.cycle > first + 1000)
        self.assertGreater(len(ring), 250)
        kept = ring.reports["read_ns"]
        self.assertLessEqual(int(kept[-1]) - int(kept[0]), 301_000_000)
        self.assertLess(sum(map(len, ring._chunks)), 600)

    def test_closing_the_hand_ends_its_recording(self):
        hand = self.claimed()
        recording = hand.record()
        hand.newest(10)
        hand.close()
        self.assertIsNone(recording._thread)
        recording.stop()

    def test_an_empty_one(self):
        for ending in ("npz", "csv", "mcap"):
            path = os.path.join(self.folder, "none." + ending)
            knurl.Recording().save(path)
            self.assertEqual(len(knurl.load(path)), 0)

    def test_a_plot(self):
        recording, _ = self.recorded()
        path = os.path.join(self.folder, "hand.png")
        if importlib.util.find_spec("matplotlib") is None:
            with self.assertRaisesRegex(ImportError, "matplotlib, which is not installed"):
                knurl.plot(recording)
            return
        knurl.plot(recording, path)
        self.assertGreater(os.path.getsize(path), 5000)
        knurl.plot(knurl.Offline().run(np.zeros((5, 3))))
        with self.assertRaisesRegex(knurl.BadParameters, "empty"):
            knurl.plot(knurl.Recording())


if __name__ == "__main__":
    unittest.main()
