"""A ball on a floor, simulated here, that the hand holds by a spring: what the spring does to the hand, the ball feels too."""
import numpy as np

import knurl
from session import connected, options, turns

MASS, RADIUS = 0.1, 0.01  # kg, m
GRAVITY = np.array((0, 0, -9.81))


class Ball:
    """Twenty lines of physics: semi-implicit Euler, a floor that bounces."""

    def __init__(self):
        self.position, self.velocity = np.array((0, 0, 0.02)), np.zeros(3)

    def advance(self, force, dt, steps=20):
        """Moves on by dt (s) under gravity and a force (N)."""
        for _ in range(steps):
            self.velocity += (GRAVITY + (force - 0.5 * self.velocity) / MASS) * dt / steps
            self.position += self.velocity * dt / steps
            if self.position[2] < RADIUS and self.velocity[2] < 0:
                self.position[2], self.velocity[2] = RADIUS, -0.3 * self.velocity[2]


said = options(__doc__)
ball, before = Ball(), 0.0
with connected(said, hand=[(0, 0, 0, 0.03), (1, 0, 0, 0.03), (2, 0.03, 0, 0.06), (4, -0.03, 0, 0.04)]) as client, client.claim() as hand:
    spring = hand.add(knurl.Spring(anchor=ball.position, stiffness=60, damping=0.5, duration=1 / 60))
    hand.arm()
    for report in turns(said, hand):
        felt = spring.feedback
        on_ball = np.zeros(3) if felt is None else -felt.force * felt.share  # the other end of the spring
        ball.advance(on_ball, min(report.time - before, 0.05))
        before = report.time
        spring.anchor = ball.position
x, y, z = ball.position * 1e3
print(f"the ball is at ({x:.1f}, {y:.1f}, {z:.1f}) mm")
