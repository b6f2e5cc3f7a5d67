"""What the examples have in common: --seconds, --servo, --simulated."""
import argparse
import contextlib

import knurl

# How the simulated hand of these examples moves: rows of t (s), x, y, z (m).
PRESS = [(0, 0, 0, 0.01), (0.5, 0, 0, 0.01), (1.0, 0, 0, -0.004), (4.0, 0.02, 0, -0.004), (5.0, 0, 0, 0.01)]


def options(description, more=None):
    """The words on the command line. `more(parser)` adds options."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="how long it runs (until Ctrl-C)")
    parser.add_argument("--servo", help="address, if not knurl:default")
    parser.add_argument("--simulated", action="store_true", help="on a simulated device and hand of its own")
    if more is not None:
        more(parser)
    return parser.parse_args()


@contextlib.contextmanager
def connected(said, profile="premium15", hand=None, **simulation):
    """A client of the servo that the command line names."""
    with contextlib.ExitStack() as stack:
        if said.simulated:
            servo = stack.enter_context(knurl.simulated(profile, hand=PRESS if hand is None else hand, **simulation))
            yield stack.enter_context(servo.connect())
        else:
            yield stack.enter_context(knurl.connect(said.servo))


def turns(said, hand, rate=60):
    """hand.reports() until --seconds are over or Ctrl-C."""
    try:
        for report in hand.reports(rate=rate):
            yield report
            if report.time > said.seconds:
                return
    except KeyboardInterrupt:
        print()
