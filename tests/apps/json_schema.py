#!/usr/bin/python3
"""What the programs print for programs is as apps/schemas says: runs each with --json and checks every key of it.

    json_schema.py SCHEMAS KNURL KNURLD ARM.toml KNURL-SURFACE KNURL-DOCK
"""

import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

UNDERSTOOD = {"$schema", "$defs", "$ref", "title", "description", "type", "properties", "required",
              "additionalProperties", "items", "enum", "anyOf"}
KINDS = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}


def is_a(value, kind):
    if kind in ("integer", "number"):
        return not isinstance(value, bool) and isinstance(value, int if kind == "integer" else (int, float))
    return isinstance(value, KINDS[kind])


def faults(value, schema, root, where="$"):
    """What is not as the schema says, one line each."""
    if "$ref" in schema:
        return faults(value, root["$defs"][schema["$ref"].removeprefix("#/$defs/")], root, where)
    if "anyOf" in schema:
        tries = [faults(value, one, root, where) for one in schema["anyOf"]]
        return [] if [] in tries else min(tries, key=len)
    if "enum" in schema and value not in schema["enum"]:
        return [f"{where} is {value!r}, not one of {schema['enum']}"]
    kinds = schema.get("type", [])
    kinds = [kinds] if isinstance(kinds, str) else kinds
    if kinds and not any(is_a(value, kind) for kind in kinds):
        return [f"{where} is {value!r}, no {' or '.join(kinds)}"]
    found = []
    if isinstance(value, dict) and "object" in kinds:
        known, more = schema.get("properties", {}), schema["additionalProperties"]
        found += [f"{where} lacks {key}" for key in schema.get("required", []) if key not in value]
        for key, one in value.items():
            if key in known or more is not False:
                found += faults(one, known.get(key, more), root, f"{where}.{key}")
            else:
                found.append(f"{where}.{key} is not in the schema")
    if isinstance(value, list) and "items" in schema:
        for i, one in enumerate(value):
            found += faults(one, schema["items"], root, f"{where}[{i}]")
    return found


def parts(schema, where):
    yield schema, where
    for key in ("properties", "$defs"):
        for name, one in schema.get(key, {}).items():
            yield from parts(one, f"{where}.{name}")
    for one in schema.get("anyOf", []):
        yield from parts(one, where)
    for key in ("items", "additionalProperties"):
        if isinstance(schema.get(key), dict):
            yield from parts(schema[key], where)


def rules_broken(schemas):
    """The rules of apps/schemas/README.md, as far as they can be seen from the schemas alone."""
    broken, types = [], {}
    for name, schema in schemas.items():
        for part, where in parts(schema, name):
            broken += [f"{where}: this test does not understand {key}" for key in set(part) - UNDERSTOOD]
            if part.get("type") == "object" and "additionalProperties" not in part:
                broken.append(f"{where}: say additionalProperties, so that a new key is noticed")
            for key, one in part.get("properties", {}).items():
                if re.search(r"_(us|ms|min|h)$", key):
                    broken.append(f"{where}.{key}: times are in s")
                if "type" in one and one["type"] not in ("object", "array"):
                    kind = tuple(sorted([one["type"]] if isinstance(one["type"], str) else one["type"]))
                    types.setdefault(key, {}).setdefault(kind, f"{where}.{key}")
    for key, kinds in types.items():
        if len({tuple(k for k in kind if k != "null") for kind in kinds}) > 1:
            broken.append(f"one name, several types: {', '.join(kinds.values())}")
    return broken


class Programs:
    def __init__(self, knurl, knurld, folder):
        self.knurl, self.knurld, self.folder = knurl, knurld, Path(folder)
        self.environment = dict(os.environ, KNURL_RUNTIME_DIR=folder, KNURL_STATE_DIR=folder)
        self.servos = []
        self.start("--device", "sim:premium15", "--device", "left=sim:cartesian3")

    def start(self, *words):
        servo = subprocess.Popen([self.knurld, *words], env=self.environment, stdout=subprocess.PIPE,
                                 stderr=subprocess.DEVNULL, text=True)
        self.servos.append(servo)
        if not any("ready" in line for line in servo.stdout):
            raise SystemExit("knurld did not start")

    def stop(self):
        for servo in self.servos:
            servo.send_signal(signal.SIGTERM)
            servo.wait()

    def said(self, *words, codes=(0,)):
        return self.told(self.knurl, *words, codes=codes)

    def told(self, *words, codes=(0,)):
        done = subprocess.run(words, env=self.environment, capture_output=True, text=True, check=False)
        if done.returncode not in codes:
            raise SystemExit(f"{' '.join(words)}: exit code {done.returncode}: {done.stderr}")
        return done.stdout

    def beside(self, *words):
        return subprocess.Popen([self.knurl, *words], env=self.environment, stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE, text=True)


def hill(path):
    """A PGM of 24 x 24 heights."""
    heights = [30000 - 50 * ((r - 12) ** 2 + (c - 12) ** 2) for r in range(24) for c in range(24)]
    path.write_bytes(b"P5\n24 24\n65535\n" + struct.pack(f">{24 * 24}H", *heights))


def simulation():
    """The address of one of eight atoms at rest, which lasts until its reader goes (IMD, version 2)."""
    listener = socket.create_server(("127.0.0.1", 0))
    frame = struct.pack(">ii", 1, 1) + struct.pack("=i9f", 10, 300, *[0] * 8) + struct.pack(">ii", 2, 8)
    frame += struct.pack("=24f", *[3.0 * (atom >> axis & 1) for atom in range(8) for axis in range(3)])

    def serve():
        reader, _ = listener.accept()
        reader.settimeout(0.02)
        try:
            reader.sendall(struct.pack(">i", 4) + struct.pack("=i", 2))
            while True:
                try:
                    if not reader.recv(4096):
                        return
                except TimeoutError:
                    pass
                reader.sendall(frame)
        except OSError:
            return

    threading.Thread(target=serve, daemon=True).start()
    return f"127.0.0.1:{listener.getsockname()[1]}"


def check_domain(programs, check, tried):
    """What knurl-dds announces; it is an optional part of the build."""
    program = Path(programs.knurl).resolve().parent.parent / "knurl-dds" / "knurl-dds"
    if not program.exists():
        print("no knurl-dds was built: domain.schema.json is not checked")
        tried.add("domain")
        return
    domain = str(1 + os.getpid() % 99)
    with subprocess.Popen([program, "--domain", domain, "--name", "lab"], env=programs.environment, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True) as dds:
        dds.stdout.readline()
        try:
            for _ in range(100):  # looks, each a run of a program
                text = programs.said("ls", "--domain", domain, "--json")
                if '"running"' in text:
                    break
            check("domain", text)
            check("domain", programs.said("top", "--domain", domain, "--json", "--count", "1"))
            if '"running"' not in text:
                raise SystemExit(f"knurl-dds does not announce the servo: {text}")
        finally:
            dds.send_signal(signal.SIGTERM)


def main():
    folder_of_schemas, knurl, knurld, arm, surface, dock = sys.argv[1:]
    schemas = {path.name.removesuffix(".schema.json"): json.loads(path.read_text())
               for path in Path(folder_of_schemas).glob("*.schema.json")}
    bad = rules_broken(schemas)
    tried = set()

    def check(name, text):
        tried.add(name)
        bad.extend(f"{name}: {fault}" for fault in faults(json.loads(text), schemas[name], schemas[name]))

    with tempfile.TemporaryDirectory(prefix="knurl-json-") as folder:
        programs = Programs(knurl, knurld, folder)
        try:
            with open(f"{folder}/dead.sock", "wb"):
                pass  # a file that is no socket: nobody listens there
            run = f"{folder}/latency.json"
            check("latency", programs.said("latency", "--updates", "40", "--percentile", "60", "--json"))
            recorder = programs.beside("record", "--device", "left", f"{folder}/r.mcap")
            recorder.stderr.readline()
            programs.said("latency", "--connect", "knurl:default", "--device", "left", "--updates", "40", "--json", run)
            check("latency", Path(run).read_text())
            check("latency", programs.said("latency", "--updates", "40", "--json", "--compare", run))
            check("ls", programs.said("ls", "--json", codes=(0, 1)))
            for line in programs.said("top", "--json", "--count", "2", "--rate", "20").splitlines():
                check("top", line)
            recorder.send_signal(signal.SIGINT)
            recorder.communicate()
            check_domain(programs, check, tried)
            check("doctor", programs.said("doctor", "--seconds", "5", "--json", codes=(0, 1)))
            check("devices", programs.said("devices", "--json", codes=(0, 1)))
            check("device-check", programs.said("device", "check", arm, "--json"))
            if "device-test" in schemas:
                check("device-test", programs.said("device", "test", "sim:premium15", "--virtual", "--json", codes=(0, 1)))
            model, stroke, out = (f"{folder}/{name}" for name in ("hill.pgm", "stroke.csv", "out.json"))
            hill(Path(model))
            programs.told(surface, model, "--write-stroke", stroke, "--speed", "0.3")
            programs.start("--name", "stroked", "--device", "sim:premium15", "--hand", stroke)
            programs.told(surface, model, "--servo", "stroked", "--ways", "planes,force", "--json", out, codes=(0, 1))
            check("surface", Path(out).read_text())
            programs.told(dock, simulation(), "--device", "left", "--at-once", "--seconds", "0.5", "--json", out)
            check("dock", Path(out).read_text())
        finally:
            programs.stop()
        bad.extend(f"{name}: nobody printed it" for name in schemas.keys() - tried)
    for line in bad:
        print(line, file=sys.stderr)
    print(f"{len(tried)} programs checked against {len(schemas)} schemas")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
