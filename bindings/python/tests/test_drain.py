"""drain(): the same reports as one by one, in arrays that belong to the caller, in memory that is used again."""

import random
import unittest

import numpy as np
from support import ServoCase, until

import knurl

FIELDS = [name for name in knurl.report_dtype().names if name not in ("size", "missed", "unread")]


def numbers(value):
    """A field of a row, or an attribute of a Report, as plain numbers."""
    return [float(number) for number in np.atleast_1d(np.array(value.tolist() if hasattr(value, "tolist") else value))]


class Drain(ServoCase):
    """One reader drains, and others give the same reports, or tell when enough are there."""

    def observer(self):
        observer = self.connected().observe()
        self.addCleanup(observer.close)
        return observer

    def drained(self, reader, cycles, **options):
        """What drain() gives when so many more are there."""
        watch = self.observer()
        first = watch.next_report(20).cycle
        until(watch, lambda report: report.cycle >= first + cycles)
        watch.close()
        return reader.drain(**options)

    def test_values_are_those_of_single_reports(self):
        for options in ({}, {"workspace_radius": 2.0, "workspace_centre": (1, 2, 3)}):
            one, many = (self.claimed(shared=True, **options) for _ in range(2))
            table = self.drained(many, 600)
            self.assertGreaterEqual(len(table), 600)
            singly = {}
            while max(singly, default=0) < table["cycle"][-1]:  # before they are compared, which takes longer than they are kept
                report = one.next_report(20)
                singly[report.cycle] = report
            for row in table:
                for name in FIELDS:
                    self.assertEqual(numbers(row[name]), numbers(getattr(singly[row["cycle"]], name)), name)
            self.assertEqual(int(table["size"][-1]), table.itemsize)
            self.assertEqual(int(table["unread"][-1]), 0)
            one.close()
            many.close()

    def test_an_array_is_the_callers_until_nobody_refers_to_it(self):
        seed = random.randrange(1 << 32)
        order = random.Random(seed)
        with self.subTest(seed=seed):
            reader, kept, last = self.observer(), [], None
            for _ in range(12):
                table = self.drained(reader, order.choice((5, 600, 700)))
                steps = np.diff(table["cycle"].astype(np.int64)) - np.diff(table["missed"].astype(np.int64))
                self.assertTrue((steps == 1).all())
                if last is not None:
                    self.assertEqual(int(table["cycle"][0]), last + 1)
                last = int(table["cycle"][-1])
                if order.random() < 0.4:
                    kept.append((table[order.randrange(len(table)) :], table.tobytes()))
            for table, was in kept:
                self.assertTrue(was.endswith(table.tobytes()))
            self.assertLessEqual(len(reader._rooms), 4)

    def test_memory_of_what_was_let_go_is_used_again(self):
        reader = self.observer()
        table = self.drained(reader, 600)
        address, part = table.ctypes.data, table["position"][3:5]
        del table
        other = self.drained(reader, 600)
        self.assertNotEqual(other.ctypes.data, address, "a part of it is in use")
        del part
        self.assertEqual(self.drained(reader, 600).ctypes.data, address)
        several = [self.drained(reader, 550) for _ in range(6)]
        self.assertEqual(len({each.ctypes.data for each in several}), 6)
        del several, other
        self.assertEqual(len(reader._rooms), 4, "no more are kept")

    def test_into_an_array_that_is_there(self):
        reader, room = self.observer(), np.zeros(64, knurl.report_dtype())
        first = self.drained(reader, 100, out=room).copy()
        self.assertEqual(len(first), 64)
        rest = reader.drain(out=room)
        self.assertIs(rest.base, room)
        self.assertEqual(int(rest["cycle"][0]), int(first["cycle"][-1]) + 1)
        self.assertEqual(len(reader.drain(out=room[:0])), 0)
        read_only = room.copy()
        read_only.flags.writeable = False
        for wrong in (np.zeros(8), room[::2], room.reshape(8, 8), read_only, list(room)):
            with self.assertRaisesRegex(knurl.BadParameters, "^out is "):
                reader.drain(out=wrong)

    def test_after_the_end_it_says_so_and_loses_no_memory(self):
        reader = self.observer()
        self.drained(reader, 600)
        reader.close()
        for _ in range(3):
            with self.assertRaises(knurl.Error):
                reader.drain()
        self.assertEqual(len(reader._rooms), 1)


if __name__ == "__main__":
    unittest.main()
