// A recording in the same view: a bar with a slider, and a device that shows what was at the cursor.
import { faultsOf } from "./faults.ts";
import { type Recorded, moreColumns, readRecording } from "./mcap.ts";
import { Device, type Model, frameFromHistory } from "./model.ts";
import type { ArmMessage, DeviceInfo, Message, Servo, Vec } from "./protocol.ts";
import { byId, say, setText } from "./ui.ts";

const flagNames = ["clamped", "stale", "guardian", "touching", "near_singular", "at_joint_limit"];

export class Player {
  private recorded: Recorded | null = null;
  private playing = false;
  private speed = 1;
  private before = 0;
  private arm: Vec[] = [];
  /** Texts of `recorded.scenes` that are shown; those of whole scenes, by number. */
  private told = 0;
  private whole: number[] = [];
  constructor(private readonly model: Model) {
    byId<HTMLInputElement>("open-file").addEventListener("change", (event) => {
      const input = event.target as HTMLInputElement;
      const file = input.files?.[0];
      input.value = "";
      if (file) void this.open(file);
    });
    byId("open").addEventListener("click", () => byId("open-file").click());
    byId("play").addEventListener("click", () => this.toggle());
    byId("close-recording").addEventListener("click", () => this.close());
    byId<HTMLInputElement>("scrub").addEventListener("input", (event) => this.seek((Number((event.target as HTMLInputElement).value) / 10000) * this.length));
    byId<HTMLSelectElement>("speed").addEventListener("change", (event) => (this.speed = Number((event.target as HTMLSelectElement).value)));
  }
  private get length(): number {
    return this.recorded?.history.last ?? 0;
  }

  async open(file: File): Promise<void> {
    const bar = byId("recording-bar");
    try {
      setText(byId("recording-name"), `Reading ${file.name} ...`);
      bar.hidden = false;
      const bytes = new Uint8Array(await file.arrayBuffer());
      const recorded = await readRecording(bytes, async (share) => {
        setText(byId("recording-name"), `Reading ${file.name}: ${(100 * share).toFixed(0)} %`);
        await new Promise((resolve) => window.setTimeout(resolve));
      });
      this.show(file.name, recorded);
    } catch (error) {
      bar.hidden = this.model.recording === null;
      say("error", `${file.name}: ${(error as Error).message}`);
    }
  }
  private show(name: string, recorded: Recorded): void {
    const { history, metadata } = recorded;
    this.whole = [...recorded.scenes.keys()].filter((k) => recorded.scenes[k].text.includes('"full":true'));
    const said = this.figuresIn(recorded);
    // Files of before have no figures of the device, so they are of a live one of the same profile, or of what the hand did.
    const like = [...this.model.devices.values()].find((device) => device.info.address === metadata.get("address") || device.info.profile === metadata.get("profile"));
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    let peak = 1;
    const c = history.columns;
    for (let k = 0; k < history.held; k++) {
      const p = [c.px[k], c.py[k], c.pz[k]];
      for (let axis = 0; axis < 3; axis++) {
        low[axis] = Math.min(low[axis], p[axis]);
        high[axis] = Math.max(high[axis], p[axis]);
      }
      peak = Math.max(peak, Math.hypot(c.fx[k], c.fy[k], c.fz[k]));
    }
    const extent = Math.max(...low.map((x, axis) => Math.max(Math.abs(x), Math.abs(high[axis]))));
    const info: DeviceInfo = {
      i: -1, name: metadata.get("device") ?? name, address: metadata.get("address") ?? "", profile: metadata.get("profile") ?? "", serial: "",
      rate: Number(metadata.get("rate")) || 1 / recorded.period, centre: like?.info.centre ?? [0, 0, 0], radius: like?.info.radius ?? Math.max(0.02, 1.15 * extent),
      peak_force: like?.info.peak_force ?? (Number(metadata.get("limits.peak_force")) > 0 && Number.isFinite(Number(metadata.get("limits.peak_force"))) ? Number(metadata.get("limits.peak_force")) : Math.ceil(1.2 * peak)), peak_torque: like?.info.peak_torque ?? 0.2,
      max_stiffness: like?.info.max_stiffness ?? "inf", damping: 0, lag: 0, renders_torque: false, senses_orientation: like?.info.senses_orientation ?? false, pull: false,
    };
    const device = new Device(said ? { ...said, i: -1, pull: false } : info, 1);
    Object.assign(device, { history });
    this.recorded = recorded;
    this.told = 0;
    this.arm = [];
    this.model.recordedMeshes = recorded.meshes;
    this.model.recording = device;
    const version = metadata.get("version");
    setText(byId("recording-name"), `${name}${version ? ` · Knurl ${version}` : ""}${metadata.get("cause") ? ` · ${metadata.get("cause")}` : ""} · ${history.held} reports`);
    for (const note of recorded.notes) say("warning", `${name}: ${note}`);
    this.seek(0);
    this.setPlaying(false);
    this.model.tell("recording");
    this.model.tell("servo");
  }
  /** What the servo said of the recorded device. */
  private figuresIn(recorded: Recorded): DeviceInfo | undefined {
    const first = recorded.scenes.find(({ text }) => text.startsWith('{"op":"servo"'));
    return first && (JSON.parse(first.text) as Servo).devices.find((device) => device.name === recorded.metadata.get("device"));
  }
  /** Shows the scenes as they were at that time: on from where they are, or from the last whole scene before it. */
  private scenesAt(recorded: Recorded, device: Device, t: number): void {
    const { scenes } = recorded;
    if (this.told > 0 && t < scenes[this.told - 1].t) this.told = 0;
    let from = 0;
    for (const k of this.whole) if (scenes[k].t <= t) from = k;
    if (this.told < from) this.told = from;
    if (this.told === 0) {
      this.arm = [];
      this.model.takeScene(device, { op: "scene", device: -1, full: true, claims: [], items: [], gone: [] }, Infinity);
    }
    for (; this.told < scenes.length && scenes[this.told].t <= t; this.told++) {
      const message = JSON.parse(scenes[this.told].text) as Message | ArmMessage;
      if (message.op === "scene") this.model.takeScene(device, message, Infinity);
      else if (message.op === "felt") this.model.takeFelt(device, message.items);
      else if (message.op === "arm") this.arm = message.points;
    }
  }
  close(): void {
    this.recorded = null;
    this.model.recording = null;
    this.model.recordedMeshes = new Map();
    byId("recording-bar").hidden = true;
    this.model.tell("recording");
    this.model.tell("servo");
  }
  get isOpen(): boolean {
    return this.recorded !== null;
  }
  toggle(): void {
    if (!this.recorded) return;
    if (!this.playing && this.model.cursor >= this.length) this.seek(0);
    this.setPlaying(!this.playing);
  }
  private setPlaying(on: boolean): void {
    this.playing = on;
    setText(byId("play"), on ? "Stop" : "Play");
    byId("play").setAttribute("aria-pressed", String(on));
  }
  step(seconds: number): void {
    if (this.recorded) this.seek(this.model.cursor + seconds);
  }
  private seek(t: number): void {
    const recorded = this.recorded;
    const device = this.model.recording;
    if (!recorded || !device) return;
    this.model.cursor = Math.max(0, Math.min(this.length, t));
    const k = Math.min(recorded.history.held - 1, recorded.history.find(this.model.cursor - 1e-9));
    const frame = frameFromHistory(device, k);
    const m = recorded.more;
    const at = k * moreColumns;
    frame.q = [m[at], m[at + 1], m[at + 2], m[at + 3]];
    frame.contact = [m[at + 4], m[at + 5], m[at + 6]];
    frame.torque = [m[at + 7], m[at + 8], m[at + 9]];
    frame.scene_force = [m[at + 10], m[at + 11], m[at + 12]];
    frame.faults = faultsOf(m[at + 13]);
    frame.buttons = m[at + 14];
    frame.flags = flagNames.filter((_, bit) => m[at + 15] & (1 << bit));
    this.scenesAt(recorded, device, this.model.cursor);
    frame.arm = this.arm;
    device.frame = frame;
    const scrub = byId<HTMLInputElement>("scrub");
    const value = String(Math.round((10000 * this.model.cursor) / (this.length || 1)));
    if (scrub.value !== value) scrub.value = value;
    const text = `${this.model.cursor.toFixed(3)} of ${this.length.toFixed(2)} s`;
    setText(byId("recording-time"), text);
    scrub.setAttribute("aria-valuetext", text);
  }
  /** Each frame. */
  tick(now: number): void {
    const dt = (now - this.before) / 1000;
    this.before = now;
    if (!this.playing) return;
    this.seek(this.model.cursor + Math.min(0.25, dt) * this.speed);
    if (this.model.cursor >= this.length) this.setPlaying(false);
  }
}
