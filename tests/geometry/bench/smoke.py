#!/usr/bin/python3
"""A short run of knurl_bench_geometry, drawn: smoke.py PROGRAM PLOT. What is counted is judged, times are not."""

import json
import pathlib
import subprocess
import sys
import tempfile


def check(condition, what):
    if not condition:
        sys.exit(f"knurl_bench_geometry: {what}")


def main(program, plot):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "geometry.json"
        done = subprocess.run([program, "--short", "--most", "4000", "--json", path], capture_output=True, text=True)
        check(done.returncode == 0, f"exit status {done.returncode}: {done.stderr}")
        run = json.loads(path.read_text())
        points = {point["method"]: point for point in run["geometry"]["points"]}
        check(points.keys() == {"walk", "active set"}, f"methods {points.keys()}")
        for name, point in points.items():
            check(point["triangles"] == 3698 and point["cycles"] > 10000, f"{name}: {point}")
            check(0 < point["warm_p50"] <= point["warm_p99"], f"{name}: times {point}")
        walk = points["walk"]
        check(walk["error_p99"] < 1e-7 and walk["pop_throughs"] == 0 and walk["lost_share"] == 0, f"walk: {walk}")
        names = [result["name"] for result in run["results"]]
        for result in run["results"]:
            check(len(result["blocks"]) >= 30, f"{result['name']}: {len(result['blocks'])} blocks are too few to compare")
            check(result["reference"] is None or result["reference"] in names, f"{result['name']}: no reference")
        picture = pathlib.Path(folder) / "geometry.png"
        drawn = subprocess.run([plot, path, picture], capture_output=True, text=True)
        check(drawn.returncode == 0 and picture.stat().st_size > 10000, f"the plot: {drawn.stderr}")
        refused = subprocess.run([program, "--sort"], capture_output=True, text=True)
        check(refused.returncode == 2 and "--short" in refused.stderr, "an unknown word is not refused")


if __name__ == "__main__":
    main(*sys.argv[1:])
