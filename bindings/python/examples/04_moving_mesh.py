"""A cube of triangles that turns: sent once, then only its pose, 60 times a second; the servo moves it in between."""
import numpy as np

import knurl
from session import connected, options, turns

corners = 0.02 * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)  # m
faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
speed = 0.5  # rad/s

said = options(__doc__)
with connected(said, hand=[(0, 0.005, 0, 0.04), (1, 0.005, 0, 0.015)]) as client, client.claim() as hand:
    sent = hand.send_mesh(corners, faces)  # or a trimesh object: hand.send_mesh(trimesh.load("cube.stl"))
    cube = hand.add(knurl.Shape(asset=sent.asset, stiffness=600, damping=1, angular_velocity=(0, 0, speed)))
    cube.friction.dynamic = 0.4  # it takes the hand along
    hand.arm()
    for report in turns(said, hand):
        half = speed * report.time / 2
        cube.orientation = (np.cos(half), 0, 0, np.sin(half))  # w x y z
print(f"turned by {np.degrees(2 * half):.0f} degrees; the cube pushed with {np.round(report.sent_force, 2)} N")
