"""What a bridge that somebody has taken over would try. Called in the virtual machine of scripts/unit-test, as the bridge's user:
probe.py OUT SERVO GUARDIAN writes to OUT, as JSON, what each attempt was answered ("done", or the name of the error)."""

import ctypes
import errno
import glob
import json
import os
import signal
import sys

libc = ctypes.CDLL(None, use_errno=True)
PTRACE_ATTACH, PTRACE_SEIZE = 16, 0x4206


def answer(attempt):
    try:
        attempt()
    except OSError as error:
        return errno.errorcode[error.errno]
    return "done"


def ptrace(request, pid):
    if libc.ptrace(request, pid, None, None) != 0:
        raise OSError(ctypes.get_errno(), "ptrace")


def each(paths, attempt):
    """ "done" if one of them is."""
    answers = [answer(lambda p=p: attempt(p)) for p in paths]
    return "done" if "done" in answers else (answers or ["ENOENT"])[0]


def write_to(path):
    os.close(os.open(path, os.O_RDWR))


out, pids = sys.argv[1], [int(word) for word in sys.argv[2:4]]
seen = {}
for who, pid in zip(("servo", "guardian"), pids):
    seen[f"kill -0 {who}"] = answer(lambda: os.kill(pid, 0))
    seen[f"kill -9 {who}"] = answer(lambda: os.kill(pid, signal.SIGKILL))
    seen[f"kill -STOP {who}"] = answer(lambda: os.kill(pid, signal.SIGSTOP))
    seen[f"attach to {who}"] = answer(lambda: ptrace(PTRACE_ATTACH, pid))
    seen[f"seize {who}"] = answer(lambda: ptrace(PTRACE_SEIZE, pid))
    seen[f"memory of {who}"] = answer(lambda: write_to(f"/proc/{pid}/mem"))
    seen[f"priority of {who}"] = answer(lambda: os.sched_setscheduler(pid, os.SCHED_OTHER, os.sched_param(0)))
    seen[f"CPU of {who}"] = answer(lambda: os.sched_setaffinity(pid, {0}))
seen["socket removed"] = answer(lambda: os.unlink("/run/knurl/default.sock"))
seen["socket replaced"] = answer(lambda: os.close(os.open("/run/knurl/x", os.O_CREAT | os.O_WRONLY)))
seen["USB device"] = each(glob.glob("/dev/bus/usb/*/*") or ["/dev/bus/usb/001/001"], write_to)
seen["flight record read"] = each(glob.glob("/var/lib/knurl/flight-*") or ["/var/lib/knurl/x"], lambda p: open(p).close())
seen["keys written"] = answer(lambda: os.close(os.open("/etc/knurl/bridge.keys", os.O_WRONLY | os.O_APPEND)))
with open(out, "w") as file:
    json.dump(seen, file)
