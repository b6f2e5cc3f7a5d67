// A scene as text: TOML for knurl eval, a program in C++, a program in Python. Only what differs from its default is written.
import type { Field, Item, Kind, Params, Value } from "./protocol.ts";

export interface ExportedAsset {
  number: number;
  file: string; // "": not from a file that this page knows
  unit: string;
}
export interface Exported {
  kinds: Map<string, Kind>;
  items: Pick<Item, "kind" | "params" | "probe" | "slot">[];
  assets: ExportedAsset[];
  probes: [number, [number, number, number], number][];
  device: string;
}

/** The shortest digits of a number, without the noise of a sum; TOML, C++ and Python alike. */
export function digits(value: number): string {
  const text = String(+value.toPrecision(9));
  return text === "-0" ? "0" : text;
}
function real(text: string): string {
  return /[.e]/.test(text) ? text : `${text}.0`;
}

export function differs(value: Value | undefined, fallback: Value): boolean {
  if (value === undefined) return false;
  const flat = (v: Value) => (Array.isArray(v) ? (v as number[]).flat() : [v]);
  const a = flat(value);
  const b = flat(fallback);
  return a.length !== b.length || a.some((entry, k) => (typeof entry === "number" && typeof b[k] === "number" ? Math.abs(entry - (b[k] as number)) > 1e-12 * Math.max(1, Math.abs(entry)) : entry !== b[k]));
}

/** Names: floor, plane2, spring. */
export function namesOf(items: Pick<Item, "kind">[]): string[] {
  const seen = new Map<string, number>();
  return items.map(({ kind }) => {
    const n = (seen.get(kind) ?? 0) + 1;
    seen.set(kind, n);
    return n === 1 ? kind : `${kind}_${n}`;
  });
}

function chosen(kind: Kind | undefined, params: Params): [Field, Value][] {
  return (kind?.fields ?? []).filter((field) => differs(params[field.name], field.default)).map((field) => [field, params[field.name]]);
}
/** Rows of a matrix, whether it came flat or by rows. */
function matrix(field: Field, value: Value): number[][] {
  const flat = (value as number[]).flat() as number[];
  const n = field.count === 36 || flat.length === 36 ? 6 : 3;
  return Array.from({ length: n }, (_, row) => flat.slice(row * n, row * n + n));
}

// ---- TOML

function toml(field: Field, value: Value): string {
  const list = (numbers: number[]) => `[${numbers.map(digits).join(", ")}]`;
  if (typeof value === "string") return value === "inf" || value === "-inf" ? value : JSON.stringify(value);
  if (typeof value === "number") return digits(value);
  if (field.type === "matrix") return `[${matrix(field, value).map(list).join(", ")}]`;
  if (field.type === "points") return `[${(value as number[][]).map(list).join(", ")}]`;
  return list(value as number[]);
}

export function toToml(scene: Exported): string {
  const out = ["# A scene of Knurl, for `knurl eval --scene` and `knurl replay --scene`. Lengths in m, forces in N.", ""];
  const probes = [...scene.probes].sort((a, b) => a[0] - b[0]);
  const most = Math.max(-1, ...probes.map(([number]) => number));
  for (let number = 0; number <= most; number++) {
    const probe = probes.find(([n]) => n === number);
    out.push("[[probe]]", `offset = [${(probe?.[1] ?? [0, 0, 0]).map(digits).join(", ")}]`, `radius = ${digits(probe?.[2] ?? 0)}`, "");
  }
  const numbers = new Map<number, number>();
  for (const item of scene.items) {
    const asset = item.params.asset;
    if (typeof asset === "number" && asset > 0 && !numbers.has(asset)) numbers.set(asset, numbers.size + 1);
  }
  for (const [number, mine] of numbers) {
    const asset = scene.assets.find((known) => known.number === number);
    out.push(`[[asset]]  # asset ${mine}`, `mesh = ${JSON.stringify(asset?.file || "PUT-THE-FILE-HERE.stl")}`, `unit = ${JSON.stringify(asset?.unit ?? "m")}`, "");
  }
  const names = namesOf(scene.items);
  scene.items.forEach((item, k) => {
    out.push(`[[${item.kind}]]`, `id = ${JSON.stringify(names[k])}`);
    if (item.probe) out.push(`probe = ${item.probe}`);
    for (const [field, value] of chosen(scene.kinds.get(item.kind), item.params))
      out.push(`${field.name} = ${field.name === "asset" ? (numbers.get(value as number) ?? 0) : toml(field, value)}`);
    out.push("");
  });
  return out.join("\n");
}

// ---- C++

function camel(name: string): string {
  return name.replace(/(?:^|_)(\w)/g, (_, letter: string) => letter.toUpperCase());
}
const enums: Record<string, string> = {
  update: "PlaneUpdate", combine: "PlaneCombine", side: "Side", sides: "Sides", edge: "TaylorEdge", shape: "ConstraintShape",
  shading: "Shading", "snag.law": "SnagLaw", "texture.pattern": "TexturePattern",
};
/** C++ and Python have `static` as static_. */
function member(name: string): string {
  return name.replace(/(^|\.)static$/, "$1static_");
}
function cpp(field: Field, value: Value): string {
  const list = (numbers: number[]) => `{${numbers.map(digits).join(", ")}}`;
  if (field.type === "choice") return `knurl::${enums[field.name] ?? camel(field.name)}::${String(value)}`;
  if (value === "inf") return "std::numeric_limits<double>::infinity()";
  if (value === "-inf") return "-std::numeric_limits<double>::infinity()";
  if (value === "automatic") return "knurl::automatic";
  if (typeof value === "number") return digits(value);
  if (field.type === "matrix") return `{.at = ${list(matrix(field, value).flat())}}`;
  if (field.type === "points") return `{.at = {${(value as number[][]).map(list).join(", ")}}, .count = ${(value as number[][]).length}}`;
  return list(value as number[]);
}

export function toCpp(scene: Exported): string {
  const names = namesOf(scene.items).map((name) => (name === "union" ? "union_" : name));
  const out = [
    "#include <chrono>", "#include <cstdio>", "#include <limits>", "#include <thread>", "", "#include <knurl/client/client.hpp>", "#include <knurl/reps/all.hpp>", "",
    "using namespace std::chrono_literals;", "", "int main() try {",
    `    auto client = knurl::Client::connect("knurl:default");`,
    `    auto hand = client.claim(${JSON.stringify(scene.device)});`,
  ];
  for (const [number, offset, radius] of scene.probes) out.push(`    hand.place_probe(${number}, {.offset = {${offset.map(digits).join(", ")}}, .radius = ${digits(radius)}});`);
  scene.items.forEach((item, k) => {
    out.push("", `    knurl::${camel(item.kind)} ${names[k]};`);
    for (const [field, value] of chosen(scene.kinds.get(item.kind), item.params)) {
      if (field.name === "asset") {
        const file = scene.assets.find((asset) => asset.number === value)?.file;
        out.push(`    // ${names[k]}.asset = hand.send(knurl::Triangles{...}).asset;  // the mesh${file ? ` of ${file}` : ""}, read by your program`);
      } else out.push(`    ${names[k]}.${member(field.name)} = ${cpp(field, value)};`);
    }
    out.push(`    auto ${names[k]}_handle = hand.add(${names[k]}${item.probe ? `, {.probe = ${item.probe}}` : ""});`);
  });
  out.push(
    "", "    hand.arm();  // force may follow", "    while (auto frame = hand.newest(1s)) {",
    "        hand.commit();  // with HANDLE.set(...) before: one cycle, all of it",
    '        std::printf("%+.2f mm, %.2f N\\n", frame->position.z * 1e3, frame->sent_force.z);', "        std::this_thread::sleep_for(16ms);", "    }",
    "} catch (const knurl::Error& error) {", '    return std::fprintf(stderr, "%s\\n", error.what()), 1;', "}", "",
  );
  return out.join("\n");
}

// ---- Python

function python(field: Field, value: Value): string {
  const list = (numbers: number[]) => `(${numbers.map(digits).join(", ")})`;
  if (value === "inf") return "knurl.INFINITY";
  if (value === "-inf") return "-knurl.INFINITY";
  if (value === "automatic") return "knurl.AUTOMATIC";
  if (typeof value === "string") return JSON.stringify(value);
  if (typeof value === "number") return field.type === "integer" ? digits(value) : real(digits(value));
  if (field.type === "matrix") return `(${matrix(field, value).map(list).join(", ")})`;
  if (field.type === "points") return `[${(value as number[][]).map(list).join(", ")}]`;
  return list(value as number[]);
}

export function toPython(scene: Exported): string {
  const names = namesOf(scene.items);
  const out = ["import knurl", "", `with knurl.connect() as client, client.claim(${JSON.stringify(scene.device)}) as hand:`];
  for (const [number, offset, radius] of scene.probes) out.push(`    hand.place_probe(${number}, offset=(${offset.map(digits).join(", ")}), radius=${digits(radius)})`);
  scene.items.forEach((item, k) => {
    const all = chosen(scene.kinds.get(item.kind), item.params);
    const own = all.filter(([field]) => !field.name.includes(".") && field.name !== "asset").map(([field, value]) => `${member(field.name)}=${python(field, value)}`);
    if (typeof item.params.asset === "number" && item.params.asset > 0) {
      const file = scene.assets.find((asset) => asset.number === item.params.asset)?.file ?? "the mesh";
      out.push(`    # sent_${names[k]} = hand.send_mesh(vertices, faces)  # ${file}, in m`);
      own.push(`# asset=sent_${names[k]}.asset`);
    }
    const comment = own.findIndex((entry) => entry.startsWith("#"));
    const last = comment >= 0 ? `  ${own.splice(comment, 1)[0]}` : "";
    out.push(`    ${names[k]} = knurl.${camel(item.kind)}(${own.join(", ")})${last}`);
    for (const [field, value] of all) if (field.name.includes(".")) out.push(`    ${names[k]}.${member(field.name)} = ${python(field, value)}`);
    out.push(`    ${names[k]} = hand.add(${names[k]}${item.probe ? `, probe=${item.probe}` : ""})`);
  });
  out.push("    hand.arm()", "    for report in hand.reports(rate=60):  # sends what has changed, each turn", '        print(f"{1e3 * report.position[2]:+.2f} mm, {report.sent_force[2]:.2f} N")', "");
  return out.join("\n");
}
