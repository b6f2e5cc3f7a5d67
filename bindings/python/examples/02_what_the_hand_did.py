"""Presses on a floor, records every cycle, and draws what the hand did and felt."""
import knurl
from session import connected, options, turns

said = options(__doc__, lambda parser: parser.add_argument("--out", default="hand.png", help="picture to draw"))
with connected(said) as client, client.claim() as hand:
    hand.add(knurl.Plane(normal=(0, 0, 1), stiffness=800))
    with hand.record() as recording:
        hand.arm()
        for report in turns(said, hand):
            pass
print(f"{len(recording)} cycles, {recording.missed} missed, largest force {abs(recording.reports['sent_force']).max():.2f} N")
recording.save("hand.csv")
try:
    knurl.plot(recording, said.out)
    print(f"drawn to {said.out}, written to hand.csv")
except ImportError as error:
    print(error)
