"""A scene to learn in, with the reset() and step() of Gymnasium, without needing it: on a virtual clock, no servo runs.

The task: hold a force of 1 N against a wall of unknown stiffness, by moving the tip. 20 decisions a second, 50 cycles of
the servo in each.
"""
import numpy as np

import knurl
from session import options


class HoldForce:
    """Observation: force on the tip (N), height (m). Action: by how much to move along z (m), at most 1 mm."""

    CYCLES, LENGTH, WANTED = 50, 100, 1.0

    def __init__(self):
        self.servo = knurl.Offline(rate=1000)

    def reset(self, seed=None):
        """A new wall. Returns observation, info."""
        stiffness = np.random.default_rng(seed).uniform(200, 1500)
        self.servo.reset()
        self.servo.add(knurl.Plane(stiffness=stiffness, damping=2))
        self.height, self.turn = 0.002, 0
        return self._advance(0.0), {"stiffness": stiffness}

    def _advance(self, by):
        path = np.zeros((self.CYCLES, 3))
        path[:, 2] = self.height + by * np.arange(1, self.CYCLES + 1) / self.CYCLES
        self.height = path[-1, 2]
        felt = self.servo.run(path)
        return np.array([felt["force"][-10:, 2].mean(), self.height])

    def step(self, action):
        """Returns observation, reward, terminated, truncated, info."""
        observation = self._advance(float(np.clip(action, -1e-3, 1e-3)))
        self.turn += 1
        return observation, -abs(observation[0] - self.WANTED), False, self.turn >= self.LENGTH, {}


said = options(__doc__, lambda parser: parser.add_argument("--episodes", type=int, default=20))
environment, errors = HoldForce(), []
for episode in range(said.episodes):
    observation, info = environment.reset(seed=episode)
    over = False
    while not over:
        action = 5e-4 * (observation[0] - environment.WANTED)  # a hand-made policy; put yours here
        observation, reward, _, over, _ = environment.step(action)
    errors.append(-reward)
print(f"{said.episodes} episodes, the force is off by {np.mean(errors):.3f} N in the end")
