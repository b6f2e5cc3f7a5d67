"""hold.py PID: holds the main thread of a process, as a debugger does, until the process dies."""

import ctypes
import os
import sys

PTRACE_SEIZE, PTRACE_INTERRUPT, WALL = 0x4206, 0x4207, 0x40000000

libc = ctypes.CDLL(None, use_errno=True)
pid = int(sys.argv[1])
for request in (PTRACE_SEIZE, PTRACE_INTERRUPT):
    if libc.ptrace(request, pid, None, None) != 0:
        sys.exit(f"hold: {os.strerror(ctypes.get_errno())}")
while not os.WIFSIGNALED(os.waitpid(pid, WALL)[1]):
    pass
