// What the page knows: the servo, its devices, their scenes. Messages come in here; views read it once a frame.
import { History } from "./history.ts";
import {
  type AssetMessage,
  type Claim,
  type DeviceFrame,
  type DeviceInfo,
  type DeviceStatus,
  type Felt,
  type Hello,
  type Item,
  type Kind,
  type Message,
  type Reports,
  type SceneMessage,
  type Servo,
  felt as flag,
  stateName,
} from "./protocol.ts";

/** A representation, as the scene shows it. */
export interface SeenItem extends Item {
  /** Counts changes of its parameters; a drawer updates where it differs. */
  version: number;
  /** performance.now() when it changed; Infinity in a recording. */
  since: number;
  felt: Felt | null;
}

export class Device {
  readonly history: History;
  frame: DeviceFrame | null = null;
  /** Reports that knurl-web did not see. */
  unseen = 0;
  status: DeviceStatus | null = null;
  readonly claims = new Map<number, Claim>();
  readonly items = new Map<string, SeenItem>();
  felt: SeenItem[] = [];
  /** Counts changes of claims and items. */
  version = 0;
  /** Status as it came: age at use per client over time. */
  readonly ages: { t: number; age: Map<string, number>; parts: Record<string, number> }[] = [];
  constructor(
    public info: DeviceInfo,
    capacity?: number,
  ) {
    let size = 1 << 14;
    while (size < 32 * info.rate && size < 1 << 18) size <<= 1;
    this.history = new History(capacity ?? size);
  }
  get state(): string {
    return this.frame ? stateName(this.frame.state) : "disconnected";
  }
  mine(): Claim | undefined {
    for (const claim of this.claims.values()) if (claim.mine) return claim;
    return undefined;
  }
  kMax(): number {
    const k = this.info.max_stiffness;
    return typeof k === "number" && k > 0 ? k : Infinity;
  }
}

export function itemKey(claim: number, slot: number): string {
  return `${claim}:${slot}`;
}

type Listener = () => void;
export type Topic = "hello" | "servo" | "scene" | "status" | "recording" | "link" | "selected";

export class Model {
  hello: Hello | null = null;
  servo: Servo | null = null;
  readonly devices = new Map<number, Device>();
  kinds = new Map<string, Kind>();
  /** A recording that is looked at in place of the servo. */
  recording: Device | null = null;
  /** Its meshes, as /asset gives them, by "CLAIM/ASSET". */
  recordedMeshes = new Map<string, ArrayBuffer>();
  /** Seconds at which the recording is looked at. */
  cursor = 0;
  selected = 0;
  /** Called with what became of a mesh. */
  asset: (message: AssetMessage) => void = () => {};
  /** Called before a scene is forgotten. */
  forgetting: () => void = () => {};
  note: (level: string, text: string) => void = () => {};
  private readonly listeners = new Map<Topic, Listener[]>();

  on(topic: Topic, listener: Listener): void {
    const all = this.listeners.get(topic) ?? [];
    all.push(listener);
    this.listeners.set(topic, all);
  }
  tell(topic: Topic): void {
    for (const listener of this.listeners.get(topic) ?? []) listener();
  }

  /** What the 3D view shows. */
  shown(): Device[] {
    return this.recording ? [this.recording] : [...this.devices.values()];
  }
  /** What charts and panel are about. */
  current(): Device | undefined {
    return this.recording ?? this.devices.get(this.selected) ?? this.devices.values().next().value;
  }
  /** Until which time charts show it. */
  now(): number {
    const device = this.current();
    return !device ? 0 : device === this.recording ? this.cursor : device.history.last;
  }
  can(role: "render" | "control"): boolean {
    const has = this.hello?.role;
    return has === "control" || has === role;
  }

  /** What was known of a servo that is gone. */
  forget(): void {
    this.forgetting();
    for (const device of this.devices.values()) {
      if (device.claims.size || device.items.size) device.version++;
      device.claims.clear();
      device.items.clear();
      device.felt = [];
    }
    this.tell("scene");
  }

  take(message: Message): void {
    switch (message.op) {
      case "hello":
        this.hello = message;
        this.kinds = new Map(message.kinds.map((kind) => [kind.name, kind]));
        this.tell("hello");
        break;
      case "servo":
        this.takeServo(message);
        break;
      case "frame":
        for (const frame of message.devices) {
          const device = this.devices.get(frame.i);
          if (!device) continue;
          device.frame = frame;
          device.unseen += frame.gap ?? 0;
        }
        break;
      case "scene": {
        const device = this.devices.get(message.device);
        if (device) this.takeScene(device, message, performance.now());
        break;
      }
      case "felt": {
        const device = this.devices.get(message.device);
        if (device) this.takeFelt(device, message.items);
        break;
      }
      case "status":
        for (const status of message.devices) {
          const device = this.devices.get(status.i);
          if (!device) continue;
          device.status = status;
          const age = new Map<string, number>();
          for (const client of status.clients)
            if (!client.observer && client.age !== null && client.age > 0) age.set(`${client.name} ${client.pid}`, client.age);
          device.ages.push({ t: device.history.last, age, parts: status.parts });
          if (device.ages.length > 400) device.ages.shift();
        }
        this.tell("status");
        break;
      case "asset":
        this.asset(message);
        break;
      case "note":
        this.note(message.level, message.text);
        break;
      case "answer":
        break;
      default:
        throw new Error(`a message "${(message as { op?: string }).op}", which this page does not know`);
    }
  }

  /** `since`: when it became so (performance.now()); Infinity: what moves by itself stands still, as in a recording. */
  takeScene(device: Device, message: SceneMessage, since: number): void {
    if (message.full) {
      device.claims.clear();
      device.items.clear();
      device.felt = [];
    }
    for (const gone of message.gone ?? []) {
      if (gone.length > 1) device.items.delete(itemKey(gone[0], gone[1]));
      else {
        device.claims.delete(gone[0]);
        for (const [key, item] of device.items) if (item.claim === gone[0]) device.items.delete(key);
      }
    }
    for (const claim of message.claims ?? []) device.claims.set(claim.claim, claim);
    for (const item of message.items ?? []) {
      const key = itemKey(item.claim, item.slot);
      const old = device.items.get(key);
      const same = old && old.generation === item.generation && old.kind === item.kind;
      device.items.set(key, { ...item, version: (old?.version ?? 0) + 1, since, felt: same ? old.felt : null });
    }
    device.felt = device.felt.filter((item) => device.items.get(itemKey(item.claim, item.slot)) === item);
    device.version++;
    this.tell("scene");
  }
  takeFelt(device: Device, items: Felt[]): void {
    for (const item of device.items.values()) item.felt = null;
    device.felt = [];
    for (const entry of items) {
      const item = device.items.get(itemKey(entry[0], entry[1]));
      if (!item) continue;
      item.felt = entry;
      device.felt.push(item);
    }
  }

  private takeServo(message: Servo): void {
    const restarted = this.servo && this.servo.pid !== message.pid && message.pid !== 0 && this.servo.pid !== 0;
    this.servo = message;
    if (message.connected || message.devices.length > 0) {
      const there = new Set(message.devices.map((info) => info.i));
      for (const i of [...this.devices.keys()]) if (!there.has(i)) this.devices.delete(i);
      for (const info of message.devices) {
        const device = this.devices.get(info.i);
        if (!device || device.info.name !== info.name || device.info.rate !== info.rate) this.devices.set(info.i, new Device(info));
        else device.info = info;
      }
    }
    if (restarted) for (const device of this.devices.values()) device.history.clear();
    if (!message.connected) {
      for (const device of this.devices.values()) {
        device.frame = null;
        device.status = null;
      }
      this.forget();
    }
    if (!this.devices.has(this.selected) && this.devices.size) this.selected = this.devices.keys().next().value ?? 0;
    this.tell("servo");
  }

  takeReports(reports: Reports): void {
    const device = this.devices.get(reports.device);
    if (!device) return;
    const { data, t } = reports;
    for (let k = 0; k < reports.count; k++) device.history.push(t + data[k * 14], data, k * 14 + 1);
  }

  /** Items of a claim, by slot. */
  itemsOf(device: Device, claim: number): SeenItem[] {
    return [...device.items.values()].filter((item) => item.claim === claim).sort((a, b) => a.slot - b.slot);
  }
}

/** What an item is for the hand just now. */
export function mood(item: SeenItem, silent: boolean): "touched" | "faded" | "asleep" | "there" {
  const flags = item.felt?.[2] ?? 0;
  if (flags & flag.asleep) return "asleep";
  if (flags & (flag.fading | flag.silent) || silent) return "faded";
  return flags & flag.touching ? "touched" : "there";
}

/** Of the row of a recording: the frame that the view shows. */
export function frameFromHistory(device: Device, k: number): DeviceFrame {
  const h = device.history;
  const place = h.place(Math.max(0, Math.min(h.held - 1, k)));
  const c = h.columns;
  return {
    i: device.info.i,
    cycle: k,
    t: h.t[place],
    state: c.state[place],
    faults: [],
    p: [c.px[place], c.py[place], c.pz[place]],
    q: [1, 0, 0, 0],
    v: [c.vx[place], c.vy[place], c.vz[place]],
    w: [0, 0, 0],
    scene_force: [0, 0, 0],
    force: [c.fx[place], c.fy[place], c.fz[place]],
    torque: [0, 0, 0],
    contact: [c.px[place], c.py[place], c.pz[place]],
    buttons: 0,
    flags: [],
    late: 0,
    arm: [],
    gap: 0,
  };
}
