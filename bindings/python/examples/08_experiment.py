"""An experiment: which of two floors is harder? A staircase finds the difference in stiffness that is just noticed.

Two down, one up (Levitt 1971): the difference that 71 % notice. The observer is simulated here: he judges the stiffness
that he felt, force by depth as the servo reported them, with an error of 8 % (Weber's share). With people, ask them.
The log has a line per trial, with the servo's own time stamps (ns of its CLOCK_MONOTONIC).
"""
import random

import numpy as np

import knurl
from session import connected, options

STANDARD = 500.0  # N/m
COLUMNS = "trial start_ns end_ns standard_N_per_m difference_N_per_m first_is_harder answer felt_first felt_second".split()


def more(parser):
    parser.add_argument("--trials", type=int, default=40)
    parser.add_argument("--touch", type=float, default=0.35, help="how long each floor is felt (s)")
    parser.add_argument("--log", default="experiment.tsv")
    parser.add_argument("--seed", type=int, default=1)


def feel(hand, floor, stiffness, seconds):
    """Shows a floor to the hand; the stiffness that it felt (N/m), and when it began and ended (ns)."""
    floor.stiffness = stiffness
    hand.commit()
    hand.wait_applied()
    hand.drain()  # what came before
    felt = []
    for report in hand.reports():  # every one: 1000 a second
        felt.append((report.read_ns, -report.position[2], report.sent_force[2]))
        if felt[-1][0] - felt[0][0] > seconds * 1e9:
            break
    late = np.array(felt[len(felt) // 2 :])  # the fade to this floor is over
    touched = late[late[:, 1] > 1e-4]
    return float(np.mean(touched[:, 2] / touched[:, 1])) if len(touched) else 0.0, felt[0][0], felt[-1][0]


class Staircase:
    """Two right answers make it harder, a wrong one easier; the threshold is the mean of the last reversals."""

    def __init__(self, start, step):
        self.difference, self.step = start, step
        self._right, self._direction, self.reversals = 0, 0, []

    def answer(self, right):
        self._right = self._right + 1 if right else 0
        direction = -1 if self._right == 2 else 1 if not right else 0
        if not direction:
            return
        self._right = 0
        if self._direction and direction != self._direction:
            self.reversals.append(self.difference)
            self.step = max(1.1, self.step**0.7)
        self._direction = direction
        self.difference *= self.step**direction

    def threshold(self):
        last = self.reversals[-6:]
        return float(np.exp(np.mean(np.log(last)))) if last else self.difference


def observer(first, second, random_numbers):
    """1: the first felt harder, 2: the second did. He errs by 8 %."""
    return 1 if first * random_numbers.gauss(1, 0.08) > second * random_numbers.gauss(1, 0.08) else 2


def trial(hand, floor, stairs, said, random_numbers):
    """The columns of one trial."""
    harder, first_is_harder = STANDARD + stairs.difference, random_numbers.random() < 0.5
    shown = (harder, STANDARD) if first_is_harder else (STANDARD, harder)
    (first, start, _), (second, _, end) = (feel(hand, floor, stiffness, said.touch) for stiffness in shown)
    answer = observer(first, second, random_numbers)
    difference = stairs.difference
    stairs.answer(answer == (1 if first_is_harder else 2))
    return [start, end, STANDARD, round(difference, 1), int(first_is_harder), answer, round(first, 1), round(second, 1)]


said = options(__doc__, more)
random_numbers, stairs = random.Random(said.seed), Staircase(start=200.0, step=1.5)
with connected(said, push=1.5) as client, client.claim(update_interval=said.touch) as hand, open(said.log, "w") as log:
    floor = hand.add(knurl.Plane(stiffness=STANDARD, damping=1, recovery=0.05))
    hand.arm()
    for report in hand.reports(rate=60):  # until the hand rests on the floor with the whole force
        if report.state == knurl.DeviceState.ACTIVE and report.touching:
            break
    log.write("\t".join(COLUMNS) + "\n")
    for number in range(said.trials):
        row = trial(hand, floor, stairs, said, random_numbers)
        log.write("\t".join(map(str, [number, *row])) + "\n")
        if report.time > said.seconds:
            break
share = stairs.threshold() / STANDARD
print(f"just noticeable: {stairs.threshold():.0f} N/m of {STANDARD:.0f} ({share:.0%}), {len(stairs.reversals)} reversals; written to {said.log}")
