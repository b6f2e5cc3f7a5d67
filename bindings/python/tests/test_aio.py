"""asyncio: several hands and other tasks in one loop."""

import asyncio
import unittest

from support import ServoCase

import knurl


def loop_waits(hand):
    """The running loop watches the hand's descriptor."""
    return any(key.fd == hand.fileno() for key in asyncio.get_running_loop()._selector.get_map().values())


class Loops(ServoCase):
    PROFILE = {"left": "premium15", "right": "premium15"}

    def test_every_report_in_order(self):
        hand = self.claimed_of("left")

        async def read():
            cycles = []
            async for report in hand.areports():
                cycles.append(report.cycle - report.missed)
                if len(cycles) == 200:
                    return cycles

        cycles = asyncio.run(asyncio.wait_for(read(), 60))
        self.assertEqual(cycles, list(range(cycles[0], cycles[0] + 200)))

    def test_two_hands_and_another_task(self):
        left, right = self.claimed_of("left"), self.claimed_of("right")
        floor = left.add(knurl.Plane(stiffness=100, offset=-0.1))
        ticks = []

        async def follow(hand, rate):
            number = 0
            async for report in hand.areports(rate=rate):
                floor.offset = -0.1 - number * 1e-4
                number += 1
                if number == 30:
                    return type(report)

        async def ticking():
            while True:
                ticks.append(1)
                await asyncio.sleep(0.001)

        async def both():
            task = asyncio.ensure_future(ticking())
            try:
                return await asyncio.gather(follow(left, 100), follow(right, 200))
            finally:
                task.cancel()

        self.assertEqual(asyncio.run(asyncio.wait_for(both(), 60)), [knurl.Frame, knurl.Frame])
        self.assertGreater(len(ticks), 20)
        self.assertTrue(left.wait_applied(timeout=10))

    def test_cancelling_while_it_waits(self):
        hand = self.claimed_of("left")

        async def read_for_ever():
            async for _ in hand.areports():
                pass

        async def cancel():
            task = asyncio.ensure_future(read_for_ever())
            await asyncio.sleep(0)
            while not loop_waits(hand):
                await asyncio.sleep(0)
            task.cancel()
            try:
                await task
            except asyncio.CancelledError:
                return "cancelled", asyncio.get_running_loop().remove_reader(hand.fileno())

        self.assertEqual(asyncio.run(cancel()), ("cancelled", False))  # no reader was left
        hand.commit()

    def claimed_of(self, device):
        hand = self.connected().claim(device)
        self.addCleanup(hand.close)
        return hand


if __name__ == "__main__":
    unittest.main()
