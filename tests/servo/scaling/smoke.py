#!/usr/bin/python3
"""A short run of knurl_bench_scaling: smoke.py PROGRAM PLOT. Every axis is there and has its law; times are not judged."""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

SERIES = {
    "clients.idle.warm": 128, "clients.idle.cold": 128, "clients.silent.warm": 128, "clients.silent.cold": 128,
    "clients.silent.alone": 128, "clients.empty_batch.warm": 128, "clients.sending.warm": 128, "clients.sending.cold": 128,
    "readers.of_the_ring": 127, "readers.in_the_table": 127,
    "representations.planes.far": 1024, "representations.planes.near": 1024, "representations.spheres.far": 1024,
    "representations.springs": 1024, "scene.spheres.near": 10000, "scene.spheres.far": 10000, "devices": 8,
    "updates.to_10_kHz": 10000, "updates.merged": 10000, "servo_rate": 20000,
}
LAWS = {"O(1)", "O(log n)", "O(n)", "O(n log n)", "O(n^p)"}


def check(condition, what):
    if not condition:
        sys.exit(f"knurl_bench_scaling: {what}")


def main(program, plot):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "scaling.json"
        done = subprocess.run([program, "--quick", "--seed", "7", "--json", path], capture_output=True, text=True)
        check(done.returncode == 0, f"exit status {done.returncode}: {done.stderr}")
        check("seed 7" in done.stdout, "its seed is not printed")
        run = json.loads(path.read_text())
        scaling = run["scaling"]
        found = {series["name"]: series for series in scaling["series"]}
        check(found.keys() == SERIES.keys(), f"other series than asked for: {found.keys() ^ SERIES.keys()}")
        for name, series in found.items():
            values = [point["n"] for point in series["points"]]
            check(values == sorted(set(values)) and values[-1] == SERIES[name], f"{name}: values {values}")
            check(all(0 < p["p25"] <= p["p50"] <= p["p75"] for p in series["points"]), f"{name}: no times")
            law = series["law"]
            check(law["growth"] in LAWS and law["text"].startswith("O(") and law["base"] >= 0 and law["factor"] >= 0
                  and math.isfinite(law["base"] + law["factor"] + law["off"]), f"{name}: no law: {law}")
            # Three blocks are no ground for intervals, nor for a verdict.
            check(law["factor_interval"] is None and series["verdict"] == "undecided", f"{name}: more is said than known")
        check(len(scaling["goals"]) == 9 and all(g["verdict"] == "undecided" for g in scaling["goals"]), "goals")
        names = {result["name"] for result in run["results"]}
        for result in run["results"]:
            check(len(result["samples"]) == scaling["blocks"], f"{result['name']}: not a figure for each block")
            check(result["reference"] is None or result["reference"] in names, f"{result['name']}: no reference")
        picture = pathlib.Path(folder) / "scaling.png"
        subprocess.run([plot, path, picture], check=True)
        check(picture.read_bytes()[:4] == b"\x89PNG", "no picture")
    for words in (["--slow"], ["--seed"], ["client"]):
        done = subprocess.run([program, *words], capture_output=True, text=True)
        check(done.returncode == 2 and done.stderr.count("\n") == 1 and words[0] in done.stderr, f"{words}: {done.stderr}")


if __name__ == "__main__":
    main(*sys.argv[1:])
