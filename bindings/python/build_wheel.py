#!/usr/bin/env python3
"""build_wheel.py BUILD OUT: writes OUT/knurl-VERSION-py3-none-linux_x86_64.whl from a CMake build. Needs no network, no wheel, no setuptools.

    bindings/python/build_wheel.py build/release dist
    pip install dist/knurl-*.whl

It holds the package, libknurl.so.0, libknurl-offline.so.0, knurld, and the shared libraries that these need and a bare
Debian or Ubuntu lacks. What every system has (libc, libstdc++, ...) is not in it.
"""

import base64
import csv
import hashlib
import io
import os
import platform
import re
import subprocess
import sys
import tempfile
import zipfile

from run_tests import HERE, copied_package

# Of Debian's essential and required packages, or of the base of every distribution.
EVERYWHERE = re.compile(r"(ld-linux.*|linux-vdso|lib(c|m|dl|rt|pthread|util|gcc_s|stdc\+\+|z))\.so(\..*)?$")
STAMP = (2020, 1, 1, 0, 0, 0)  # the same build gives the same file


def version():
    """Of the package."""
    with open(os.path.join(HERE, "knurl", "_version.py"), encoding="utf-8") as file:
        return re.search(r'__version__ = "(.+)"', file.read()).group(1)


def needed(path):
    """{name: path} of the shared libraries that a program or library needs, its own included in theirs."""
    said = subprocess.run(["ldd", path], check=True, stdout=subprocess.PIPE, text=True).stdout
    missing = re.findall(r"(\S+) => not found", said)
    if missing:
        sys.exit(f"build_wheel.py: {path} needs {', '.join(missing)}, which is not found")
    return {name: place for name, place in re.findall(r"(\S+) => (\S+) \(", said) if not EVERYWHERE.match(name)}


def own_name(name):
    """Under which a library lies in the wheel, of the same length: "knlssl.so.3"."""
    return "knl" + name[len("lib"):]


def renamed(content, names):
    """An ELF file that asks for these libraries by their names in the wheel.

    A process has one library of each name. Python's own module ssl may have loaded another libcrypto.so.3, or may want one
    later that is newer than ours.
    """
    for name in names:
        content = content.replace(f"\0{name}\0".encode(), f"\0{own_name(name)}\0".encode())
    return content


def binaries(build):
    """(name in the wheel, bytes) of the libraries, the servo, and what they need."""
    capi, servo = os.path.join(build, "runtime", "capi"), os.path.join(build, "apps", "knurld", "knurld")
    own = {name: os.path.join(capi, name) for name in ("libknurl.so.0", "libknurl-offline.so.0")}
    others = {}
    for path in (*own.values(), servo):
        others.update((name, place) for name, place in needed(path).items() if name not in own)
    for name, path in own.items():
        yield f"knurl/lib/{name}", renamed(read(path), others)
    for name, path in others.items():
        yield f"knurl/lib/{own_name(name)}", renamed(read(path), others)
    yield "knurl/bin/knurld", renamed(read(servo), others)


def modules(build):
    """(name in the wheel, bytes) of the Python files."""
    with tempfile.TemporaryDirectory() as folder:
        copied_package(build, folder)
        for base, _, names in os.walk(folder):
            for path in (os.path.join(base, name) for name in sorted(names)):
                yield os.path.relpath(path, folder), read(path)


def metadata(tag):
    """The files of the dist-info, without RECORD."""
    with open(os.path.join(HERE, "README.md"), encoding="utf-8") as file:
        readme = file.read()
    head = (f"Metadata-Version: 2.1\nName: knurl\nVersion: {version()}\nSummary: A haptics server for Linux, from Python\n"
            "License: BSL-1.0\nRequires-Python: >=3.9\nRequires-Dist: numpy\nProvides-Extra: plot\n"
            "Requires-Dist: matplotlib; extra == 'plot'\nDescription-Content-Type: text/markdown\n\n")
    wheel = f"Wheel-Version: 1.0\nGenerator: build_wheel.py of knurl {version()}\nRoot-Is-Purelib: false\nTag: {tag}\n"
    return {"METADATA": head + readme, "WHEEL": wheel, "top_level.txt": "knurl\nlerobot_teleoperator_knurl\n"}


class Wheel:
    """A zip archive that keeps the record of what is in it."""

    def __init__(self, path):
        self._archive = zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED)
        self._record = []

    def add(self, name, content, executable=False):
        """Writes a file."""
        entry = zipfile.ZipInfo(name, STAMP)
        entry.compress_type = zipfile.ZIP_DEFLATED
        entry.external_attr = (0o100755 if executable else 0o100644) << 16
        self._archive.writestr(entry, content)
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        self._record.append((name, "sha256=" + digest, len(content)))

    def close(self, record):
        """Writes the record."""
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows([*self._record, (record, "", "")])
        self._archive.writestr(zipfile.ZipInfo(record, STAMP), text.getvalue())
        self._archive.close()


def read(path):
    """A file's bytes."""
    with open(path, "rb") as file:
        return file.read()


def build_wheel(build, out):
    """Path of the wheel."""
    tag = f"py3-none-linux_{platform.machine()}"
    path = os.path.join(out, f"knurl-{version()}-{tag}.whl")
    os.makedirs(out, exist_ok=True)
    wheel = Wheel(path)
    for name, content in modules(build):
        wheel.add(name, content)
    for name, content in binaries(build):
        wheel.add(name, content, executable=True)
    info = f"knurl-{version()}.dist-info"
    for name, text in metadata(tag).items():
        wheel.add(f"{info}/{name}", text.encode())
    wheel.close(f"{info}/RECORD")
    return path


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    print(build_wheel(os.path.abspath(sys.argv[1]), sys.argv[2]))
