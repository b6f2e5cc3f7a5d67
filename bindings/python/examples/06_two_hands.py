"""Two hands hold one rope: each feels a spring to the other."""
import numpy as np

import knurl
from session import connected, options

said = options(__doc__)
motion = {"left": [(0, 0, 0, 0), (1, 0.01, 0, 0), (3, -0.01, 0, 0.01)], "right": [(0, 0, 0, 0), (1, 0, 0.02, 0), (3, 0, -0.02, 0)]}
devices = {"left": "premium15", "right": "premium15"}
with connected(said, devices, hand=motion) as client:
    first, second = (device.name for device in client.devices()[:2])
    with client.claim(first) as left, client.claim(second) as right:
        rope = [hand.add(knurl.Spring(stiffness=100, damping=1, duration=1 / 60)) for hand in (left, right)]
        left.arm()
        right.arm()
        try:
            for report in left.reports(rate=60):  # it commits the left hand
                other = right.newest(timeout=0)
                if other is not None:
                    rope[0].anchor, rope[1].anchor = other.position, report.position
                right.commit()
                if report.time > said.seconds:
                    break
        except KeyboardInterrupt:
            pass
        pulls = [0.0 if end.feedback is None else float(np.linalg.norm(end.feedback.force)) for end in rope]
        print(f"{first} feels {pulls[0]:.2f} N, {second} feels {pulls[1]:.2f} N")
