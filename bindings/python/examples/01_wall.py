"""A floor that moves up and down, as hard as one from C++: the servo computes its force 1000 times a second."""
import numpy as np

import knurl

with knurl.connect() as client, client.claim() as hand:
    floor = hand.add(knurl.Plane(normal=(0, 0, 1), offset=0.005, stiffness=800))  # m, N/m
    hand.arm()
    for report in hand.reports(rate=60):  # the newest one 60 times a second
        floor.offset = 0.005 + 0.002 * np.sin(report.time)  # sent with the next commit, which reports() does
