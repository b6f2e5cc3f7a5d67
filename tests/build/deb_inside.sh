# Run by scripts/deb-test in a root without installed packages. $1: the packages; later/ has a later version of them.
packages=$1
fail() { echo "deb-test: $1" >&2; exit 1; }
installed() {  # or removed with their configuration left
    dpkg-query --show --showformat='${db:Status-Status} ${Package}\n' 'knurl*' 'libknurl*' 2>/dev/null |
        sed -n '/^not-installed /!s/^[^ ]* //p'
}
install() { apt-get install -y -qq --no-install-recommends "$@" >/tmp/apt.log 2>&1 || { cat /tmp/apt.log; fail "apt-get install failed"; }; }

echo "== install: libknurl-dev and a compiler, as the README says"
apt-get update -qq
install "$packages"/libknurl-dev_*.deb "$packages"/libknurl0_*.deb "$packages"/libknurl-offline0_*.deb g++ cmake make pkg-config

echo "== the README's program, by CMake and by pkg-config, with what apt brought"
work="$(mktemp -d)"
awk '/^```cpp/ { inside = 1; next } /^```/ { if (inside) exit } inside' README.md >"$work/main.cpp"
grep -q 'int main' "$work/main.cpp" || fail "the first cpp block of README.md is no program"
{
    echo 'cmake_minimum_required(VERSION 3.25)'
    echo 'project(simulation LANGUAGES CXX)'
    echo 'add_executable(my_simulation main.cpp)'
    awk '/^```cmake/ { inside = 1; next } /^```/ { inside = 0 } inside' README.md
} >"$work/CMakeLists.txt"
cmake -S "$work" -B "$work/build" >"$work/log" 2>&1 && cmake --build "$work/build" >>"$work/log" 2>&1 ||
    { cat "$work/log"; fail "the README's program does not build by CMake"; }
g++ -std=c++20 "$work/main.cpp" -o "$work/by-pkg-config" $(pkg-config --cflags --libs knurl)

echo "== install: knurl-server and knurl-tools"
install "$packages"/knurl-server_*.deb "$packages"/knurl-tools_*.deb "$packages"/knurl-lookalikes_*.deb
for user in knurl knurl-bridge; do getent passwd "$user" >/dev/null || fail "there is no user $user"; done
id --name --groups knurl-bridge | grep -qw haptics || fail "the bridge may not reach the servo's socket"
getent group haptics >/dev/null || fail "there is no group haptics"
for package in libknurl-dev libknurl0 libknurl-offline0 knurl-server knurl-tools knurl-lookalikes; do
    grep -q 'Boost Software License' "/usr/share/doc/$package/copyright" || fail "$package comes without its licence"
done

echo "== a servo, knurl ls, the README's program"
export KNURL_RUNTIME_DIR="$work" KNURL_STATE_DIR="$work/state"
knurld --device right=sim:premium15 >"$work/servo" 2>&1 &
servo=$!
"$work/build/my_simulation" | tee "$work/felt"
grep -qE 'mm, [0-9.]*[1-9][0-9]* N' "$work/felt" || { cat "$work/servo"; fail "the README's program felt nothing"; }

echo "== the README's C and Python, with what apt brought"
awk '/^```c$/ { inside = 1; next } /^```/ { inside = 0 } inside' runtime/capi/README.md >"$work/wall.c"
gcc -std=c11 "$work/wall.c" -o "$work/wall" $(pkg-config --cflags --libs knurl-c)
"$work/wall" | grep -E 'mm, [0-9.]+ N' || fail "the wall from C felt nothing"
install "$packages"/python3-knurl_*.deb
python3 -c '
import itertools, knurl
with knurl.connect() as client, client.claim() as hand:
    hand.add(knurl.Plane(normal=(0, 0, 1), offset=0.005, stiffness=800))
    hand.arm()
    felt = max(report.sent_force[2] for report in itertools.islice(hand.reports(rate=60), 120))
print(f"{felt:.2f} N from Python")
assert felt > 0.1
with knurl.Offline() as servo:
    servo.add(knurl.Plane(stiffness=800))
    assert abs(servo.step((0, 0, -1e-3)).force[2] - 0.8) < 1e-9
' || fail "the wall from Python felt nothing"
knurl ls | tee "$work/listed"
grep -q 'knurl:default' "$work/listed" || fail "knurl ls does not show the servo"
kill $servo
wait $servo || fail "knurld ended with $?"

# systemd cannot run here, so a script in its place notes what the packages ask of it. It is in /usr/bin, since apt runs the
# packages' scripts with a PATH without /usr/local.
mkdir -p /run/systemd/system /etc/systemd/system/multi-user.target.wants
cat >/usr/bin/systemctl <<'S'
#!/bin/sh
echo "$*" >>/tmp/systemctl
S
chmod +x /usr/bin/systemctl
ln -s /lib/systemd/system/knurld.service /etc/systemd/system/multi-user.target.wants/
cp /usr/share/knurl/knurld.toml /etc/knurl/

echo "== upgrade: what runs is restarted, and not stopped before"
: >/tmp/systemctl
install "$packages"/later/*.deb
cat /tmp/systemctl
grep -q '^try-restart knurld.service knurl-bridge.service$' /tmp/systemctl || fail "an upgrade does not restart the services"
! grep -q '^stop' /tmp/systemctl || fail "an upgrade stops the services before their programs are there"
[[ -L /etc/systemd/system/multi-user.target.wants/knurld.service ]] || fail "an upgrade disables the service"
[[ -e /etc/knurl/knurld.toml ]] || fail "an upgrade loses the configuration"

echo "== remove: stopped, no link to what is gone, the configuration stays"
: >/tmp/systemctl
apt-get remove -y -qq knurl-server knurl-tools knurl-lookalikes libknurl-dev python3-knurl libknurl0 libknurl-offline0 >/tmp/apt.log 2>&1 || { cat /tmp/apt.log; fail "apt-get remove failed"; }
cat /tmp/systemctl
grep -q '^stop knurl-bridge.service knurld.service$' /tmp/systemctl || fail "a removal does not stop the services"
[[ ! -L /etc/systemd/system/multi-user.target.wants/knurld.service ]] || fail "a removal leaves the service enabled"
[[ -e /etc/knurl/knurld.toml ]] || fail "a removal loses the configuration"

echo "== purge: nothing"
apt-get purge -y -qq $(installed) >/tmp/apt.log 2>&1 || { cat /tmp/apt.log; fail "apt-get purge failed"; }
left="$(find / -xdev \( -path /proc -o -path /root -o -path /tmp -o -path /sys \) -prune -o \( -iname '*knurl*' -o -name '*haptics*' \) -print |
    grep -v '^/var/log/\|^/var/cache/' || true)"
[[ -z "$left" ]] || fail "left behind:"$'\n'"$left"
# /etc/passwd- and similar files are backups that userdel makes.
! grep -rIl --exclude='*-' 'knurl\|haptics' /etc || fail "left behind in these files of /etc"
for user in knurl knurl-bridge; do ! getent passwd "$user" || fail "the user $user is left behind"; done
! getent group haptics || fail "the group is left behind"
[[ -z "$(installed)" ]] || fail "still known to dpkg: $(installed)"
rm -r /run/systemd /usr/bin/systemctl
echo "== the packages are as they should be"
