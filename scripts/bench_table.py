#!/usr/bin/env python3
"""All results of scripts/bench as one Markdown table: bench_table.py FOLDER.

Google Benchmark's files (*.google.json) become the form that the other programs write, beside them: the
repetitions' median is p50, and each function is related to the reference that ran shuffled with it. All of them
together are all.json, for bench_compare.py."""

import datetime
import json
import pathlib
import platform
import re
import statistics
import sys

# What a function is measured against, by pattern; \1 is the size.
REFERENCES = [
    (r"(?:cold|warm|corner)/(\d+)", r"naive_sum/\1"),
    (r"(?:cartesian|three_axes|six_axes|seven_axes)", "three_sincos"),
    (r"cycle_.*", "read_and_kinematics"),
    (r"build/\w+_(\w+)", r"sort_keys/\1"),
    (r"(?:turning_)?meshes_out_of_reach/[1-9]\d*", "meshes_out_of_reach/0"),
]
# Of `knurl latency` through a bridge: what is not in the local run, or means something else there.
OF_THE_BRIDGE = re.compile(r"update\.remote_|report\.blocking_after|command\.|floor\.(udp|tcp|wake_and)_")


def reference_of(name, known):
    for pattern, reference in REFERENCES:
        if re.fullmatch(pattern, name):
            candidate = re.sub(f"^{pattern}$", reference, name)
            return candidate if candidate in known and candidate != name else None
    return None


def from_google(path, machine):
    data = json.loads(path.read_text())
    samples, lengths = {}, {}
    for run in data["benchmarks"]:
        if run["run_type"] == "iteration":
            name = re.sub(r"/(iterations|repeats):\d+", "", run["name"])
            samples.setdefault(name, []).append(run["cpu_time"])
            lengths.setdefault(name, []).append(run["cpu_time"] * run["iterations"])
    results = []
    for name, times in samples.items():
        reference = reference_of(name, samples)
        p50 = statistics.median(times)
        ratio = p50 / statistics.median(samples[reference]) if reference else None
        results.append({"name": name, "unit": "ns", "n": len(times), "p50": p50, "p99": None, "p999": None,
                        "max": max(times), "reference": reference, "ratio": ratio, "samples": times,
                        "repetition_ns": statistics.median(lengths[name])})
    context = data["context"]
    run = {"machine": dict(machine, load=str(context.get("load_avg", "")), date=context["date"]),
           "results": results}
    path.with_name(path.name.replace(".google.json", ".json")).write_text(json.dumps(run, indent=1) + "\n")


def this_machine(folder):
    for path in folder.glob("*.json"):
        if path.name == "all.json":  # of an earlier run
            continue
        data = json.loads(path.read_text())
        if "machine" in data:
            return data["machine"]
    return {"processor": platform.processor(), "cpus": None, "kernel": platform.release(), "load": "", "idle": "",
            "build": "", "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")}


def number(value):
    return "" if value is None else f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def programs_of(folder, machine):
    """What each program wrote there, in the one form."""
    for path in sorted(folder.glob("*.google.json")):
        from_google(path, machine)
    return {path.stem: json.loads(path.read_text()) for path in sorted(folder.glob("*.json"))
            if not path.name.endswith(".google.json") and path.name != "all.json"}


def main():
    if len(sys.argv) != 2 or not pathlib.Path(sys.argv[1]).is_dir():
        sys.exit("bench_table.py: name the folder that scripts/bench wrote, e.g. out/bench")
    folder = pathlib.Path(sys.argv[1])
    machine = this_machine(folder)
    programs = programs_of(folder, machine)
    print("\n" + ", ".join(f"{key}: {value}" for key, value in machine.items()))
    print("\n| program | what | unit | n | p50 | p99 | p99.9 | max | beside | ratio |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    laws, scaling_goals = [], []
    for program, run in programs.items():
        for r in run["results"]:
            if program.startswith("latency_bridge") and not OF_THE_BRIDGE.match(r["name"]):
                continue
            print(f"| {program} | {r['name']} | {r['unit']} | {r['n']} | {number(r['p50'])} | {number(r['p99'])} "
                  f"| {number(r['p999'])} | {number(r['max'])} | {r['reference'] or ''} | {number(r['ratio'])} |")
        for b in run.get("bounds", []):
            print(f"| {program} | {b['name']}: share within {number(b['limit'])} {b['unit']} | | {b['n']} | | | | "
                  f"| its floors' own {number(b['references_within'])} | {number(b['within'] / b['n'])} |")
        for v in run.get("verdicts", []):
            print(f"| {program} | {v['transport']}, p{number(v['percentile'])}: {v['verdict']} | | | | | | | Knurl "
                  f"| {number(v['to_knurl'])} ({number(v['low'])} to {number(v['high'])}) |")
        for g in run.get("goals", []):
            print(f"| {program} | {g['what']}, bound {number(g['bound'])}: {g['verdict']} | | | | | | | "
                  f"| {number(g['low'])} to {number(g['high'])} |")
        laws += run.get("scaling", {}).get("series", [])
        scaling_goals += run.get("scaling", {}).get("goals", [])
    if laws:
        print("\n| the cycle against | law, ns | by design | |\n|---|---|---|---|")
    for law in laws:
        print(f"| {law['name']} | {law['law']['text']} | {law['design']}: {law['why']} | {law['verdict']} |")
    for goal in scaling_goals:
        span = "" if goal["interval"] is None else f" [{number(goal['interval'][0])}, {number(goal['interval'][1])}]"
        print(f"| {goal['name']} | {number(goal['value'])}{span} {goal['unit']} | at most {number(goal['limit'])} | {goal['verdict']} |")
    (folder / "all.json").write_text(json.dumps(
        {"format": {"program": "scripts/bench", "version": 1}, "machine": machine, "programs": programs}) + "\n")


if __name__ == "__main__":
    main()
