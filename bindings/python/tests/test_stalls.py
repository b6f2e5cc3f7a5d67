"""What the hand feels while Python stands still: the policies, and no step of the force."""

import os
import sys
import unittest

from support import PACKAGE, ServoCase

sys.path.insert(0, os.path.join(PACKAGE, "benchmarks"))

import stalls  # noqa: E402

# The claim's force comes and goes over 50 ms and more: of at most 2 N this is 0.04 N in a ms, and the hand moves, too.
LARGEST_STEP = 0.15  # N in a ms
GONE = 0.01  # N
GAP = 0.015  # s between two cycles: after 20 ms the servo lets its force begin anew


class Stalls(ServoCase):
    HAND = stalls.HAND

    def felt(self, policy, stall, seconds):
        # A machine that holds up the servo itself says nothing about Python: once more then.
        for _ in range(5):
            before, least, step, gap = stalls.felt(self.servo, policy, stall, seconds)
            if gap < GAP:
                self.assertGreater(before, 0.3)
                self.assertLess(step, LARGEST_STEP)
                return before, least
        raise unittest.SkipTest(f"the servo itself stood still for {1e3 * gap:.0f} ms, five times")

    def test_loop(self):
        """Silent after 250 ms: it fades, and comes back."""
        self.felt("loop", stalls.loop_sleeps, 0.05)
        self.assertLess(self.felt("loop", stalls.loop_sleeps, 0.8)[1], GONE)
        self.assertLess(self.felt("loop", stalls.interpreter_held, 0.8)[1], GONE)

    def test_interpreter(self):
        """Goes on while Python runs threads, and for a second where it does not; then it fades."""
        before, least = self.felt("interpreter", stalls.loop_sleeps, 1.5)
        self.assertGreater(least, 0.8 * before)
        before, least = self.felt("interpreter", stalls.interpreter_held, 0.5)
        self.assertGreater(least, 0.8 * before)
        self.assertLess(self.felt("interpreter", stalls.interpreter_held, 2.5)[1], GONE)

    def test_always(self):
        """Goes on."""
        before, least = self.felt("always", stalls.interpreter_held, 2.0)
        self.assertGreater(least, 0.8 * before)


if __name__ == "__main__":
    unittest.main()
