// The parts of the page that need no browser, bundled as they are for the page and called from node.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, resolve } from "node:path";
import { after, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";

const here = dirname(fileURLToPath(import.meta.url));
const page = resolve(here, "../../apps/knurl-web/page");
const need = createRequire(resolve(page, "package.json"));
const { readKinds } = await import(pathToFileURL(resolve(page, "mock/kinds.mjs")).href);
const kinds = new Map(readKinds(resolve(page, "../../../docs/reference/representations.md")).map((kind) => [kind.name, kind]));

const folder = mkdtempSync(resolve(tmpdir(), "knurl-page-"));
after(() => rmSync(folder, { recursive: true }));
/** A module of the page. */
async function load(name) {
  const out = resolve(folder, `${name.replaceAll("/", "_")}.mjs`);
  await need("esbuild").build({ entryPoints: [resolve(page, `src/${name}.ts`)], bundle: true, format: "esm", platform: "node", outfile: out, logLevel: "warning" });
  return import(pathToFileURL(out).href);
}
const { ServoClock } = await load("clock");
const { decodeBinary, decodeAsset, num, stateName } = await load("protocol");
const { History } = await load("history");
const { buzzOf, buzzAt, buzzSentence, energyInto, fft } = await load("spectrum");
const { CdrLayout } = await load("cdr");
const { toToml, toCpp, toPython } = await load("code_export");
const { readRecording } = await load("mcap");
const { faultOf, faultsOf, faultNames } = await load("faults");

test("a binary message of reports", () => {
  const bytes = new ArrayBuffer(24 + 2 * 56);
  const view = new DataView(bytes);
  [1, 3, 2, 0].forEach((word, k) => view.setUint32(4 * k, word, true));
  view.setFloat64(16, 12345.5, true);
  for (let k = 0; k < 28; k++) view.setFloat32(24 + 4 * k, k / 4, true);
  const reports = decodeBinary(bytes);
  assert.deepEqual([reports.device, reports.count, reports.t], [3, 2, 12345.5]);
  assert.equal(reports.data[14], 3.5);
  assert.throws(() => decodeBinary(bytes.slice(0, 100)), /says 2 reports and has 76 bytes/);
  assert.throws(() => decodeBinary(new ArrayBuffer(8)), /shorter than its head/);
  view.setUint32(0, 9, true);
  assert.throws(() => decodeBinary(bytes), /kind 9/);
});

test("a mesh, and one that names a vertex that is not there", () => {
  const bytes = new ArrayBuffer(8 + 36 + 12);
  new Uint32Array(bytes, 0, 2).set([3, 1]);
  new Float32Array(bytes, 8, 9).set([0, 0, 0, 1, 0, 0, 0, 1, 0]);
  new Uint32Array(bytes, 44, 3).set([0, 1, 2]);
  assert.deepEqual([...decodeAsset(bytes).indices], [0, 1, 2]);
  new Uint32Array(bytes, 44, 3).set([0, 1, 3]);
  assert.throws(() => decodeAsset(bytes), /vertex 3 of 3/);
  assert.throws(() => decodeAsset(bytes.slice(0, 40)), /3 vertices/);
});

test("numbers that JSON has not, and states", () => {
  assert.equal(num("inf"), Infinity);
  assert.equal(num("automatic", -1), -1);
  assert.equal(stateName(4), "active");
  assert.equal(stateName("ramp_up"), "ramp up");
});

/** `seconds` of reports at `rate`: row(t) gives 13 numbers. */
function history(seconds, rate, row, capacity = 1 << 15) {
  const out = new History(capacity);
  for (let k = 0; k < seconds * rate; k++) out.push(100 + k / rate, row(k / rate));
  return out;
}

test("a Fourier transform against its definition", () => {
  const n = 64;
  const re = Float64Array.from({ length: n }, (_, k) => Math.sin(k * k));
  const im = Float64Array.from({ length: n }, (_, k) => Math.cos(3 * k) / 3);
  const [a, b] = [re.slice(), im.slice()];
  fft(a, b);
  for (let f = 0; f < n; f++) {
    let [x, y] = [0, 0];
    for (let k = 0; k < n; k++) {
      const angle = (-2 * Math.PI * f * k) / n;
      x += re[k] * Math.cos(angle) - im[k] * Math.sin(angle);
      y += re[k] * Math.sin(angle) + im[k] * Math.cos(angle);
    }
    assert.ok(Math.abs(a[f] - x) < 1e-10 && Math.abs(b[f] - y) < 1e-10);
  }
});

test("a buzz: its frequency and amplitude, whatever the rate", () => {
  for (const rate of [500, 1000, 4000])
    for (const [f, mm] of [[84, 0.12], [31.3, 0.5], [150.7, 0.03]]) {
      const w = 2 * Math.PI * f;
      const h = history(3, rate, (t) => [0, 0, 0, 0.6 * mm * 1e-3 * w * Math.cos(w * t), 0, 0.8 * mm * 1e-3 * w * Math.cos(w * t), 0, 0, 0, 30, 40, 0, 4], 1 << 14);
      const buzz = buzzAt(h);
      assert.ok(Math.abs(buzz.frequency - f) < 0.5, `${f} Hz was found at ${buzz.frequency}`);
      assert.ok(Math.abs(buzz.amplitude * 1e3 / mm - 1) < (rate > 500 ? 0.05 : f > 100 ? 0.3 : 0.1), `${mm} mm was found as ${buzz.amplitude * 1e3} (${f} Hz, rate ${rate})`);
      assert.ok(buzz.buzzes);
    }
});

test("no buzz where the hand moves, or rests", () => {
  const stroke = history(3, 1000, (t) => [0, 0, 0, 0.15 * Math.cos(6 * t), 0.1 * Math.sin(11 * t), 0, 0, 0, 0, 0, 0, 0, 4]);
  assert.equal(buzzAt(stroke).buzzes, false);
  let seed = 1;
  const noise = () => ((seed = (seed * 16807) % 2147483647) / 2147483647 - 0.5) * 0.004;
  assert.equal(buzzAt(history(3, 1000, () => [0, 0, 0, noise(), noise(), noise(), 0, 0, 0, 0, 0, 0, 4])).buzzes, false);
  assert.equal(buzzAt(history(0.2, 1000, () => Array(13).fill(0))), null);
  assert.equal(buzzOf([new Float64Array(1024)], 1000).buzzes, false);
});

test("what is said of a buzz", () => {
  const buzz = { frequency: 84, amplitude: 0.12e-3, slow: 0, share: 1, buzzes: true };
  const calm = { kMax: 3105, stiffest: 800, late: 0, forced: true, vibrations: [], textured: false };
  assert.match(buzzSentence(buzz, calm), /^The hand buzzes: 0\.12 mm at 84 Hz\. A stiffness above the device's k_max \(3105 N\/m\)/);
  assert.match(buzzSentence(buzz, { ...calm, stiffest: 5000 }), /asks for 5000 N\/m, more than/);
  assert.match(buzzSentence(buzz, { ...calm, late: 7 }), /7 late cycles/);
  assert.match(buzzSentence(buzz, { ...calm, vibrations: [85] }), /^The hand vibrates.*as a vibration of 85 Hz asks for/);
  assert.match(buzzSentence(buzz, { ...calm, forced: false }), /^The hand shakes.*no force of the device is on/);
  assert.equal(buzzSentence({ ...buzz, buzzes: false }, calm), "");
  assert.equal(buzzSentence(null, calm), "");
});

test("energy into the hand is the work of the force", () => {
  // F = 2 N along x, v = 0.1 m/s: 0.2 W.
  const h = history(12, 1000, (t) => [0.1 * t, 0, 0, 0.1, 0, 0, 2, 0, 0, 0, 0, 0, 4]);
  assert.ok(Math.abs(energyInto(h, 10) - 2) < 1e-3);
  // A spring whose force is held for a cycle gives k / 2 dx^2 in each; none is lost in the sum.
  const x = (t) => 0.01 * Math.sin(2 * Math.PI * t);
  const spring = history(12, 1000, (t) => [x(t), 0, 0, 0, 0, 0, -100 * x(t), 0, 0, 0, 0, 0, 4]);
  let held = 0;
  for (let k = 1999; k < 11999; k++) held += 50 * (x((k + 1) / 1000) - x(k / 1000)) ** 2;
  assert.ok(Math.abs(energyInto(spring, 10) - held) < 2e-5, `${energyInto(spring, 10)} J in place of ${held} J`);
  // A hole of a second says nothing.
  const hole = new History(64);
  for (const t of [0, 0.01, 1.01, 1.02]) hole.push(t, [t, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 4]);
  assert.ok(Math.abs(energyInto(hole, 10) - 0.02) < 1e-6);
});

test("a ring: thinned without losing a peak, found by time, as CSV", () => {
  const h = history(40, 1000, (t) => [Math.abs(t - 33.333) < 5e-4 ? 1 : 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4], 1 << 14);
  assert.equal(h.held, 1 << 14);
  assert.ok(Math.abs(h.first - (140 - 16.384)) < 2e-3);
  const thin = h.thin(130, 140, 100, ["px"]);
  assert.ok(thin.t.length <= 2 * 102 && thin.t.every((t, k) => k === 0 || t > thin.t[k - 1]));
  assert.equal(Math.max(...thin.values[0]), 1);
  assert.equal(h.t[h.place(h.find(135))].toFixed(3), "135.000");
  const csv = h.csv(139, 139.0095).trim().split("\n");
  assert.equal(csv.length, 11);
  assert.match(csv[0], /^t \[s\],px \[m\],/);
  assert.match(csv[1], /^139\.000000,0,0/);
  h.push(1, Array(13).fill(0)); // a servo that was started anew
  assert.equal(h.held, 1);
});

test("CDR by a ros2msg schema, with its alignment", () => {
  const layout = new CdrLayout("uint8 a # first\nfloat64 b\nfloat32[3] c\ngeometry_msgs/Vector3 p\nuint64 last\n====\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n");
  assert.deepEqual(layout.places.get("b").offset, 8);
  assert.deepEqual(layout.places.get("p.y").offset, 40);
  assert.equal(layout.size, 64);
  const view = new DataView(new ArrayBuffer(68));
  view.setFloat64(4 + 40, 2.5, true);
  view.setFloat32(4 + 20, 1.5, true);
  assert.equal(layout.reader("p.y")(view), 2.5);
  assert.equal(layout.reader("c", 1)(view), 1.5);
  assert.throws(() => layout.reader("q"), /without q/);
  assert.throws(() => new CdrLayout("string name\n"), /type string/);
});

const scene = {
  kinds, device: "right", probes: [[0, [0, 0, 0], 0.005]], assets: [{ number: 3, file: "bunny.stl", unit: "mm" }],
  items: [
    { kind: "plane", slot: 0, probe: 0, params: { normal: [0, 0, 1], offset: 0.005, stiffness: "inf", "friction.dynamic": 0.3, update: "paper", recovery: "automatic" } },
    { kind: "plane", slot: 1, probe: 0, params: { stiffness: 400 } },
    { kind: "shape", slot: 2, probe: 2, params: { asset: 3, stiffness: 800, position: [0, 0, 0.02] } },
    { kind: "polygon", slot: 3, probe: 0, params: { vertices: [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]], stiffness: 500 } },
    { kind: "taylor", slot: 4, probe: 0, params: { jacobian: [[-50, 0, 0], [0, -50, 0], [0, 0, -50]] } },
    { kind: "box", slot: 5, probe: 0, params: { side: "inside", stiffness: 500 } },
  ],
};
test("export as TOML", () => {
  const text = toToml(scene);
  assert.match(text, /\[\[probe\]\]\noffset = \[0, 0, 0\]\nradius = 0\.005/);
  assert.match(text, /\[\[plane\]\]\nid = "plane"\noffset = 0\.005\nupdate = "paper"\nstiffness = inf\nfriction\.dynamic = 0\.3\n/);
  assert.match(text, /id = "plane_2"\nstiffness = 400\n/);
  assert.match(text, /\[\[asset\]\].*\nmesh = "bunny.stl"\nunit = "mm"/);
  assert.match(text, /\[\[shape\]\]\nid = "shape"\nprobe = 2\nasset = 1\n/);
  assert.match(text, /vertices = \[\[0, 0, 0\], \[0\.1, 0, 0\], \[0, 0\.1, 0\]\]/);
  assert.match(text, /jacobian = \[\[-50, 0, 0\], \[0, -50, 0\], \[0, 0, -50\]\]/);
});
test("export as C++ and Python", () => {
  const cpp = toCpp(scene);
  assert.match(cpp, /plane\.update = knurl::PlaneUpdate::paper;/);
  assert.match(cpp, /plane\.stiffness = std::numeric_limits<double>::infinity\(\);/);
  assert.match(cpp, /polygon\.vertices = \{\.at = \{\{0, 0, 0\}, \{0\.1, 0, 0\}, \{0, 0\.1, 0\}\}, \.count = 3\};/);
  assert.match(cpp, /taylor\.jacobian = \{\.at = \{-50, 0, 0, 0, -50, 0, 0, 0, -50\}\};/);
  assert.match(cpp, /hand\.add\(shape, \{\.probe = 2\}\)/);
  const python = toPython(scene);
  assert.match(python, /plane = knurl\.Plane\(offset=0\.005, update="paper", stiffness=knurl\.INFINITY\)/);
  assert.match(python, /plane\.friction\.dynamic = 0\.3/);
  assert.match(python, /box = knurl\.Box\(side="inside", stiffness=500\.0\)/);
});

// Every field of every kind with another value than its default, so that the export writes it.
function everyField() {
  const other = (field) => {
    if (field.type === "choice") return field.choices.find((choice) => choice !== field.default);
    if (field.type === "quaternion") return [0.5, 0.5, 0.5, 0.5];
    if (field.type === "vector") return [0.1, 0.2, 0.3];
    if (field.type === "matrix") return Array(field.count === 6 || field.count === 36 ? 36 : 9).fill(0.5);
    if (field.type === "points") return [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]];
    return field.default === 1 ? 2 : 1;
  };
  const items = [...scene.kinds.values()].map((kind, slot) => ({ kind: kind.name, slot, probe: slot % 2, params: Object.fromEntries(kind.fields.map((field) => [field.name, other(field)])) }));
  return { ...scene, items, probes: [[1, [0, 0, 0.01], 0.002]], assets: [] };
}
test("the exported C++ compiles, with every field of every kind", { skip: process.env.KNURL_CXX ? false : "KNURL_CXX and KNURL_INCLUDES name a compiler and Knurl's headers in ctest" }, () => {
  const all = everyField();
  assert.ok(all.items.length >= 19);
  const cpp = toCpp(all);
  const includes = process.env.KNURL_INCLUDES.split(":").filter(Boolean).map((folder) => `-I${folder}`);
  const run = spawnSync(process.env.KNURL_CXX, ["-std=c++20", "-Wall", "-Wextra", "-fsyntax-only", ...includes, "-x", "c++", "-"], { input: cpp, encoding: "utf8" });
  assert.equal(run.status, 0, `${run.stderr}\n${cpp}`);
  const python = spawnSync("python3", ["-c", "import ast, sys; ast.parse(sys.stdin.read())"], { input: toPython(all), encoding: "utf8" });
  assert.equal(python.status, 0, python.stderr);
});

test("faults by bit, each with a remedy", () => {
  assert.deepEqual(faultsOf(0b100000000010), ["slew", "unguarded"]);
  for (const name of faultNames) assert.ok(faultOf(name).remedy.length > 5 && !faultOf(name).cause.includes("does not know"), name);
  assert.match(faultOf("nonsense").cause, /does not know/);
  // The names are those of the code.
  const header = readFileSync(resolve(here, "../../runtime/protocol/include/knurl/protocol/report.hpp"), "utf8");
  const bits = [...header.matchAll(/constexpr std::uint32_t (\w+) = 1u << (\d+)/g)].slice(0, faultNames.length).map(([, name]) => name.replaceAll("_", " "));
  assert.deepEqual(bits, faultNames);
});

test("the age of what is drawn, by a clock that is 100 s ahead", () => {
  const clock = new ServoClock();
  clock.drawn(100, 1);
  assert.deepEqual(clock.age, { p50: 0, p99: 0, within: 0 }, "nothing is said before the clocks are compared");
  clock.take(1, 1.2, 101.2); // slow, and off by 100 ms
  clock.take(2, 2.002, 102.001);
  clock.take(3, 3.05, 103.05);
  for (let k = 0; k < 100; k++) clock.drawn(110 + k / 60, 10 + k / 60 + 0.008);
  clock.drawn(110 + 99 / 60, 20);
  const { p50, p99, within } = clock.age;
  assert.ok(Math.abs(p50 - 8) < 1e-3 && Math.abs(p99 - 8) < 1e-3 && Math.abs(within - 1) < 1e-9, JSON.stringify(clock.age));
});

test("a recording of knurl record", async () => {
  const recorded = await readRecording(new Uint8Array(readFileSync(resolve(here, "wall.mcap"))));
  assert.ok(recorded.history.held > 500, `${recorded.history.held} reports`);
  assert.ok(Math.abs(recorded.period - 1e-3) < 1e-9);
  assert.equal(recorded.metadata.get("device"), "right");
  assert.deepEqual(recorded.notes, []);
  const { pz, fz, state } = recorded.history.columns;
  assert.ok(pz.some((z) => z < 0.005) && fz.some((f) => f > 0.3), "it pressed on the wall");
  assert.ok(state.some((s) => s === 4));
  // Its scenes: what the page is told live, and the mesh.
  const told = recorded.scenes.map(({ text }) => JSON.parse(text));
  assert.equal(told[0].op, "servo");
  assert.equal(told[0].devices[0].name, "right");
  assert.ok(told[1].op === "scene" && told[1].full);
  const kinds = new Set(told.flatMap((one) => (one.op === "scene" ? one.items.map((item) => item.kind) : [])));
  assert.deepEqual([...kinds].sort(), ["plane", "shape"]);
  assert.ok(told.some((one) => one.op === "felt" && one.items.length) && told.some((one) => one.op === "arm" && one.points.length > 2));
  const times = recorded.scenes.map(({ t }) => t);
  assert.ok(times.every((t, k) => t >= 0 && t <= recorded.history.last + 0.1 && (k === 0 || t >= times[k - 1])));
  assert.deepEqual([...recorded.meshes.values()].map((mesh) => decodeAsset(mesh).indices.length), [36]);
  const q = recorded.more.subarray(0, 4);
  assert.ok(Math.abs(Math.hypot(...q) - 1) < 1e-5);
});
test("a recording that was cut off, changed, or is none", async () => {
  const whole = new Uint8Array(readFileSync(resolve(here, "wall.mcap")));
  // What is complete is shown: here the one chunk, without the index behind it.
  const cut = await readRecording(whole.subarray(0, whole.length - 300));
  assert.ok(cut.history.held > 500 && cut.notes.length === 1);
  await assert.rejects(readRecording(whole.subarray(0, Math.round(whole.length * 0.3))), /cut off before/);
  await assert.rejects(readRecording(new Uint8Array(100)), /no MCAP file/);
  await assert.rejects(readRecording(whole.subarray(0, 40)));
  // Whatever byte is changed: reports or one line, never a hang.
  let seed = 7;
  for (let k = 0; k < 40; k++) {
    seed = (seed * 16807) % 2147483647;
    const changed = whole.slice();
    changed[seed % changed.length] ^= 1 << (seed % 8);
    try {
      await readRecording(changed);
    } catch (error) {
      assert.ok(error instanceof Error && error.message.length > 0);
    }
  }
});
