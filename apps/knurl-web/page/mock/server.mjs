// A stand-in for knurl-web that speaks knurl.live.v1, with a hand of its own that presses on what is added: for work on the page
// and its tests. Its forces are rough (no friction, no solver); what a hand really feels is knurld's to say.
//
//     node mock/server.mjs [--port 8765] [--role control] [--bundle ../bundle]
//
// POST /mock?do=NAME makes something happen: plane, move, show, hundred, mesh, fault, buzz, calm, silent, away, down, drop, forget, garbage, note.
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { WebSocketServer } from "ws";
import { readKinds } from "./kinds.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const headers = {
  "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data: blob:; worker-src 'none'; base-uri 'none'; form-action 'none'",
  "X-Content-Type-Options": "nosniff",
  "Cache-Control": "no-store",
};

const add = (a, b) => a.map((x, k) => x + b[k]);
const sub = (a, b) => a.map((x, k) => x - b[k]);
const mul = (a, s) => a.map((x) => x * s);
const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
const len = (a) => Math.sqrt(dot(a, a));
const unit = (a) => mul(a, 1 / (len(a) || 1));

export class Mock {
  constructor(options = {}) {
    this.options = { port: 0, role: "control", bundle: resolve(here, "../../bundle"), devices: 1, speed: 1, ...options };
    this.kinds = readKinds(resolve(here, "../../../../docs/reference/representations.md"));
    this.reset();
    this.token = "mock";
    this.sockets = new Set();
  }

  reset() {
    this.pid = 4000 + Math.floor(Math.random() * 1000);
    this.time = 100;
    this.devices = Array.from({ length: this.options.devices }, (_, i) => ({
      info: {
        i, name: ["right", "left"][i] ?? `device${i}`, address: "sim:premium15", profile: "premium15", serial: `SIM${i}`, rate: 1000, centre: [0, 0, 0], radius: 0.1, peak_force: 8.5,
        peak_torque: 0.18, max_stiffness: 3105, damping: 0.5, lag: 0.0004, renders_torque: false, senses_orientation: true, pull: true,
      },
      p: [0, 0, 0.03], v: [0, 0, 0], f: [0, 0, 0], contact: [0, 0, 0], touching: false, state: 4, faults: [], cycle: 0, late: 0, pull: null, buzz: 0,
      claims: new Map(), items: new Map(), assets: new Map(), felt: [], fresh: [], changed: new Map(), gone: [], lateNow: 0,
    }));
    this.nextClaim = 1;
    for (const device of this.devices) this.claimOf(device, { name: "floor", pid: 5000 + device.info.i });
  }

  claimOf(device, { name, pid, socket = null, scale = 1 }) {
    for (const claim of device.claims.values()) if (claim.name === name && claim.socket === socket) return claim;
    const claim = {
      claim: this.nextClaim++, row: device.claims.size, name, pid, socket, silent: false, nextSlot: 0,
      frame: { scale, device_centre: [0, 0, 0], world_centre: [0, 0, 0], force_scale: 1 }, probes: [], commits: 0,
    };
    device.claims.set(claim.claim, claim);
    device.newClaims = true;
    return claim;
  }

  defaults(kind, params) {
    const table = this.kinds.find((entry) => entry.name === kind);
    if (!table) throw new Error(`kind = "${kind}" is not known; known are ${this.kinds.map((entry) => entry.name).join(", ")}`);
    const all = {};
    for (const field of table.fields) all[field.name] = structuredClone(field.default);
    for (const [name, value] of Object.entries(params ?? {})) {
      const field = table.fields.find((entry) => entry.name === name);
      if (!field) throw new Error(`${kind}.${name} is not known`);
      const numbers = [value].flat(2);
      for (const x of numbers)
        if (typeof x === "number" && (x < field.minimum || (field.maximum !== "inf" && x > field.maximum)))
          throw new Error(`${kind}.${name} = ${x} ${field.unit} is out of range; give ${field.minimum} to ${field.maximum}`);
      if (field.type === "choice" && !field.choices.includes(value)) throw new Error(`${kind}.${name} = "${value}" is no choice; choices are ${field.choices.join(", ")}`);
      all[name] = value;
    }
    return all;
  }
  put(device, claim, kind, params, probe = 0) {
    const slot = claim.nextSlot++;
    const item = { claim: claim.claim, slot, generation: 1, kind, params: this.defaults(kind, params), probe };
    device.items.set(`${claim.claim}:${slot}`, item);
    device.changed.set(`${claim.claim}:${slot}`, item);
    return item;
  }
  drop(device, claim, slot) {
    if (!device.items.delete(`${claim}:${slot}`)) throw new Error(`slot ${slot} is empty`);
    device.changed.delete(`${claim}:${slot}`);
    device.gone.push([claim, slot]);
  }
  release(device, claim) {
    for (const [key, item] of device.items) if (item.claim === claim.claim) device.items.delete(key), device.changed.delete(key);
    device.claims.delete(claim.claim);
    device.gone.push([claim.claim]);
  }

  // ---- physics

  force(device, item, p, v) {
    const q = item.params;
    const n = (x, fallback = 0) => (x === "inf" ? 1000 : typeof x === "number" ? x : fallback);
    const k = Math.min(n(q.stiffness), 3105);
    const push = (depth, normal, foot) => (depth > 0 ? { f: mul(normal, Math.max(0, k * depth - n(q.damping) * dot(v, normal))), contact: foot } : null);
    switch (item.kind) {
      case "plane": {
        const l = len(q.normal);
        const normal = mul(q.normal, 1 / l);
        const depth = q.offset / l - dot(normal, p);
        return push(depth, normal, add(p, mul(normal, depth)));
      }
      case "sphere": {
        const d = sub(p, q.center);
        const inside = q.side === "inside";
        const depth = inside ? len(d) - q.radius : q.radius - len(d);
        const normal = mul(unit(d), inside ? -1 : 1);
        return push(depth, normal, add(p, mul(normal, depth)));
      }
      case "box": {
        const d = sub(p, q.center);
        const gaps = d.map((x, axis) => q.half_size[axis] - Math.abs(x));
        if (q.side === "inside") {
          let f = [0, 0, 0];
          gaps.forEach((gap, axis) => gap < 0 && (f[axis] = Math.sign(d[axis]) * k * gap));
          return len(f) > 0 ? { f, contact: p } : null;
        }
        if (Math.min(...gaps) <= 0) return null;
        const axis = gaps.indexOf(Math.min(...gaps));
        const normal = [0, 0, 0];
        normal[axis] = Math.sign(d[axis]) || 1;
        return push(gaps[axis], normal, add(p, mul(normal, gaps[axis])));
      }
      case "spring":
        return { f: sub(mul(sub(q.anchor, p), k), mul(v, n(q.damping))) };
      case "constant_force":
        return { f: q.force };
      case "viscosity":
        return { f: mul(v, -Math.min(10, q.damping)) };
      case "gravity":
        return { f: mul(q.acceleration, q.mass) };
      case "magnet": {
        const d = sub(p, q.position);
        const x = len(d) - q.radius;
        const pull = Math.abs(x) > q.max_distance ? 0 : Math.min(k * Math.abs(x), q.max_force);
        return { f: mul(unit(d), -Math.sign(x) * pull) };
      }
      case "vibration":
        return { f: mul(unit(q.direction), q.amplitude * Math.sin(2 * Math.PI * q.frequency * this.time)) };
      case "taylor": {
        const d = sub(p, q.origin);
        if (len(d) > q.radius) return null;
        const flat = q.jacobian.flat();
        return { f: [0, 1, 2].map((row) => q.force[row] + flat[3 * row] * d[0] + flat[3 * row + 1] * d[1] + flat[3 * row + 2] * d[2]) };
      }
      default:
        return null;
    }
  }

  step(device, dt) {
    device.cycle++;
    const { p, v } = device;
    let scene = [0, 0, 0];
    device.touching = false;
    device.contact = p;
    device.felt = [];
    for (const item of device.items.values()) {
      const claim = device.claims.get(item.claim);
      const found = claim?.silent ? null : this.force(device, item, p, v);
      let flags = claim?.silent ? 16 : 0;
      const far = item.params.center ?? item.params.position;
      if (far && len(sub(p, far)) > 0.09) flags |= 32;
      if (found) {
        scene = add(scene, found.f);
        if (found.contact) {
          flags |= 1;
          device.touching = true;
          device.contact = found.contact;
        }
        if (typeof item.params.stiffness === "number" && item.params.stiffness > 3105) flags |= 2;
      }
      if (flags || found) device.felt.push([item.claim, item.slot, flags, ...(found?.f ?? [0, 0, 0]), ...(found?.contact ?? p)]);
    }
    const gain = device.state === 4 ? 1 : 0;
    const size = len(scene);
    const sent = mul(scene, gain * Math.min(1, 8.5 / (size || 1)));
    // A person's hand goes round, and presses now and then.
    const t = device.cycle / 1000;
    const wanted = device.pull ?? (device.buzz ? [0, 0, -0.003] : [0.03 * Math.cos(0.9 * t), 0.04 * Math.sin(0.9 * t), 0.012 + 0.016 * Math.cos(1.7 * t)]);
    const hand = sub(mul(sub(wanted, p), 150), mul(v, 6));
    const a = mul(add(hand, sent), 1 / 0.15);
    device.v = add(v, mul(a, dt));
    device.p = add(p, mul(device.v, dt));
    const shake = device.buzz ? 0.12e-3 * Math.sin(2 * Math.PI * 84 * t) : 0;
    const shakeV = device.buzz ? 0.12e-3 * 2 * Math.PI * 84 * Math.cos(2 * Math.PI * 84 * t) : 0;
    device.shown = { p: [device.p[0], device.p[1], device.p[2] + shake], v: [device.v[0], device.v[1], device.v[2] + shakeV] };
    device.f = sent;
    device.scene = scene;
    const late = Math.random() < 0.002 ? 400 + 800 * Math.random() : 25 + 20 * Math.random();
    if (late > 1000) device.late++;
    device.fresh.push([this.time, ...device.shown.p, ...device.shown.v, ...sent, late, late + 14, size, device.state]);
    if (device.fresh.length > 4095) device.fresh.shift();
  }

  // ---- messages

  scene(device, full, socket) {
    return {
      op: "scene", device: device.info.i, full,
      claims: [...device.claims.values()].map(({ claim, row, pid, name, frame, probes, socket: of }) => ({ claim, row, pid, name, mine: of !== null && of === socket, frame, probes })),
      items: full ? [...device.items.values()] : [...device.changed.values()],
      gone: full ? [] : device.gone,
    };
  }
  servo() {
    return { op: "servo", connected: !this.away, name: "default", pid: this.away ? 0 : this.pid, trouble: this.away ? "no servo is running; start one with: knurld --device sim:premium15" : "", devices: this.away ? [] : this.devices.map((d) => d.info) };
  }
  tick() {
    const now = performance.now();
    const steps = Math.min(100, Math.round((now - this.last) * this.options.speed));
    this.last += steps / this.options.speed;
    if (!this.away) for (let k = 0; k < steps; k++) {
      this.time += 1e-3;
      for (const device of this.devices) this.step(device, 1e-3);
    }
    const frame = {
      op: "frame", t: this.time,
      devices: this.away ? [] : this.devices.map((d) => {
        const elbow = [-0.18, d.p[1] * 0.4, 0.1];
        return {
          i: d.info.i, cycle: d.cycle, t: this.time, state: ["disconnected", "idle", "armed", "ramp_up", "active", "ramp_down", "fault"][d.state], faults: d.faults, p: (d.shown ?? d).p, q: [1, 0, 0, 0], v: d.v, w: [0, 0, 0],
          scene_force: d.scene ?? [0, 0, 0], force: d.f, torque: [0, 0, 0], contact: d.contact, buttons: 0, flags: d.touching ? ["touching"] : [], late: d.late,
          arm: [[-0.25, 0, -0.1], [-0.25, 0, 0], elbow, d.p], gap: 0,
        };
      }),
    };
    const status = this.ticks++ % 15 === 0;
    for (const socket of this.sockets) {
      const send = (message) => socket.send(JSON.stringify(message));
      if (this.away) continue;
      send(frame);
      for (const device of this.devices) {
        if (device.fresh.length) {
          const buffer = new ArrayBuffer(24 + device.fresh.length * 56);
          const view = new DataView(buffer);
          view.setUint32(0, 1, true);
          view.setUint32(4, device.info.i, true);
          view.setUint32(8, device.fresh.length, true);
          const t0 = device.fresh[0][0];
          view.setFloat64(16, t0, true);
          device.fresh.forEach((row, k) => row.forEach((x, c) => view.setFloat32(24 + 56 * k + 4 * c, c === 0 ? x - t0 : x, true)));
          socket.send(buffer);
        }
        if (device.changed.size || device.gone.length || device.newClaims) send(this.scene(device, false, socket));
        send({ op: "felt", device: device.info.i, items: device.felt });
      }
      if (status) send(this.status());
    }
    for (const device of this.devices) {
      device.fresh = [];
      device.changed.clear();
      device.gone = [];
      device.newClaims = false;
    }
  }
  status() {
    return {
      op: "status",
      devices: this.devices.map((d) => {
        const n = d.items.size;
        const parts = { read: 8.3 + Math.random(), kinematics: 0.9, take: 0.7, scenes: 1.2 + 0.25 * n + 0.3 * Math.random(), supervise: 0.6, write: 0.3, publish: 0.8, sleep: 980 };
        const busy = Object.entries(parts).reduce((sum, [name, us]) => sum + (name === "sleep" ? 0 : us), 0);
        return {
          i: d.info.i, recording: d.recording ?? null, rate: 999.6 + Math.random(), late: d.late, overruns: d.late, busy: busy / 1000, step: busy, parts, late_median: 33, late_max: 1200, counters: {},
          clients: [...d.claims.values()].map((claim) => {
            const representations = {};
            for (const item of d.items.values()) if (item.claim === claim.claim) representations[item.kind] = (representations[item.kind] ?? 0) + 1;
            return { row: claim.row, pid: claim.pid, name: claim.name, observer: false, armed: true, silent: claim.silent, shed: false, gain: 1, rate: claim.silent ? 0 : 19.9, age: 0.001 + 0.0005 * Math.random(), commits: claim.commits++, refused: 0, merged: 0, missed: 0, representations, scales: { contacts: 1, effects: 1, damping: 1 } };
          }).concat([{ row: 90, pid: process.pid, name: "knurl-web", observer: true, armed: false, silent: false, shed: false, gain: 0, rate: 0, age: 0, commits: 0, refused: 0, merged: 0, missed: 0, representations: {}, scales: { contacts: 1, effects: 1, damping: 1 } }]),
        };
      }),
    };
  }

  answer(socket, message) {
    const { op } = message;
    const needs = { add: 1, set: 1, remove: 1, clear: 1, arm: 2, disarm: 2, reset: 2, pull: 2, record: 2, stop: 2, clock: 0, doctor: message.run ? 2 : 0 }[op];
    if (needs === undefined) throw new Error(`op "${op}" is not known`);
    const have = { observe: 0, render: 1, control: 2 }[this.options.role];
    if (have < needs) throw new Error(`${op} needs the role ${needs === 2 ? "control" : "render"}; this page has ${this.options.role}`);
    if (op === "clock") return { t: this.time + (performance.now() - this.last) / 1000 };
    if (op === "doctor")
      return {
        machine: { processor: "mock", cpus: 2, kernel: "6.1", load: "none", idle: "sleep", date: "2026-11-28" },
        rates: [{ rate: 500, fitness: "good", reason: "" }, { rate: 1000, fitness: "usable", reason: "99.2 % on time" }, { rate: 4000, fitness: "unfit", reason: "" }],
        findings: [{ what: "rights", grade: "bad", says: "no real-time priority", mend: "sudo setcap cap_sys_nice,cap_ipc_lock=ep $(command -v knurld)" }],
      };
    const device = this.devices[message.device];
    if (!device) throw new Error(`device ${message.device} is not there; there are ${this.devices.length}`);
    const mine = () => this.claimOf(device, { name: "knurl-web page", pid: process.pid, socket });
    const itemOf = () => {
      const claim = mine();
      const item = device.items.get(`${claim.claim}:${message.slot}`);
      if (!item) throw new Error(`slot ${message.slot} is empty`);
      return item;
    };
    switch (op) {
      case "add": {
        const item = this.put(device, mine(), message.kind, message.params, message.probe);
        return { slot: item.slot, generation: item.generation };
      }
      case "set": {
        const item = itemOf();
        const next = this.defaults(item.kind, { ...item.params, ...message.params });
        item.params = next;
        device.changed.set(`${item.claim}:${item.slot}`, item);
        return {};
      }
      case "remove":
        itemOf();
        this.drop(device, mine().claim, message.slot);
        return {};
      case "clear":
        for (const item of [...device.items.values()]) if (item.claim === mine().claim) this.drop(device, item.claim, item.slot);
        return {};
      case "arm":
        if (device.state === 6) throw new Error("arm: the device is in fault; reset it first");
        device.state = 4;
        return {};
      case "disarm":
        if (device.state !== 6) device.state = 1;
        return {};
      case "reset":
        if (device.state === 6) device.state = 1;
        device.faults = [];
        return {};
      case "pull":
        if (message.target && message.target.some((x) => !Number.isFinite(x))) throw new Error("pull.target is not finite");
        device.pull = message.target;
        return {};
      case "record":
        if (/[/\\]/.test(message.file)) throw new Error(`file = "${message.file}": a name, no path`);
        return { path: (device.recording = `recordings/${message.file}`) };
      case "stop":
        device.recording = null;
        return { path: "recordings/knurl.mcap" };
      default:
        return { path: "recordings/knurl.mcap" };
    }
  }

  // ---- things that happen

  do(what, query) {
    const device = this.devices[0];
    const claim = device && this.claimOf(device, { name: query.get("name") ?? "floor", pid: 5000 });
    switch (what) {
      case "plane":
        return this.put(device, claim, "plane", { stiffness: 800, damping: 1 });
      case "move": {
        const item = [...device.items.values()].find((entry) => entry.claim === claim.claim && entry.kind === "plane");
        item.params.offset = Number(query.get("offset"));
        device.changed.set(`${item.claim}:${item.slot}`, item);
        return item;
      }
      case "hundred":
        for (let k = 0; k < Number(query.get("n") ?? 100); k++) this.some(device, k);
        return { items: device.items.size };
      case "mesh": {
        const number = device.assets.size + 1;
        device.assets.set(number, mesh(Number(query.get("triangles") ?? 100000)));
        return this.put(device, claim, "shape", { asset: number, position: [0, 0, -0.03], stiffness: 800, shading: query.get("shading") ?? "flat" });
      }
      case "show": {
        // Something to look at.
        const other = this.claimOf(device, { name: "molecule", pid: 5400 });
        this.put(device, claim, "plane", { offset: 0.008, stiffness: 300, damping: 1 });
        this.put(device, claim, "sphere", { center: [0.03, -0.05, -0.012], radius: 0.022, stiffness: 500, damping: 1 });
        this.put(device, claim, "box", { center: [-0.04, 0.055, 0], half_size: [0.018, 0.018, 0.012], orientation: [0.95, 0, 0, 0.31], stiffness: 600 });
        this.put(device, claim, "torus", { center: [-0.045, -0.045, 0.01], axis: [0.5, 0.3, 1], radius: 0.02, tube: 0.006, stiffness: 400 });
        this.put(device, other, "spring", { anchor: [0.02, 0.06, 0.055], stiffness: 6 });
        this.put(device, other, "taylor", { origin: [-0.01, 0.01, 0.055], jacobian: [-3, 2, 0, -2, -3, 0, 0, 0, -3], radius: 0.035 });
        return {};
      }
      case "clear":
        for (const item of [...device.items.values()]) this.drop(device, item.claim, item.slot);
        return {};
      case "fault":
        device.state = 6;
        device.faults = (query.get("names") ?? "slew").split(",");
        return {};
      case "buzz":
        device.buzz = 1;
        return {};
      case "calm":
        device.buzz = 0;
        return {};
      case "silent":
        claim.silent = query.get("on") !== "0";
        return {};
      case "away":
        this.away = query.get("on") !== "0";
        if (!this.away) this.reset();
        for (const socket of this.sockets) {
          socket.send(JSON.stringify(this.servo()));
          if (!this.away) for (const each of this.devices) socket.send(JSON.stringify(this.scene(each, true, socket)));
        }
        return {};
      case "drop":
        for (const socket of this.sockets) socket.terminate();
        return {};
      case "down":
        // Away for a while: nobody listens.
        for (const socket of this.sockets) socket.terminate();
        this.refuse = Number(query.get("ms") ?? 1500) + performance.now();
        return {};
      case "forget":
        this.forgotten = query.get("on") !== "0";
        for (const socket of this.sockets) socket.terminate();
        return {};
      case "garbage":
        for (const socket of this.sockets) socket.send(query.get("text") ?? "{]");
        return {};
      case "note":
        for (const socket of this.sockets) socket.send(JSON.stringify({ op: "note", level: "warning", text: query.get("text") ?? "something to say" }));
        return {};
      default:
        throw new Error(`do=${what} is not known`);
    }
  }
  /** One of each kind, spread over the workspace, again and again. */
  some(device, k) {
    const names = this.kinds.map((kind) => kind.name).filter((name) => name !== "shape" && name !== "constant_force" && name !== "gravity" && name !== "viscosity" && name !== "vibration");
    const kind = k < 4 ? ["constant_force", "gravity", "viscosity", "vibration"][k] : names[k % names.length];
    const claim = this.claimOf(device, { name: `app ${k % 5}`, pid: 6000 + (k % 5) });
    const a = 2.39996 * k;
    const r = 0.085 * Math.sqrt((k + 0.5) / 100);
    const at = [r * Math.cos(a), r * Math.sin(a), -0.05 + 0.09 * ((k * 7) % 10) / 10];
    const s = 0.009;
    const soft = { stiffness: 100 };
    const params = {
      plane: { normal: [Math.cos(a), Math.sin(a), 3], offset: -0.22, ...soft },
      cap: { foot: at, curvature: k % 2 ? 30 : -40, ...soft },
      polygon: { vertices: [add(at, [-s, -s, 0]), add(at, [s, -s, 0]), add(at, [s, s, 0]), add(at, [-s, s, 0])], ...soft },
      half_plane: { normal: [0, 0, 1], offset: -0.07 - k * 1e-4, edge: [Math.cos(a), Math.sin(a), 0], edge_offset: -0.03, ...soft },
      box: { center: at, half_size: [s, s, s * 0.6], orientation: [1, 0.3, 0.2 * (k % 3), 0], ...soft },
      sphere: { center: at, radius: s, ...soft },
      capsule: { center: at, axis: [1, k % 3, 0], half_length: s, radius: s / 2, ...soft },
      cylinder: { center: at, axis: [0, k % 2, 1], half_length: s, radius: s * 0.7, ...soft },
      torus: { center: at, radius: s, tube: s / 3, ...soft },
      spring: { anchor: at, stiffness: 2 },
      taylor: { origin: at, force: [0, 0, 0.05], jacobian: [-2, 1, 0, -1, -2, 0, 0, 0, -2], radius: 0.025 },
      taylor6: { origin: at, force: [0.05, 0, 0], radius: 0.02 },
      magnet: { position: at, radius: s / 2, stiffness: 20, max_force: 0.1, max_distance: 0.012 },
      constraint: { shape: ["point", "line", "plane"][k % 3], origin: at, direction: [Math.cos(a), Math.sin(a), 0.5], stiffness: 0 },
      constant_force: { force: [0, 0, -0.2] },
      gravity: { mass: 0.01 },
      viscosity: { damping: 1 },
      vibration: { amplitude: 0.02, frequency: 120 },
    }[kind];
    this.put(device, claim, kind, params ?? {});
  }

  // ---- HTTP

  async handle(request, response) {
    const url = new URL(request.url, "http://mock");
    const give = (status, type, body) => response.writeHead(status, { ...headers, "Content-Type": type }).end(body);
    if (this.refuse > performance.now() && url.pathname !== "/mock") return request.socket.destroy();
    try {
      if (url.pathname === "/mock") return give(200, "application/json", JSON.stringify(this.do(url.searchParams.get("do"), url.searchParams) ?? {}));
      if (url.searchParams.get("token") === this.token) {
        return response.writeHead(303, { ...headers, Location: "/", "Set-Cookie": "knurl=mock; HttpOnly; SameSite=Strict; Path=/" }).end();
      }
      if (this.forgotten || !/knurl=mock/.test(request.headers.cookie ?? "")) return give(403, "text/plain", "open the URL that knurl-web printed\n");
      if (request.method === "POST" && url.pathname === "/mesh") {
        let size = 0;
        for await (const chunk of request) size += chunk.length;
        if (size < 84) return give(400, "application/json", JSON.stringify({ ok: false, error: `${url.searchParams.get("name")}: no triangles in ${size} bytes` }));
        const device = this.devices[Number(url.searchParams.get("device"))];
        const asset = device.assets.size + 1;
        device.assets.set(asset, mesh(2000));
        setTimeout(() => {
          const message = { op: "asset", device: device.info.i, name: url.searchParams.get("name"), ok: true, asset, triangles: 2000, faces: 2000, low: [-0.07, -0.07, -0.01], high: [0.07, 0.07, 0.01], notes: [] };
          for (const socket of this.sockets) socket.send(JSON.stringify(message));
        }, 50);
        return give(200, "application/json", JSON.stringify({ ok: true }));
      }
      const asset = /^\/asset\/(\d+)\/(\d+)\/(\d+)$/.exec(url.pathname);
      if (asset) {
        const found = this.devices[Number(asset[1])]?.assets.get(Number(asset[3]));
        return found ? give(200, "application/octet-stream", found) : give(404, "text/plain", "not known yet\n");
      }
      const files = { "/": ["index.html", "text/html; charset=utf-8"], "/app.js": ["app.js", "text/javascript"], "/app.css": ["app.css", "text/css"], "/LICENSES.txt": ["LICENSES.txt", "text/plain"] };
      const file = files[url.pathname];
      if (!file) return give(404, "text/plain", "not there\n");
      return give(200, file[1], readFileSync(join(this.options.bundle, file[0])));
    } catch (error) {
      return give(400, "application/json", JSON.stringify({ ok: false, error: error.message }));
    }
  }

  async start() {
    this.server = createServer((request, response) => void this.handle(request, response));
    const sockets = new WebSocketServer({ noServer: true, handleProtocols: (offered) => (offered.has("knurl.live.v1") ? "knurl.live.v1" : false) });
    this.server.on("upgrade", (request, socket, head) => {
      if (this.refuse > performance.now()) return socket.destroy();
      if (this.forgotten || request.url !== "/live" || !/knurl=mock/.test(request.headers.cookie ?? "")) {
        socket.end("HTTP/1.1 403 Forbidden\r\n\r\n");
        return;
      }
      sockets.handleUpgrade(request, socket, head, (ws) => {
        ws.send(JSON.stringify({ op: "hello", version: "mock", role: this.options.role, kinds: this.kinds, simulated: true, recordings: "recordings" }));
        ws.send(JSON.stringify(this.servo()));
        if (!this.away) for (const device of this.devices) ws.send(JSON.stringify(this.scene(device, true, ws)));
        this.sockets.add(ws);
        ws.on("error", () => {});
        ws.on("close", () => {
          this.sockets.delete(ws);
          for (const device of this.devices) for (const claim of [...device.claims.values()]) if (claim.socket === ws) this.release(device, claim);
        });
        ws.on("message", (data) => {
          let message = {};
          try {
            message = JSON.parse(data);
            ws.send(JSON.stringify({ op: "answer", id: message.id, ok: true, ...this.answer(ws, message) }));
          } catch (error) {
            ws.send(JSON.stringify({ op: "answer", id: message.id ?? 0, ok: false, error: error.message }));
          }
        });
      });
    });
    await new Promise((done, fail) => this.server.once("error", fail).listen(this.options.port, "127.0.0.1", done));
    this.last = performance.now();
    this.ticks = 0;
    this.timer = setInterval(() => this.tick(), 1000 / 60);
    this.url = `http://127.0.0.1:${this.server.address().port}/?token=${this.token}`;
    return this.url;
  }
  async stop() {
    clearInterval(this.timer);
    for (const socket of this.sockets) socket.terminate();
    this.server.closeAllConnections();
    await new Promise((done) => this.server.close(done));
  }
}

/** Hills of about so many triangles, as /asset gives them. */
function mesh(triangles) {
  const n = Math.max(2, Math.round(Math.sqrt(triangles / 2)));
  const vertices = (n + 1) * (n + 1);
  const count = 2 * n * n;
  const buffer = new ArrayBuffer(8 + 12 * vertices + 12 * count);
  new Uint32Array(buffer, 0, 2).set([vertices, count]);
  const p = new Float32Array(buffer, 8, 3 * vertices);
  const f = new Uint32Array(buffer, 8 + 12 * vertices, 3 * count);
  let at = 0;
  for (let j = 0; j <= n; j++)
    for (let i = 0; i <= n; i++) {
      const x = 0.14 * (i / n - 0.5);
      const y = 0.14 * (j / n - 0.5);
      p.set([x, y, 0.008 * Math.sin(70 * x) * Math.cos(60 * y) + 0.002 * Math.sin(400 * x + 300 * y)], 3 * at++);
    }
  at = 0;
  for (let j = 0; j < n; j++)
    for (let i = 0; i < n; i++) {
      const a = j * (n + 1) + i;
      f.set([a, a + 1, a + n + 2, a, a + n + 2, a + n + 1], at);
      at += 6;
    }
  return Buffer.from(buffer);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const words = process.argv.slice(2);
  const options = { port: 8765 };
  for (let k = 0; k < words.length; k += 2) options[words[k].replace(/^--/, "")] = /^\d+$/.test(words[k + 1]) ? Number(words[k + 1]) : words[k + 1];
  const mock = new Mock(options);
  console.log(await mock.start());
}
