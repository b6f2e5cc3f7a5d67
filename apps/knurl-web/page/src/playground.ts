// The playground: representations of this page's own claim, with sliders made from the server's table of fields.
import { type ExportedAsset, toCpp, toPython, toToml } from "./code_export.ts";
import type { Connection } from "./connection.ts";
import { type Device, type Model, type SeenItem } from "./model.ts";
import { type AssetMessage, type Field, type Params, type Value, num } from "./protocol.ts";
import { byId, download, el, say, setText, si } from "./ui.ts";

export interface Range {
  low: number;
  high: number;
  /** Positions of a slider go by the logarithm; 0 is at its left end. */
  log: boolean;
}
export interface Reach {
  /** N/m; infinite: not known. */
  kMax: number;
  /** m, in the claim's world. */
  radius: number;
  centre: [number, number, number];
  peakForce: number;
  peakTorque: number;
}

/** What is sensible to slide over; what is legal is often 1e9. */
export function rangeOf(field: Field, reach: Reach, axis = 0): Range {
  const { radius } = reach;
  const k = Number.isFinite(reach.kMax) ? reach.kMax : 1000;
  const limit = (low: number, high: number, log = false): Range => ({ low: Math.max(low, num(field.minimum, -Infinity)), high: Math.min(high, num(field.maximum, Infinity)), log });
  const name = field.name;
  if (name.startsWith("friction.") && field.unit === "1") return limit(0, 2);
  if (name.startsWith("snag.d")) return limit(1e-5, 0.01, true);
  if (name === "snag.k_stick") return limit(10, 5000, true);
  if (name === "snag.k_kinetic") return limit(0, 2);
  if (name === "texture.amplitude") return limit(1e-6, 1e-3, true);
  if (name === "texture.wavelength") return limit(6e-5, 0.02, true);
  if (name === "velocity") return limit(-0.1, 0.1);
  if (field.type === "vector") {
    switch (field.unit) {
      case "m":
        return name === "half_size" ? limit(0, radius) : name === "attach" ? limit(-radius, radius) : { low: reach.centre[axis] - 1.2 * radius, high: reach.centre[axis] + 1.2 * radius, log: false };
      case "N":
        return limit(-reach.peakForce, reach.peakForce);
      case "N m":
        return limit(-reach.peakTorque, reach.peakTorque);
      case "m/s^2":
        return limit(-20, 20);
      case "rad/s":
        return limit(-6, 6);
      default:
        return limit(-1, 1);
    }
  }
  switch (field.unit) {
    case "N/m":
      return limit(5, 1.2 * k, true);
    case "N s/m":
      return limit(0.02, 20, true);
    case "N m s/rad":
      return limit(1e-5, 0.05, true);
    case "m":
      return num(field.minimum, 0) < 0 ? limit(-1.2 * radius, 1.2 * radius) : limit(radius / 500, 1.2 * radius, true);
    case "1/m":
      return limit(-200, 200);
    case "N":
      return limit(0.01, reach.peakForce, true);
    case "kg":
      return limit(0.001, 1, true);
    case "s":
      return limit(0.001, 2, true);
    case "Hz":
      return limit(1, 400, true);
    case "rad":
      return limit(0.01, Math.PI / 2);
    default:
      return limit(Math.max(-10, num(field.minimum, -10)), Math.min(10, num(field.maximum, 10)));
  }
}
/** A slider's position, 0 to 1000, and back. */
export function toSlider(value: number, range: Range): number {
  if (!range.log) return Math.round((1000 * (value - range.low)) / (range.high - range.low || 1));
  if (value <= 0) return 0;
  const at = 1 + (999 * Math.log(value / range.low)) / Math.log(range.high / range.low);
  return Math.round(Math.min(1000, Math.max(1, at)));
}
export function fromSlider(at: number, range: Range, zero = true): number {
  const value = !range.log ? range.low + (at / 1000) * (range.high - range.low) : at <= 0 && zero ? 0 : range.low * (range.high / range.low) ** ((Math.max(1, at) - 1) / 999);
  return +value.toPrecision(4);
}

/** A line about a file; the server's may begin with its name already. */
function oneOf(name: string, text: string): string {
  return text.startsWith(name) ? text : `${name}: ${text}`;
}

/** A preset: what it is, and its parameters at a hand's place. */
interface Preset {
  name: string;
  kind: string;
  params(reach: Reach, hand: [number, number, number]): Params;
}
const stiff = (reach: Reach, share: number): number => Math.round(share * (Number.isFinite(reach.kMax) ? reach.kMax : 1000));
const presets: Preset[] = [
  { name: "Floor", kind: "plane", params: (r) => ({ normal: [0, 0, 1], offset: r.centre[2] - 0.15 * r.radius, stiffness: stiff(r, 0.35), damping: 1 }) },
  { name: "Wall", kind: "plane", params: (r) => ({ normal: [1, 0, 0], offset: r.centre[0] - 0.35 * r.radius, stiffness: stiff(r, 0.5), damping: 1 }) },
  { name: "Soft ball", kind: "sphere", params: (r) => ({ center: [r.centre[0] - 0.1 * r.radius, r.centre[1], r.centre[2] - 0.3 * r.radius], radius: 0.3 * r.radius, stiffness: stiff(r, 0.1), damping: 1 }) },
  { name: "Box", kind: "box", params: (r) => ({ center: [r.centre[0], r.centre[1], r.centre[2] - 0.4 * r.radius], half_size: [0.35 * r.radius, 0.35 * r.radius, 0.2 * r.radius], stiffness: stiff(r, 0.35), damping: 1 }) },
  { name: "Room", kind: "box", params: (r) => ({ center: [...r.centre], half_size: [0.6 * r.radius, 0.6 * r.radius, 0.6 * r.radius], side: "inside", stiffness: stiff(r, 0.35), damping: 1 }) },
  { name: "Icy floor", kind: "plane", params: (r) => ({ offset: r.centre[2] - 0.15 * r.radius, stiffness: stiff(r, 0.6), "friction.static": 0.05, "friction.dynamic": 0.03 }) },
  { name: "Sandpaper", kind: "plane", params: (r) => ({ offset: r.centre[2] - 0.15 * r.radius, stiffness: stiff(r, 0.6), damping: 1, "snag.k_kinetic": 0.6, "snag.k_stick": 2000, "snag.d_snap": 0.45e-3, "snag.d_mean": 0.4e-3, "snag.d_spread": 0.2e-3 }) },
  { name: "Rubber", kind: "plane", params: (r) => ({ offset: r.centre[2] - 0.15 * r.radius, stiffness: Math.min(600, stiff(r, 0.8)), damping: 3, "friction.static": 1.1, "friction.dynamic": 0.8 }) },
  { name: "Spring to here", kind: "spring", params: (_, hand) => ({ anchor: [...hand], stiffness: 60, damping: 1 }) },
  { name: "Magnet", kind: "magnet", params: (r) => ({ position: [...r.centre], radius: 0.2 * r.radius, stiffness: 200, max_force: Math.min(2, 0.4 * r.peakForce), max_distance: 0.3 * r.radius }) },
  { name: "Viscous water", kind: "viscosity", params: () => ({ damping: 3 }) },
  { name: "Vibration", kind: "vibration", params: () => ({ direction: [0, 0, 1], amplitude: 0.4, frequency: 80 }) },
  { name: "Gravity", kind: "gravity", params: () => ({ mass: 0.1 }) },
  { name: "Rail", kind: "constraint", params: (r) => ({ shape: "line", origin: [...r.centre], direction: [0, 1, 0], stiffness: stiff(r, 0.2), damping: 1 }) },
  { name: "Bowl field", kind: "taylor", params: (r) => ({ origin: [...r.centre], jacobian: [-60, 0, 0, 0, -60, 0, 0, 0, -60], radius: 0.6 * r.radius, edge: "fade" }) },
];
/** What a kind needs so that something is felt and seen. */
function start(kind: string, reach: Reach, hand: [number, number, number]): Params {
  const preset = presets.find((entry) => entry.kind === kind);
  if (preset) return preset.params(reach, hand);
  const k = { stiffness: stiff(reach, 0.35), damping: 1 };
  const c = reach.centre;
  const r = reach.radius;
  const low: [number, number, number] = [c[0], c[1], c[2] - 0.3 * r];
  switch (kind) {
    case "cap":
      return { foot: low, curvature: -1 / r, ...k };
    case "polygon":
      return { vertices: [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => [c[0] + 0.4 * r * x, c[1] + 0.4 * r * y, low[2]]), ...k };
    case "half_plane":
      return { offset: low[2], edge: [1, 0, 0], edge_offset: c[0], ...k };
    case "capsule":
      return { center: low, axis: [0, 1, 0], half_length: 0.25 * r, radius: 0.12 * r, ...k };
    case "cylinder":
      return { center: low, half_length: 0.15 * r, radius: 0.25 * r, ...k };
    case "torus":
      return { center: low, radius: 0.3 * r, tube: 0.08 * r, ...k };
    case "constant_force":
      return { force: [0, 0, -Math.min(1, 0.2 * reach.peakForce)] };
    case "taylor6":
      return { origin: [...c], radius: 0.5 * r };
    default:
      return {};
  }
}

/** Of an angle about x, y, z each (rad), as w x y z; and back. */
export function toQuaternion([x, y, z]: number[]): number[] {
  const [cx, sx, cy, sy, cz, sz] = [x, y, z].flatMap((a) => [Math.cos(a / 2), Math.sin(a / 2)]);
  return [cx * cy * cz + sx * sy * sz, sx * cy * cz - cx * sy * sz, cx * sy * cz + sx * cy * sz, cx * cy * sz - sx * sy * cz];
}
export function toAngles([w, x, y, z]: number[]): number[] {
  return [Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x)))), Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))];
}

/** Where it is: the parameter that a drag moves. */
const places = ["center", "position", "anchor", "origin", "foot"];

interface Row {
  field: Field;
  show(value: Value): void;
}

export class Playground {
  private slot: number | null = null;
  private rows: Row[] = [];
  private shownKey = "";
  private listed = "";
  /** Changes that were not sent yet, by device and slot; one request at a time for each. */
  private readonly waiting = new Map<string, { device: number; slot: number; params: Params; busy: boolean }>();
  private readonly local = new Map<string, Params>();
  private touchedAt = 0;
  /** What this page had on a device when the connection or the servo was lost, by the device's name. */
  private readonly lost = new Map<string, SeenItem[]>();
  /** Of files that were sent, until the server says what became of them. */
  private readonly units = new Map<string, string>();
  private readonly files = new Map<string, ExportedAsset>();

  constructor(
    private readonly model: Model,
    private readonly connection: () => Connection,
  ) {
    byId("presets").append(
      ...presets.map((preset) => el("button.small", { type: "button", "data-preset": preset.name, click: () => void this.addPreset(preset) }, preset.name)),
    );
    byId("add").addEventListener("click", () => void this.addKind());
    byId("restore").addEventListener("click", () => void this.restore());
    byId("clear").addEventListener("click", () => void this.clear());
    byId("arm-mine").addEventListener("click", () => void this.ask("arm"));
    for (const [id, name, make] of [["to-toml", "scene.toml", toToml], ["to-cpp", "scene.cpp", toCpp], ["to-python", "scene.py", toPython]] as const)
      byId(id).addEventListener("click", () => {
        const scene = this.exported();
        if (!scene) return say("warning", "There is nothing to export: nobody has added anything.");
        const text = make(scene);
        byId<HTMLTextAreaElement>("exported").value = text;
        byId("export-name").textContent = name;
        byId<HTMLDialogElement>("export-dialog").showModal();
      });
    byId("export-save").addEventListener("click", () => download(byId("export-name").textContent ?? "scene.txt", byId<HTMLTextAreaElement>("exported").value));
    byId("export-copy").addEventListener("click", () => {
      const area = byId<HTMLTextAreaElement>("exported");
      navigator.clipboard?.writeText(area.value).then(
        () => say("info", "Copied."),
        () => (area.select(), say("warning", "The browser does not let the page copy: press Ctrl+C.")),
      );
    });
    byId<HTMLInputElement>("mesh-file").addEventListener("change", (event) => {
      const input = event.target as HTMLInputElement;
      for (const file of input.files ?? []) void this.loadMesh(file);
      input.value = "";
    });
    model.on("hello", () => this.kinds());
    model.on("scene", () => this.show());
    model.on("selected", () => this.show());
  }

  private get device(): Device | undefined {
    return this.model.recording ? undefined : this.model.current();
  }
  private reach(device: Device): Reach {
    const frame = device.mine()?.frame;
    const scale = frame?.scale ?? 1;
    const c = device.info.centre;
    const centre = frame ? ([0, 1, 2].map((k) => (c[k] - frame.device_centre[k]) * scale + frame.world_centre[k]) as [number, number, number]) : c;
    return { kMax: device.kMax() / (scale || 1), radius: device.info.radius * scale, centre, peakForce: device.info.peak_force || 8, peakTorque: device.info.peak_torque || 0.2 };
  }
  private hand(device: Device): [number, number, number] {
    const p = device.frame?.p ?? device.info.centre;
    const frame = device.mine()?.frame;
    return frame ? ([0, 1, 2].map((k) => (p[k] - frame.device_centre[k]) * frame.scale + frame.world_centre[k]) as [number, number, number]) : [...p];
  }

  private kinds(): void {
    byId<HTMLSelectElement>("kind").replaceChildren(
      ...[true, false].map((surface) =>
        el(
          "optgroup",
          { label: surface ? "surfaces" : "effects" },
          ...[...this.model.kinds.values()].filter((kind) => kind.surface === surface).map((kind) => el("option", { value: kind.name }, kind.name.replaceAll("_", " "))),
        ),
      ),
    );
    const may = this.model.can("render");
    byId("playground-body").toggleAttribute("inert", !may);
    byId("playground-why").hidden = may;
    byId("arm-mine").hidden = !this.model.can("control");
    this.shownKey = "";
    this.show();
  }

  private async request(op: string, body: Record<string, unknown>): Promise<Record<string, unknown> | null> {
    try {
      return await this.connection().request(op, body);
    } catch (error) {
      say("error", (error as Error).message);
      return null;
    }
  }
  private async ask(op: string): Promise<void> {
    const device = this.device;
    if (device) await this.request(op, { device: device.info.i });
  }

  private async add(kind: string, params: Params, device = this.device): Promise<void> {
    if (!device) return say("warning", "There is no device to add something to.");
    const probe = Number(byId<HTMLInputElement>("probe").value) || 0;
    const answer = await this.request("add", { device: device.info.i, kind, params, probe });
    if (!answer) return;
    this.slot = answer.slot as number;
    const asked = num(params.stiffness);
    const applied = num(answer.applied_stiffness);
    if (applied > 0 && Number.isFinite(asked) && applied < 0.999 * asked) say("info", `The device allows ${Math.round(applied)} N/m of the ${Math.round(asked)} N/m that were asked for.`);
    this.shownKey = "";
    this.show();
    const state = device.state;
    if (state === "idle") say("info", this.model.can("control") ? "Added. No force yet: press Arm." : "Added. No force yet: a page with the role control has to arm.");
  }
  private addPreset(preset: Preset): Promise<void> {
    const device = this.device;
    if (!device) return Promise.resolve(say("warning", "There is no device to add something to."));
    return this.add(preset.kind, preset.params(this.reach(device), this.hand(device)));
  }
  private addKind(): Promise<void> {
    const device = this.device;
    if (!device) return Promise.resolve(say("warning", "There is no device to add something to."));
    const kind = byId<HTMLSelectElement>("kind").value;
    return this.add(kind, start(kind, this.reach(device), this.hand(device)));
  }
  private async clear(): Promise<void> {
    const device = this.device;
    if (!device) return;
    this.lost.delete(device.info.name);
    await this.request("clear", { device: device.info.i });
  }

  /** Before the model forgets: what this page had ends with its socket, and with the servo. */
  remember(): void {
    for (const device of this.model.devices.values()) {
      const claim = device.mine();
      const items = claim ? this.model.itemsOf(device, claim.claim).filter((item) => item.kind !== "shape") : [];
      if (items.length) this.lost.set(device.info.name, items);
    }
  }
  private async restore(): Promise<void> {
    const device = this.device;
    const items = device && this.lost.get(device.info.name);
    if (!device || !items) return;
    this.lost.delete(device.info.name);
    for (const item of items) await this.request("add", { device: device.info.i, kind: item.kind, params: item.params, probe: item.probe });
    this.show();
  }

  // ---- changes

  /** Sends at most one request at a time for each slot; the newest wins. */
  change(device: Device, slot: number, params: Params): void {
    const key = `${device.info.i}:${slot}`;
    this.local.set(key, { ...this.local.get(key), ...params });
    const entry = this.waiting.get(key) ?? { device: device.info.i, slot, params: {}, busy: false };
    Object.assign(entry.params, params);
    this.waiting.set(key, entry);
    this.touchedAt = performance.now();
    if (!entry.busy) void this.send(key);
  }
  private async send(key: string): Promise<void> {
    const entry = this.waiting.get(key);
    if (!entry) return;
    entry.busy = true;
    while (Object.keys(entry.params).length) {
      const params = entry.params;
      entry.params = {};
      if (!(await this.request("set", { device: entry.device, slot: entry.slot, params }))) break;
    }
    this.waiting.delete(key);
    window.setTimeout(() => {
      // The scene has the truth by now, or what was refused is taken back.
      if (this.waiting.has(key)) return;
      this.local.delete(key);
      this.refresh();
    }, 300);
  }

  /** What a mouse drags in the 3D view (m, the claim's world). */
  drag(device: Device, item: SeenItem, by: [number, number, number]): void {
    const params = { ...item.params, ...this.local.get(`${device.info.i}:${item.slot}`) };
    const place = places.find((name) => Array.isArray(params[name]) && (params[name] as number[]).length === 3);
    const plus = (v: number[]) => v.map((x, k) => x + by[k]);
    if (place) this.change(device, item.slot, { [place]: plus(params[place] as number[]) });
    else if (item.kind === "polygon") this.change(device, item.slot, { vertices: (params.vertices as number[][]).map(plus) });
    else if (Array.isArray(params.normal)) this.change(device, item.slot, { offset: num(params.offset) + (params.normal as number[]).reduce((sum, n, k) => sum + n * by[k], 0) });
    this.refresh();
  }

  // ---- list and editor

  show(): void {
    const device = this.device;
    const mine = device?.mine();
    const items = device && mine ? this.model.itemsOf(device, mine.claim) : [];
    if (this.slot === null || !items.some((item) => item.slot === this.slot)) this.slot = items.length ? items[items.length - 1].slot : null;
    byId("lost-box").hidden = !(device && this.lost.has(device.info.name) && items.length === 0);
    const list = byId("items");
    const listed = items.map((item) => `${item.slot}:${item.kind}:${item.slot === this.slot}`).join() + String(items.length);
    if (listed !== this.listed) {
      this.listed = listed;
      list.replaceChildren(
        ...items.map((item) =>
          el(
            "li",
            {},
            el("button.item", { type: "button", "aria-pressed": String(item.slot === this.slot), click: () => ((this.slot = item.slot), (this.shownKey = ""), this.show()) }, `${item.kind.replaceAll("_", " ")} `, el("small", {}, `slot ${item.slot}`)),
            el("button.small.remove", { type: "button", "aria-label": `remove ${item.kind} in slot ${item.slot}`, title: "remove", click: () => void this.request("remove", { device: device!.info.i, slot: item.slot }) }, "✕"),
          ),
        ),
      );
    }
    byId("items-empty").hidden = items.length > 0;
    const item = items.find((entry) => entry.slot === this.slot);
    const editor = byId("editor");
    editor.hidden = !item;
    if (!item || !device || !mine) {
      this.shownKey = "";
      return;
    }
    const key = `${device.info.i}:${mine.claim}:${item.slot}:${item.generation}:${item.kind}`;
    if (key !== this.shownKey) {
      this.shownKey = key;
      this.build(device, item);
    }
    this.refresh();
  }
  /** Values from the scene, but of what the person holds just now. */
  private refresh(): void {
    const device = this.device;
    const mine = device?.mine();
    if (!device || !mine || this.slot === null) return;
    const item = device.items.get(`${mine.claim}:${this.slot}`);
    if (!item) return;
    const params = { ...item.params, ...this.local.get(`${device.info.i}:${item.slot}`) };
    for (const row of this.rows) row.show(params[row.field.name] ?? row.field.default);
  }

  private build(device: Device, item: SeenItem): void {
    const kind = this.model.kinds.get(item.kind);
    const editor = byId("editor");
    this.rows = [];
    const groups = new Map<string, HTMLElement>();
    editor.replaceChildren(el("h3", {}, `${item.kind.replaceAll("_", " ")}, slot ${item.slot}`));
    for (const field of kind?.fields ?? []) {
      const group = field.name.includes(".") ? field.name.split(".")[0] : ["recovery", "braking", "velocity", "angular_velocity", "update", "combine"].includes(field.name) && kind?.surface ? "more" : "";
      let into: HTMLElement = editor;
      if (group) {
        into = groups.get(group) ?? el("details", {}, el("summary", {}, group));
        if (!groups.has(group)) {
          groups.set(group, into);
          const used = (kind?.fields ?? []).some((other) => other.name.startsWith(`${group}.`) && num(item.params[other.name]) > 0 && other.type === "real" && item.params[other.name] !== other.default);
          if (used) into.setAttribute("open", "");
        }
      }
      into.append(this.row(device, item, field));
    }
    editor.append(...groups.values());
  }

  private row(device: Device, item: SeenItem, field: Field): HTMLElement {
    const reach = this.reach(device);
    const set = (value: Value) => this.change(device, item.slot, { [field.name]: value });
    const current = (): Value => this.local.get(`${device.info.i}:${item.slot}`)?.[field.name] ?? device.items.get(`${item.claim}:${item.slot}`)?.params[field.name] ?? field.default;
    const short = field.name.includes(".") ? field.name.split(".")[1] : field.name;
    const label = el("div.label", { title: `${field.meaning}${field.unit ? ` (${field.unit})` : ""}` }, short.replaceAll("_", " "), el("span.unit", {}, field.unit && field.unit !== "1" ? ` ${field.unit}` : ""));
    const box = el("div.field", { "data-field": field.name }, label);
    const held = (element: Element) => document.activeElement === element && performance.now() - this.touchedAt < 1500;

    if (field.type === "choice") {
      const select = el("select", { "aria-label": field.name }, ...(field.choices ?? []).map((choice) => el("option", { value: choice }, choice.replaceAll("_", " "))));
      select.addEventListener("change", () => set(select.value));
      box.append(select);
      this.rows.push({ field, show: (value) => void (select.value = String(value)) });
      return box;
    }
    if (field.type === "matrix" || field.type === "points") {
      // Numbers, row by row.
      const area = el("textarea", { "aria-label": field.name, rows: field.type === "matrix" ? (field.count === 36 || field.count === 6 ? 6 : 3) : 4, spellcheck: "false" });
      area.addEventListener("change", () => {
        const rows = area.value.trim().split("\n").map((line) => line.trim().split(/[\s,]+/).map(Number));
        if (rows.some((row) => row.some((x) => !Number.isFinite(x)))) return say("error", `${item.kind}.${field.name}: numbers, row by row, separated by spaces`);
        set(field.type === "matrix" ? rows.flat() : rows);
      });
      box.append(area);
      box.classList.add("wide");
      this.rows.push({
        field,
        show: (value) => {
          if (document.activeElement === area || !Array.isArray(value)) return;
          let rows = value as number[][];
          if (!Array.isArray(value[0])) {
            const n = Math.sqrt(value.length);
            rows = Array.from({ length: n }, (_, k) => (value as number[]).slice(k * n, k * n + n));
          }
          area.value = rows.map((row) => row.map((x) => +x.toPrecision(5)).join(" ")).join("\n");
        },
      });
      return box;
    }
    if (field.type === "integer") {
      const input = el("input", { type: "number", min: num(field.minimum, 0), max: num(field.maximum, 4294967295), step: 1, "aria-label": field.name });
      input.addEventListener("change", () => set(Math.round(Number(input.value)) || 0));
      box.append(input);
      this.rows.push({ field, show: (value) => void (document.activeElement === input || (input.value = String(value))) });
      return box;
    }

    const vectorial = field.type === "vector" || field.type === "quaternion";
    const angles = field.type === "quaternion";
    const special = !vectorial && (field.automatic ? "automatic" : field.infinity ? "inf" : "");
    const sliders: { slider: HTMLInputElement; number: HTMLInputElement; range: Range }[] = [];
    const put = (axis: number, value: number): void => {
      if (!Number.isFinite(value)) return;
      if (!vectorial) return set(value);
      const all = angles ? toAngles(current() as number[]) : [...(current() as number[])].map((x) => num(x));
      all[axis] = angles ? (value * Math.PI) / 180 : value;
      set(angles ? toQuaternion(all) : all);
    };
    for (let axis = 0; axis < (vectorial ? 3 : 1); axis++) {
      const range = angles ? { low: -180, high: 180, log: false } : rangeOf(field, reach, axis);
      const name = vectorial ? `${field.name} ${"xyz"[axis]}` : field.name;
      const slider = el("input", { type: "range", min: 0, max: 1000, step: 1, "aria-label": name });
      const number = el("input", { type: "number", step: "any", "aria-label": `${name}, as a number` });
      const zero = num(field.minimum, 0) <= 0;
      slider.addEventListener("input", () => {
        const value = fromSlider(Number(slider.value), range, zero);
        number.value = String(value);
        put(axis, value);
      });
      number.addEventListener("change", () => {
        if (number.value.trim() === "" || !Number.isFinite(Number(number.value))) return say("error", `${item.kind}.${field.name}: a number is missing`);
        put(axis, Number(number.value));
      });
      const line = el("div.slide", {}, vectorial ? el("span.axis", { "data-axis": "xyz"[axis] }, "xyz"[axis]) : el("span.axis"), slider, number);
      sliders.push({ slider, number, range });
      box.append(line);
    }
    let check: HTMLInputElement | null = null;
    if (special) {
      check = el("input", { type: "checkbox", "aria-label": `${field.name} ${special}` });
      check.addEventListener("change", () => set(check!.checked ? special : special === "inf" ? (Number.isFinite(reach.kMax) && field.unit === "N/m" ? Math.round(0.35 * reach.kMax) : 0.1) : fromSlider(300, sliders[0].range)));
      box.append(el("label.check", {}, check, special === "inf" ? (field.unit === "N/m" ? "as stiff as the device allows" : "endless") : special));
    }
    this.rows.push({
      field,
      show: (value) => {
        if (check) check.checked = value === special;
        const values = angles ? toAngles(value as number[]).map((a) => (a * 180) / Math.PI) : vectorial ? (value as number[]).map((x) => num(x)) : [num(value, NaN)];
        sliders.forEach(({ slider, number, range }, axis) => {
          const off = !Number.isFinite(values[axis]);
          slider.disabled = number.disabled = off && special !== "";
          if (!held(slider)) slider.value = String(off ? (value === "inf" ? 1000 : 0) : toSlider(values[axis], range));
          if (document.activeElement !== number) number.value = off ? "" : String(+values[axis].toPrecision(4));
        });
      },
    });
    return box;
  }

  // ---- meshes

  async loadMesh(file: File): Promise<void> {
    const device = this.device;
    if (!device) return say("warning", "There is no device to send a mesh to.");
    if (!this.model.can("render")) return say("error", `${file.name}: this page may only look on; start knurl-web with the role render or control`);
    if (!/\.(stl|obj|ply)$/i.test(file.name)) return say("error", `${file.name}: neither STL, OBJ nor PLY; export it as one of these`);
    const unit = byId<HTMLSelectElement>("mesh-unit").value;
    setText(byId("mesh-state"), `Sending ${file.name}, ${(file.size / 1e6).toFixed(1)} MB ...`);
    try {
      const answer = await fetch(`./mesh?device=${device.info.i}&name=${encodeURIComponent(file.name)}${unit ? `&unit=${unit}` : ""}`, { method: "POST", body: file });
      const text = await answer.text();
      let said: { ok?: boolean; error?: string } = {};
      try {
        said = JSON.parse(text);
      } catch {
        // no JSON: the status says enough
      }
      if (!answer.ok || !said.ok) throw new Error(said.error ?? `refused (${answer.status})`);
      this.units.set(file.name, unit);
      // It may have been read already.
      if (byId("mesh-state").textContent?.startsWith("Sending")) setText(byId("mesh-state"), `The servo reads ${file.name} ...`);
    } catch (error) {
      setText(byId("mesh-state"), "");
      say("error", oneOf(file.name, (error as Error).message));
    }
  }
  /** The server says what became of a mesh. */
  async sent(message: AssetMessage): Promise<void> {
    const device = this.model.devices.get(message.device);
    if (!message.ok || message.asset === undefined) {
      setText(byId("mesh-state"), "");
      return say("error", oneOf(message.name, message.error ?? "refused without a reason"));
    }
    if (!device) return;
    this.files.set(`${message.device}:${message.asset}`, { number: message.asset, file: message.name, unit: this.units.get(message.name) || "mm" });
    const { low, high } = message;
    const size = low && high ? `, ${low.map((x, k) => si(high[k] - x, "m")).join(" × ")}` : "";
    setText(byId("mesh-state"), `${message.name}: ${message.triangles ?? message.faces} triangles${size}, asset ${message.asset}.`);
    for (const note of [message.notes ?? []].flat()) if (note) say("info", oneOf(message.name, note));
    const reach = this.reach(device);
    // Its middle comes to that of the workspace.
    const position = low && high ? reach.centre.map((c, k) => c - (low[k] + high[k]) / 2) : reach.centre;
    await this.add("shape", { asset: message.asset, position, stiffness: stiff(reach, 0.3), damping: 1 }, device);
  }

  // ---- export

  private exported(): Parameters<typeof toToml>[0] | null {
    const device = this.model.current();
    if (!device) return null;
    // This page's own claim; where it has none, the first that has something.
    const claim = device.mine() ?? [...device.claims.values()].find((entry) => this.model.itemsOf(device, entry.claim).length > 0);
    if (!claim) return null;
    const items = this.model.itemsOf(device, claim.claim);
    if (!items.length) return null;
    const assets = [...this.files].filter(([key]) => key.startsWith(`${device.info.i}:`)).map(([, asset]) => asset);
    return { kinds: this.model.kinds, items, assets, probes: claim.probes, device: device.info.name };
  }
}
