"""What the tests have in common: a servo of their own, a bridge, and waiting for what the servo reports."""

import os
import subprocess
import sys
import unittest

import knurl

HERE = os.path.dirname(os.path.abspath(__file__))
PACKAGE = os.path.dirname(HERE)
EXAMPLES = os.path.join(PACKAGE, "examples")

# The simulated hand: above the floor at height 0, then 4 mm below it; rows of t (s), x, y, z (m).
ABOVE = [(0, 0, 0, 0.01), (1000, 0, 0, 0.01)]
PRESS = [(0, 0, 0, 0.005), (0.6, 0, 0, 0.005), (0.8, 0, 0, -0.004), (1000, 0, 0, -0.004)]


def until(hand, true_of, cycles=8000):
    """The first report of which `true_of` holds. Fails after so many cycles of the servo, not after a time."""
    report = hand.next_report(20)
    assert report is not None, "the servo gives no reports"
    first = report.cycle
    while not true_of(report):
        assert report.cycle - first < cycles, f"not within {cycles} cycles: {report}"
        hand.commit() if isinstance(hand, knurl.Hand) else None
        report = hand.next_report(20)
        assert report is not None, "the servo gives no reports any more"
    return report


def until_active(hand):
    """The first report with the whole force."""
    return until(hand, lambda report: report.state == knurl.DeviceState.ACTIVE)


def run_python(code, *arguments, timeout=60, **options):
    """Runs a program in another interpreter; stdout and stderr are texts."""
    return subprocess.run([sys.executable, "-c", code, *arguments], timeout=timeout, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)


class ServoCase(unittest.TestCase):
    """Tests that share a servo with a simulated device."""

    HAND = ABOVE
    PROFILE = "premium15"
    OPTIONS = {}

    @classmethod
    def setUpClass(cls):
        cls.servo = knurl.simulated(cls.PROFILE, hand=cls.HAND, **cls.OPTIONS)
        cls.addClassCleanup(cls.servo.close)

    def connected(self, **options):
        client = self.servo.connect(**options)
        self.addCleanup(client.close)
        return client

    def claimed(self, **options):
        hand = self.connected().claim(**options)
        self.addCleanup(hand.close)
        return hand


class Bridge:
    """A knurl-bridge in front of a servo, at a port of its own."""

    def __init__(self, servo, folder, with_key):
        program = os.environ["KNURL_BRIDGE"]
        keys, self.key_file = os.path.join(folder, "bridge.keys"), None
        words = ["--servo", servo.name, "--listen", "127.0.0.1:0"]
        if with_key:
            subprocess.run([program, "keygen", "--keys", keys, "--name", "anna", "--role", "control"], check=True,
                           stdout=subprocess.DEVNULL)
            self.key_file = os.path.join(folder, "anna.key")
            with open(keys, encoding="ascii") as all_keys, open(os.open(self.key_file, os.O_CREAT | os.O_WRONLY, 0o600), "w") as own:
                own.writelines(line for line in all_keys if line.startswith("anna "))
            words += ["--keys", keys]
        else:
            words += ["--anyone"]
        self._process = subprocess.Popen([program, *words], env=servo.environment, text=True,
                                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        line = self._process.stdout.readline()
        assert "knurl://" in line, line
        self.address = line[line.index("knurl://"):].split(",")[0].split()[0]

    def close(self):
        self._process.kill()
        self._process.wait()
        self._process.stdout.close()
