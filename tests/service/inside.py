"""The services as systemd runs them: called once by the virtual machine of scripts/unit-test, as root. A line for each check,
then "N passed, N failed"."""

import glob
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import time

HERE = "/root/unit"
ACTIVE, FORCE = "4", ("3", "4", "5")  # DeviceState: active; with ramp_up and ramp_down
VIRTUALIZATION = subprocess.run(["systemctl", "show", "--property=Virtualization", "--value"], capture_output=True,
                                text=True).stdout.strip()
KVM = VIRTUALIZATION == "kvm"
KILLS = 10
passed = failed = 0


def check(good, what, figures=""):
    global passed, failed
    passed, failed = passed + bool(good), failed + (not good)
    print(f"{'ok  ' if good else 'FAIL'} {what}{': ' if figures != '' else ''}{figures}", flush=True)
    return good


def run(*words, **options):
    return subprocess.run(words, capture_output=True, text=True, **options)


def until(condition, seconds=60, pause=0.05):
    """Seconds until it holds; None: never."""
    begin = time.monotonic()
    while time.monotonic() - begin < seconds:
        if condition():
            return time.monotonic() - begin
        time.sleep(pause)
    return None


def shown(unit, name):
    return run("systemctl", "show", "--value", "-p", name, unit).stdout.strip()


def main_pid():
    return int(shown("knurld", "MainPID"))


def serves_after(pid):
    """A servo runs that is not this one: its guardian watches, and it has a socket."""
    return not os.path.exists(f"/proc/{pid}") and named("knurl-guardian") and os.path.exists("/run/knurl/default.sock") and \
        main_pid() not in (0, pid)


def processes(unit="knurld"):
    try:
        with open(f"/sys/fs/cgroup/system.slice/{unit}.service/cgroup.procs") as file:
            return {int(pid): read(f"/proc/{pid.strip()}/comm").strip() for pid in file}
    except OSError:
        return {}


def read(path):
    try:
        with open(path) as file:
            return file.read()
    except OSError:
        return ""


def named(name):
    return next((pid for pid, comm in processes().items() if comm == name), 0)


def flight_records():
    return set(glob.glob("/var/lib/knurl/flight-*.csv"))


def journal(since, unit="knurld"):
    return run("journalctl", "-u", unit, "-o", "cat", "--since", f"@{since:.3f}").stdout


def status(pid, name):
    found = re.search(rf"^{name}:\s*(.*)$", read(f"/proc/{pid}/status"), re.MULTILINE)
    return found.group(1) if found else ""


def policies(pid):
    """(name, priority) of each thread in real time."""
    found = set()
    for stat in glob.glob(f"/proc/{pid}/task/*/stat"):
        name, fields = re.match(r"\d+ \((.*)\) (.*)", read(stat)).groups()
        fields = fields.split()
        if int(fields[38]) == os.SCHED_FIFO:
            found.add((name, int(fields[37])))
    return found


def become(user):
    return ["setpriv", f"--reuid={user}", f"--regid={user}", "--init-groups"]


class Hand:
    """The application, as an ordinary user who is a member of haptics."""

    def __init__(self, name, servo="knurl:default", key=None):
        self.path = f"/tmp/hand-{name}"
        variables = ["KNURL_RUNTIME_DIR=/run/knurl"] + ([f"KNURL_KEY={key}"] if key else [])
        with open(self.path, "w") as out, open(self.path + ".err", "w") as errors:
            self.process = subprocess.Popen(
                [*become("somebody"), "env", *variables, "/usr/local/bin/knurl-unit-hand", servo],
                stdout=out, stderr=errors)

    def lines(self, since=0.0):
        with open(self.path, "rb") as file:  # some ten seconds
            file.seek(max(0, os.path.getsize(self.path) - 200_000))
            rows = [line.split() for line in file.read().decode().splitlines()]
        return [row for row in rows[1:] if len(row) == 3 and float(row[0]) >= since]

    def feels(self, since):
        """The newest report with the whole force. since: monotonic time."""
        return next((row for row in reversed(self.lines(since)) if row[1] == ACTIVE and abs(float(row[2])) > 0.05), None)

    def says(self):
        """What came last, and the errors."""
        return f"{self.lines()[-3:]} {read(self.path + '.err')[-300:].strip()}"

    def wait(self, since, seconds=60):
        took = until(lambda: self.feels(since), seconds)
        if took is None:
            print("     the application does not feel: " + self.says(), run("knurl", "ls").stdout)
        return took

    def end(self):
        self.process.terminate()
        self.process.wait()


def acts(guardian):
    """How often a guardian has zeroed the first device of a servo that stood still: the first word of its board."""
    for line in read(f"/proc/{guardian}/maps").splitlines():
        if "knurl-guardian" in line:
            with open(f"/proc/{guardian}/mem", "rb") as memory:
                memory.seek(int(line.split("-")[0], 16))
                return struct.unpack("<Q", memory.read(8))[0]
    return -1


def set_up():
    os.makedirs("/etc/knurl", exist_ok=True)
    with open("/etc/knurl/knurld.toml", "w") as file:
        file.write(f'rate = 500\nidle = "{"poll" if KVM else "sleep"}"\nsocket_group = "haptics"\n[[device]]\nname = "right"\naddress = "sim:premium15"\n')
    run("usermod", "-aG", "haptics", "somebody")


def starts():
    since = time.time()
    done = run("systemctl", "enable", "--now", "knurld")
    seconds = until(lambda: "knurld: ready" in journal(since))
    if not check(seconds is not None, "knurld starts under its unit", f"ready after {time.time() - since:.1f} s"):
        print(done.stderr, journal(since), shown("knurld", "Result"))
        return
    said = journal(since)
    complaints = [line for line in said.splitlines() if line.startswith("knurld:") and line != "knurld: ready"]
    check(not complaints, "no right is missing", "\n".join(complaints))
    print("     " + "\n     ".join(line.strip() for line in said.splitlines()))
    pid, guardian = main_pid(), named("knurl-guardian")
    threads = policies(pid)
    check(("knurl-servo", 80) in threads and ("knurl-guardian", 85) in policies(guardian), "real time",
          f"{sorted(threads)}, {sorted(policies(guardian))}")
    check(int(status(pid, "VmLck").split()[0]) > 1000 and int(status(guardian, "VmLck").split()[0]) > 1000, "memory is locked",
          f"servo {status(pid, 'VmLck')}, guardian {status(guardian, 'VmLck')}")
    scores = {comm: read(f"/proc/{one}/oom_score_adj").strip() for one, comm in processes().items()}
    check(scores.get("knurl-guardian") == "-900" and read(f"/proc/{pid}/oom_score_adj").strip() == "-900" and
          scores.get("knurl-closer") == "0", "when memory is short servo and guardian go last, the closer by its size", scores)
    check(status(pid, "CapBnd") == "0" * 16 and status(pid, "NoNewPrivs") == "1" and status(pid, "Seccomp") == "2",
          "no capability, no new privileges, a filter of system calls")


def outlives(hand):
    """The guardian outlives each kill of the servo: a record, its line, a servo that starts, an application that goes on."""
    gone_on, back, rows, good = [], [], [], 0
    start = time.time()
    for _ in range(KILLS):
        pid, before = main_pid(), flight_records()
        if hand.wait(time.monotonic()) is None:
            continue
        time.sleep(1)
        hand.wait(time.monotonic())
        begin = time.monotonic()
        os.kill(pid, signal.SIGKILL)
        until(lambda: serves_after(pid))
        back.append(time.monotonic() - begin)
        new = flight_records() - before
        record = read(new.pop()).splitlines() if len(new) == 1 else ["no flight record"]
        columns = next((row for row in record if row.startswith("cycle,")), "").split(",")
        rows.append(len([row for row in record if row[0].isdigit()]))
        good += rows[-1] > 300 and record[-1].split(",")[columns.index("state")] in FORCE and \
            any(f"pid {pid}" in row for row in record[:8])
        if hand.wait(begin + back[-1]) is not None:
            gone_on.append(time.monotonic() - begin)
    check(good == KILLS, f"{KILLS} kills of the servo: flight records, force on in the last row", f"{good}, of {sorted(rows)} rows")
    said = journal(start).count("knurl-guardian: the servo died")
    check(said == KILLS, "the guardian's line is in the journal", f"{said} times")
    check(len(back) == KILLS and max(back) < 10, "systemd starts the servo again", "after " + spread(back))
    check(len(gone_on) == KILLS, "the application feels again", "after " + spread(gone_on))


def spread(values):
    return f"{min(values):.2f} to {max(values):.2f} s" if values else "never"


def ends(hand):
    """A stop and a restart ramp down: no flight record, nothing left."""
    for verb in ("stop", "restart", "restart", "restart"):
        hand.wait(time.monotonic())
        before, wall, begin, pid = flight_records(), time.time(), time.monotonic(), main_pid()
        left = processes()
        run("systemctl", verb, "knurld")
        took = time.monotonic() - begin
        time.sleep(2 if verb == "stop" else 0)
        said = journal(wall)
        remains = [f"{one} {comm}" for one, comm in left.items() if os.path.exists(f"/proc/{one}")]
        states = {row[1] for row in hand.lines(begin)}
        check(took < 10 and "code=killed" not in said and "code=exited, status" not in said and not remains and
              f"{pid}" not in shown("knurld", "MainPID") and flight_records() == before and "died" not in said and
              shown("knurld", "Result") == "success", f"systemctl {verb} while force is on: exit 0, no record, nothing left",
              f"{took:.2f} s; the application saw states {sorted(states)}; left: {remains or 'none'}")
        print("     " + next((line.strip() for line in said.splitlines() if " cycles, " in line), "no count of cycles"))
        if verb == "stop":
            check(not processes(), "the unit's cgroup is empty", processes())
            check(shown("knurld", "ExecMainStatus") == "0", "exit status 0")
            run("systemctl", "start", "knurld")
        check(hand.wait(time.monotonic()) is not None, f"the application feels after the {verb}")


def stopped(hand):
    """A stopped servo is zeroed, and goes on."""
    hand.wait(time.monotonic())
    pid, guardian, restarts = main_pid(), named("knurl-guardian"), shown("knurld", "NRestarts")
    before = acts(guardian)
    begin = time.monotonic()
    run("systemctl", "kill", "-s", "STOP", "--kill-whom=main", "knurld")
    until(lambda: status(pid, "State").startswith("T"), pause=0.0005)
    at = time.monotonic()
    seconds = until(lambda: acts(guardian) > before, 3, 0.0005)
    check(seconds is not None, "SIGSTOP to the servo alone: the guardian zeroes",
          f"{time.monotonic() - at:.4f} s after it was seen stopped, {time.monotonic() - begin:.3f} s after the command")
    time.sleep(1)
    run("systemctl", "kill", "-s", "CONT", "--kill-whom=main", "knurld")
    begin = time.monotonic()
    check(hand.wait(begin) is not None and main_pid() == pid and shown("knurld", "NRestarts") == restarts,
          "it goes on, the same servo, and ramps up", f"{time.monotonic() - begin:.2f} s after SIGCONT")

    # SIGTERM to a stopped servo waits for SIGCONT, which systemd sends after it.
    hand.wait(time.monotonic())
    os.kill(pid, signal.SIGSTOP)
    time.sleep(0.5)
    begin = time.monotonic()
    run("systemctl", "stop", "knurld")
    check(shown("knurld", "Result") == "success" and not processes(), "systemctl stop of a stopped servo: exit 0, nothing left",
          f"{time.monotonic() - begin:.2f} s")
    run("systemctl", "start", "knurld")


def guardians(hand):
    """What happens to a guardian is no reason to be without one."""
    hand.wait(time.monotonic())
    pid, guardian, before, wall, begin = main_pid(), named("knurl-guardian"), flight_records(), time.time(), time.monotonic()
    os.kill(guardian, signal.SIGSTOP)
    time.sleep(0.3)
    os.kill(pid, signal.SIGKILL)
    back = until(lambda: serves_after(pid))
    check(back is not None and len(flight_records() - before) == 1 and not os.path.exists(f"/proc/{guardian}"),
          "guardian stopped, then servo killed: the guardian goes on, saves the record, ends", f"servo back after {back} s")
    check(hand.wait(time.monotonic()) is not None, "the application feels after that")

    pid, guardian, before, wall = main_pid(), named("knurl-guardian"), flight_records(), time.time()
    os.kill(guardian, signal.SIGKILL)
    back = until(lambda: serves_after(pid))
    check(back is not None and "the guardian died" in journal(wall) and flight_records() == before,
          "guardian killed: the servo ramps down, ends, and starts again with a new one", f"after {back} s")
    check(hand.wait(time.monotonic()) is not None, "the application feels after that")

    # A servo that hangs: its main thread is held as by a debugger, from which no SIGCONT frees it.
    pid, before, begin = main_pid(), flight_records(), time.monotonic()
    holder = subprocess.Popen(["python3", f"{HERE}/hold.py", str(pid)])
    until(lambda: status(pid, "State").startswith("t"))
    begin = time.monotonic()
    run("systemctl", "stop", "knurld")
    took = time.monotonic() - begin
    holder.wait()
    check(took < 20 and len(flight_records() - before) == 1 and not processes(),
          "systemctl stop of a servo that hangs: killed, and its guardian saves the record", f"{took:.1f} s")
    run("systemctl", "reset-failed", "knurld")
    run("systemctl", "start", "knurld")
    hand.wait(time.monotonic())


def short_of_memory(hand):
    """The kernel's own choice of a victim, asked for by sysrq: the largest process, not the servo."""
    with open("/proc/self/oom_score_adj", "w") as file:
        file.write("-1000")
    pid, guardian = main_pid(), named("knurl-guardian")
    hog = subprocess.Popen(["python3", "-c", "x = b'1' * 300_000_000\nimport time\ntime.sleep(60)"],
                           preexec_fn=lambda: open("/proc/self/oom_score_adj", "w").write("0"))
    until(lambda: int((status(hog.pid, "VmRSS") or "0").split()[0]) > 290_000)
    with open("/proc/sysrq-trigger", "w") as file:
        file.write("f")
    check(until(lambda: hog.poll() is not None, 10) is not None and main_pid() == pid and named("knurl-guardian") == guardian,
          "short of memory: the kernel chooses another process", f"it ended with {hog.poll()}")
    print("     " + " ".join(line for line in run("dmesg").stdout.splitlines() if "Killed process" in line))
    # The same choice among the unit's own processes: only that one ends.
    closer = named("knurl-closer")
    if closer:
        os.kill(closer, signal.SIGKILL)
        time.sleep(1)
        check(main_pid() == pid, "the closer killed, as by the kernel: the servo runs on")
    begin = time.monotonic()
    check(hand.wait(begin) is not None, "the application feels on")


def bridge():
    """A user of its own, and a bridge that works."""
    made = run("knurl-bridge", "keygen", "--keys", "/etc/knurl/bridge.keys", "--name", "anna", "--role", "control")
    shutil.chown("/etc/knurl/bridge.keys", "knurl-bridge", "knurl-bridge")
    key = next(line for line in read("/etc/knurl/bridge.keys").splitlines() if line.startswith("anna "))
    with open("/tmp/anna.key", "w", opener=lambda path, flags: os.open(path, flags, 0o600)) as file:
        file.write(key + "\n")
    shutil.chown("/tmp/anna.key", "somebody")
    wall = time.time()
    run("systemctl", "enable", "--now", "knurl-bridge")
    listens = until(lambda: "4096" in journal(wall, "knurl-bridge"))
    user = status(int(shown("knurl-bridge", "MainPID") or 0), "Uid").split()[:1]
    check(listens is not None and user == [run("id", "-u", "knurl-bridge").stdout.strip()],
          "the bridge runs as a user of its own", f"uid {user}, {made.stderr.strip()}")
    print("     " + journal(wall, "knurl-bridge").strip().replace("\n", "\n     "))
    far = Hand("far", "knurl://127.0.0.1:4096", "/tmp/anna.key")
    felt = far.wait(time.monotonic())
    row = far.feels(0)
    check(felt is not None, "an application arms through the bridge, and feels",
          f"{row and row[2]} N; {read(far.path + '.err').strip()}")

    os.system("chgrp haptics /dev/bus/usb/*/*; chmod 660 /dev/bus/usb/*/*")  # as 70-knurl.rules does to a device
    pid, guardian = main_pid(), named("knurl-guardian")
    refused = ("EPERM", "EACCES", "ENOENT", "EROFS", "ESRCH")
    run("install", "-d", "-m", "1777", "/run/probe")
    shutil.copy(f"{HERE}/probe.py", "/opt/probe.py")
    run(*become("knurl-bridge"), "python3", "/opt/probe.py", "/run/probe/user", str(pid), str(guardian))
    tell_probe("as the user knurl-bridge, without the unit's sandbox", json.loads(read("/run/probe/user") or "{}"), refused,
               {"USB device", "flight record read", "keys written"})
    # The bridge's own unit, with another program in it.
    unit = read("/lib/systemd/system/knurl-bridge.service")
    unit = re.sub(r"ExecStart=.*", f"ExecStart=/usr/bin/python3 /opt/probe.py /run/probe/unit {pid} {guardian}", unit)
    unit = re.sub(r"Type=exec", "Type=oneshot\nReadWritePaths=/run/probe", unit).replace("Restart=on-failure", "")
    with open("/run/systemd/system/knurl-probe.service", "w") as file:
        file.write(unit)
    run("systemctl", "daemon-reload")
    ran = run("systemctl", "start", "knurl-probe")
    tell_probe("in the bridge's unit", json.loads(read("/run/probe/unit") or "{}"), refused, set())
    if ran.returncode:
        print(journal(wall, "knurl-probe"))
    check(main_pid() == pid and named("knurl-guardian") == guardian and far.wait(time.monotonic()) is not None,
          "the servo runs on, and the application feels")

    # Both ways of ending: the application hears of it and goes on.
    begin = time.monotonic()
    os.kill(pid, signal.SIGKILL)
    until(lambda: serves_after(pid))
    check(far.wait(time.monotonic()) is not None, "the servo killed: the application feels again through the bridge",
          f"after {time.monotonic() - begin:.2f} s")
    far.end()


def tell_probe(who, seen, refused, granted):
    done = {what: answer for what, answer in seen.items() if answer not in refused and what not in granted}
    check(seen and not done, f"a taken bridge, {who}: {len(seen)} attempts, each refused" +
          (f" but for {sorted(granted)}" if granted else ""), done or "")
    print("     " + ", ".join(f"{what} {answer}" for what, answer in seen.items()))


def devices():
    """The servo's sandbox lets it see and open devices."""
    unit = read("/lib/systemd/system/knurld.service")
    unit = re.sub(r"ExecStart=.*", "ExecStart=/bin/sh -c 'knurl devices; for node in /dev/bus/usb/*/* /dev/ttyS1 /dev/cpu_dma_latency /dev/vda /dev/mem; "
                  "do if true 2>/dev/null <>$node; then echo opens $node; fi; done'", unit)
    unit = re.sub(r"ExecStopPost=.*", "", unit).replace("Type=exec", "Type=oneshot\nSupplementaryGroups=dialout disk kmem")
    unit = unit.replace("Restart=on-failure", "").replace("RuntimeDirectory=knurl\n", "").replace("StateDirectory=knurl\n", "")
    with open("/run/systemd/system/knurl-devices.service", "w") as file:
        file.write(unit)
    run("systemctl", "daemon-reload")
    wall = time.time()
    run("systemctl", "start", "knurl-devices")
    said = journal(wall, "knurl-devices")
    check("opens /dev/bus/usb/" in said and "opens /dev/ttyS1" in said and "opens /dev/cpu_dma_latency" in said and
          "opens /dev/vda" not in said and "opens /dev/mem" not in said,
          "in the servo's unit: USB, serial lines and idle states can be opened, disks and memory cannot",
          re.findall(r"opens (\S+)", said))


def exposure():
    for unit in ("knurld", "knurl-bridge"):
        said = run("systemd-analyze", "security", "--no-pager", f"{unit}.service").stdout
        level = re.search(r"exposure level for \S+: ([0-9.]+)", said)
        check(level and float(level.group(1)) <= 3, f"systemd-analyze security {unit}", level and level.group(1))


def main():
    print(read("/etc/debian_version").strip(), os.uname().release, run("systemctl", "--version").stdout.splitlines()[0],
          VIRTUALIZATION, f"{os.cpu_count()} CPUs", flush=True)
    set_up()
    starts()
    hand = Hand("near")
    seconds = hand.wait(time.monotonic())
    row = hand.feels(0)
    check(seconds is not None, "an application feels a force", f"{row and row[2]} N; {read(hand.path + '.err').strip()}")
    outlives(hand)
    ends(hand)
    stopped(hand)
    guardians(hand)
    short_of_memory(hand)
    hand.end()
    bridge()
    devices()
    exposure()
    wall = time.time()
    run("systemctl", "stop", "knurl-bridge", "knurld")
    print("     " + next((line.strip() for line in journal(wall).splitlines() if " cycles, " in line), ""))
    denied = [line for line in run("journalctl", "-o", "cat", "-b").stdout.splitlines()
              if "left-over process" in line or "remains running" in line]
    check(not denied, "systemd found no process of an earlier run", denied[:3])


try:
    main()
except Exception as error:  # the rest of the machine's test is lost, and that is a failure
    import traceback
    traceback.print_exc()
    check(False, "the test itself", error)
print(f"{passed} passed, {failed} failed", flush=True)
