"""A servo of one's own on a simulated device: for notebooks, examples and tests."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import time
import weakref
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

from ._client import Client, connect
from ._errors import BadParameters, NoServo

_HERE = os.path.dirname(os.path.abspath(__file__))

# The servo ends with this process, however that ends: then the shell's standard input does.
_UNTIL_INPUT_ENDS = 'exec 3<&0; "$@" <&- & servo=$!; (read _ <&3; kill $servo) & wait $servo'


def servo_program() -> str:
    """Path of knurld: $KNURLD, the package's own, or the PATH's."""
    stated = os.environ.get("KNURLD")
    if stated:
        return stated
    packaged = os.path.join(_HERE, "bin", "knurld")
    if os.path.exists(packaged):
        return packaged
    found = shutil.which("knurld")
    if found is None:
        raise NoServo("no servo can be started: knurld is not in the PATH; install Knurl, or set KNURLD to its path")
    return found


def _environment(folder: str) -> Dict[str, str]:
    environment = dict(os.environ, KNURL_RUNTIME_DIR=folder, KNURL_STATE_DIR=folder)
    libraries = os.path.join(_HERE, "lib")
    if not os.environ.get("KNURLD") and os.path.isdir(libraries):
        environment["LD_LIBRARY_PATH"] = ":".join(filter(None, [libraries, os.environ.get("LD_LIBRARY_PATH")]))
    return environment


def _written_motion(hand: Any, folder: str, name: str) -> str:
    """Path of a motion file: as given, or written from rows of t x y z (qw qx qy qz)."""
    if isinstance(hand, (str, os.PathLike)):
        return os.fspath(hand)
    rows = [[float(number) for number in row] for row in hand]
    if not rows or {len(row) for row in rows} not in ({4}, {8}):
        raise BadParameters("hand: rows of t, x, y, z (s, m), or of t, x, y, z, qw, qx, qy, qz, are needed")
    path = os.path.join(folder, f"{name}.csv")
    with open(path, "w", encoding="ascii") as file:
        file.write("t,x,y,z,qw,qx,qy,qz"[: 7 if len(rows[0]) == 4 else None] + "\n")
        file.writelines(",".join(map(repr, row)) + "\n" for row in rows)
    return path


def _stop(running: List["subprocess.Popen[bytes]"]) -> None:
    while running:
        process = running.pop()
        assert process.stdin is not None
        process.stdin.close()
        try:
            process.wait(8)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            process.wait()


def _end(running: List["subprocess.Popen[bytes]"], folder: str, process: int) -> None:
    """Once, also where the program ends without close(). A fork's child leaves its parent's servo alone."""
    if os.getpid() == process:
        _stop(running)
        shutil.rmtree(folder, ignore_errors=True)


class Simulated:
    """A running servo on simulated devices. Made by knurl.simulated(); ends with the `with` block, or stop()."""

    def __init__(self, command: Sequence[str], name: str, folder: str) -> None:
        self._folder = folder
        self._command = command
        self.name = name
        """The servo's name."""
        self.address = os.path.join(folder, name + ".sock")
        """For knurl.connect(): the path of its socket, which no other servo has."""
        self._running: List["subprocess.Popen[bytes]"] = []
        self._end = weakref.finalize(self, _end, self._running, folder, os.getpid())
        self.start()

    def start(self) -> None:
        """Starts it, also once more after stop() or kill(): clients that were connected attach again."""
        with open(os.path.join(self._folder, "said"), "wb") as said:
            process = subprocess.Popen(
                ["sh", "-c", _UNTIL_INPUT_ENDS, "knurld", *self._command],
                stdin=subprocess.PIPE, stdout=said, stderr=said,
                env=_environment(self._folder), start_new_session=True)  # Ctrl-C is for this program alone
        self._running.append(process)
        self._wait_until_it_listens()

    def _wait_until_it_listens(self, patience: float = 20.0) -> None:
        end = time.monotonic() + patience
        while time.monotonic() < end:
            try:
                connect(self.address, wait=0.05, hints=False).close()
                return
            except NoServo:
                if self._running[0].poll() is not None:
                    break
                time.sleep(0.005)
        said = self.said()
        self.close()
        raise NoServo(f"{self._command[0]} did not start: {said.strip().splitlines()[-1] if said.strip() else 'it said nothing'}")

    def said(self) -> str:
        """What the servo has printed."""
        try:
            with open(os.path.join(self._folder, "said"), encoding="utf-8", errors="replace") as file:
                return file.read()
        except OSError:
            return ""

    def connect(self, **options: Any) -> Client:
        """As knurl.connect(), with this servo."""
        return connect(self.address, **options)

    @property
    def environment(self) -> Dict[str, str]:
        """Environment for another program, such as knurl-bridge or `knurl`, that shall find this servo."""
        return _environment(self._folder)

    @property
    def pid(self) -> int:
        """Process number of the servo."""
        with self.connect(hints=False) as client:
            return client.servo_pid

    def kill(self) -> None:
        """Ends the servo at once, as a crash does: what a program does then can be tested."""
        os.kill(self.pid, 9)
        self.stop()

    def stop(self) -> None:
        """Ends the servo; it ramps down its devices first."""
        _stop(self._running)

    def close(self) -> None:
        """Ends the servo and removes its folder."""
        self._end()

    def __enter__(self) -> "Simulated":
        return self

    def __exit__(self, *error: Any) -> None:
        self.close()


def _configuration(profile: Union[str, Mapping[str, str]], hand: Any, options: Mapping[str, Any], folder: str) -> str:
    """Path of a configuration of knurld with these devices."""
    devices: Mapping[str, str] = {"": profile} if isinstance(profile, str) else profile
    text = ""
    for device, of in devices.items():
        address = ",".join([of if ":" in of else "sim:" + of, *(f"{key}={value}" for key, value in options.items())])
        keys = {"name": device, "address": address}
        motion = hand.get(device) if isinstance(hand, Mapping) else hand
        if motion is not None:
            keys["hand"] = os.path.abspath(_written_motion(motion, folder, device or "hand"))
        text += "[[device]]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items() if value)
    path = os.path.join(folder, "configuration.toml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def simulated(
    profile: Union[str, Mapping[str, str]] = "premium15",
    *,
    hand: Any = None,
    rate: float = 1000.0,
    name: Optional[str] = None,
    arguments: Sequence[str] = (),
    **options: Any,
) -> Simulated:
    """Starts a servo of one's own on a simulated device, in a folder of its own, and ends it with the `with` block.

    profile: "premium15", "falcon", "cartesian3", ..., or {name: profile} for several devices. hand: how the simulated
    hand moves, from each claim on: a CSV's path, or rows of t, x, y, z (s, m, device frame); of several devices a
    {name: hand}. rate: of the loop (Hz). name: of the servo. options: of the simulated device: push=1.5 (N), grip=0.5,
    tremor=0.2, seed=7, ... (drivers/README.md). arguments: of knurld besides. Raises NoServo: it cannot be started.

        with knurl.simulated(push=1.5) as servo, servo.connect() as client, client.claim() as hand: ...
    """
    program = servo_program()
    name = name or "simulated"
    folder = tempfile.mkdtemp(prefix="knurl-")
    try:
        configuration = _configuration(profile, hand, options, folder)
        command = [program, "--name", name, "--rate", repr(float(rate)), "--config", configuration]
        return Simulated([*command, *arguments], name, folder)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
