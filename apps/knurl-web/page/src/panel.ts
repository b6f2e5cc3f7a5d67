// The panel: state and faults, indicators, clients as `knurl top` shows them, recording, doctor.
import type { Connection } from "./connection.ts";
import { faultOf } from "./faults.ts";
import type { Device, Model } from "./model.ts";
import { num } from "./protocol.ts";
import { type Situation, buzzAt, buzzSentence, energyInto, energySentence, span } from "./spectrum.ts";
import { byId, el, say, setText, si } from "./ui.ts";

const giving = ["spring", "constant_force", "taylor", "taylor6", "gravity", "magnet", "constraint", "vibration"];

export class Panel {
  private lateBefore = new Map<Device, { at: number; count: number }[]>();
  private faultsShown = "?";
  /** When this page saw each recording of a device begin; the server says which run, also after the page was loaded anew. */
  private readonly recordingSince = new Map<number, number>();
  constructor(
    private readonly model: Model,
    private readonly connection: () => Connection,
  ) {
    for (const op of ["arm", "disarm", "reset"]) byId(op).addEventListener("click", () => void this.ask(op));
    byId("record").addEventListener("click", () => void this.record());
    byId("doctor").addEventListener("click", () => void this.doctor(false));
    byId("doctor-run").addEventListener("click", () => void this.doctor(true));
    model.on("hello", () => this.roles());
    model.on("servo", () => this.servo());
    model.on("selected", () => {
      this.servo();
      this.recordings();
    });
    model.on("recording", () => this.roles());
    model.on("status", () => {
      this.clients();
      this.recordings();
    });
  }

  private async ask(op: string): Promise<void> {
    const device = this.model.current();
    if (!device) return say("warning", "There is no device.");
    try {
      await this.connection().request(op, { device: device.info.i });
    } catch (error) {
      say("error", (error as Error).message);
    }
  }
  private async record(): Promise<void> {
    const device = this.model.current();
    if (!device) return say("warning", "There is no device.");
    const running = !!device.status?.recording;
    const file = byId<HTMLInputElement>("record-name").value.trim() || "knurl.mcap";
    try {
      const answer = await this.connection().request(running ? "stop" : "record", { device: device.info.i, file });
      setText(byId("record-path"), `${running ? "Recorded" : "Recording"}: ${String(answer.path ?? file)}`);
      if (device.status) device.status.recording = running ? null : String(answer.path ?? file);
      this.recordings();
    } catch (error) {
      say("error", (error as Error).message);
    }
  }
  private recordings(): void {
    for (const { info, status } of this.model.devices.values()) {
      if (!status?.recording) this.recordingSince.delete(info.i);
      else if (!this.recordingSince.has(info.i)) this.recordingSince.set(info.i, performance.now());
    }
    const device = this.model.current();
    const since = device && this.recordingSince.get(device.info.i);
    byId("record").classList.toggle("on", since !== undefined);
    if (since === undefined) return setText(byId("record"), "Record");
    setText(byId("record"), `Stop (${((performance.now() - since) / 1000).toFixed(0)} s)`);
    setText(byId("record-path"), `Recording: ${device?.status?.recording}`);
  }
  private async doctor(run: boolean): Promise<void> {
    const out = byId("doctor-verdict");
    setText(out, run ? "knurl doctor runs; this takes up to a minute ..." : "...");
    try {
      const answer = await this.connection().request("doctor", run ? { run: true } : {});
      const verdict = (answer.verdict ?? answer.doctor ?? answer.result ?? answer) as {
        machine?: { date?: string };
        rates?: { rate: number; fitness: string; reason: string }[];
        findings?: { what: string; grade: string; says: string; mend: string | null }[];
      };
      if (!verdict.rates) {
        setText(out, "knurl doctor has not run here yet.");
        return;
      }
      out.replaceChildren(
        el("p", {}, verdict.machine?.date ? `Of ${verdict.machine.date}:` : ""),
        el("ul.grades", {}, ...verdict.rates.map((rate) => el("li", { class: rate.fitness, title: rate.reason }, `${rate.rate} Hz: ${rate.fitness}`))),
        el("ul.findings", {}, ...(verdict.findings ?? []).filter((finding) => finding.grade !== "good").map((finding) => el("li", { class: finding.grade }, `${finding.what}: ${finding.says}`, ...(finding.mend ? [el("code", {}, finding.mend)] : [])))),
      );
    } catch (error) {
      setText(out, "");
      say("error", (error as Error).message);
    }
  }

  private roles(): void {
    const hello = this.model.hello;
    const control = this.model.can("control") && !this.model.recording;
    for (const id of ["arm", "disarm", "reset", "record", "record-name", "doctor-run"]) (byId(id) as HTMLButtonElement).disabled = !control;
    setText(byId("role"), hello ? { observe: "looks on", render: "may add", control: "controls" }[hello.role] : "");
    byId("role").title = "what this page may do: observe, render or control";
    byId("record-box").hidden = !hello?.recordings;
    byId("control-why").hidden = this.model.can("control") || !hello;
    this.clients();
  }

  private servo(): void {
    const servo = this.model.servo;
    const bar = byId("servo");
    setText(bar, servo ? (servo.connected ? `${servo.name} · pid ${servo.pid}` : servo.trouble || "no servo") : "");
    bar.classList.toggle("bad", !!servo && !servo.connected);
    const tabs = byId("devices");
    const devices = [...this.model.devices.values()];
    const current = this.model.current();
    tabs.replaceChildren(
      ...(devices.length > 1
        ? devices.map((device) =>
            el("button.small", { type: "button", "aria-pressed": String(device === current), click: () => ((this.model.selected = device.info.i), this.model.tell("selected")) }, device.info.name),
          )
        : []),
    );
    const info = current?.info;
    byId("device-facts").replaceChildren(
      ...(info
        ? [
            ["device", `${info.name} (${info.address})`],
            ["profile", [info.profile, info.serial].filter(Boolean).join(", ")],
            ["rate", `${info.rate} Hz`],
            ["workspace", `ball of ${si(info.radius, "m")}`],
            ["peak force", si(info.peak_force, "N")],
            ["k_max", Number.isFinite(current!.kMax()) ? `${Math.round(current!.kMax())} N/m` : "not known"],
            ["lag", info.lag ? si(info.lag, "s") : ""],
          ]
            .filter(([, value]) => value)
            .flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)])
        : [el("dt", {}, "no device"), el("dd", {}, "")]),
    );
  }

  /** A few times a second: state, faults, indicators. */
  slow(): void {
    const device = this.model.current();
    const state = device ? (this.model.recording ? "recording" : device.state) : "no device";
    const badge = byId("state");
    setText(badge, state);
    badge.dataset.state = state;
    const frame = device?.frame;
    const force = frame ? Math.hypot(...frame.force) : 0;
    setText(byId("readout"), frame ? `${frame.p.map((x) => (1e3 * x).toFixed(1).padStart(6)).join(" ")} mm   ${force.toFixed(2)} N` : "");
    const warnings = (frame?.flags ?? []).filter((flag) => flag !== "touching").map((flag) => ({ clamped: "force limited by the supervisor", stale: "no new sample", guardian: "the guardian had zeroed the motors", "near singular": "the arm is near a singular posture", near_singular: "the arm is near a singular posture", "at joint limit": "a joint is at its stop", at_joint_limit: "a joint is at its stop" })[flag] ?? flag);
    setText(byId("flags"), warnings.join(" · "));
    this.faults(device);
    this.indicators(device);
    this.recordings();
  }

  private faults(device: Device | undefined): void {
    const names = device?.frame?.faults ?? [];
    const shown = names.join();
    if (shown === this.faultsShown) return;
    const before = this.faultsShown;
    this.faultsShown = shown;
    const box = byId("faults");
    box.hidden = names.length === 0;
    byId("reset").classList.toggle("primary", names.length > 0);
    byId("arm").classList.toggle("primary", names.length === 0);
    box.replaceChildren(
      ...names.map((name) => {
        const fault = faultOf(name);
        return el("div.fault", { "data-fault": fault.name }, el("strong", {}, `Fault: ${fault.name}`), el("p", {}, fault.cause), el("p.remedy", {}, fault.remedy));
      }),
    );
    if (names.length && shown !== before) say("error", `${device?.info.name}: fault ${names.join(", ").replaceAll("_", " ")}: ${faultOf(names[0]).cause}`);
  }

  private situation(device: Device): Situation {
    const touched = device.felt.filter((item) => (item.felt?.[2] ?? 0) & 1);
    const list = this.lateBefore.get(device) ?? [];
    const now = performance.now();
    list.push({ at: now, count: device.frame?.late ?? 0 });
    while (list.length > 1 && now - list[0].at > 2000) list.shift();
    this.lateBefore.set(device, list);
    return {
      kMax: device.kMax(),
      stiffest: Math.max(0, ...touched.map((item) => { const k = num(item.params.stiffness); return Number.isFinite(k) ? k / (device.claims.get(item.claim)?.frame.scale || 1) : 0; })),
      late: Math.max(0, list[list.length - 1].count - list[0].count),
      forced: this.forced(device),
      vibrations: [...device.items.values()].filter((item) => item.kind === "vibration" && num(item.params.amplitude) > 0).map((item) => num(item.params.frequency, 100)),
      textured: touched.some((item) => num(item.params["texture.amplitude"]) > 0 || num(item.params["snag.k_stick"]) > 0),
    };
  }

  /** Whether a force was on in the last second or so. */
  private forced(device: Device): boolean {
    const { fx, fy, fz } = device.history.columns;
    const until = this.model.now();
    for (let k = device.history.find(until - span); k < device.history.held; k += 16) {
      const place = device.history.place(k);
      if (device.history.t[place] > until) break;
      if (Math.hypot(fx[place], fy[place], fz[place]) > 0.02) return true;
    }
    return false;
  }

  private indicators(device: Device | undefined): void {
    const held = device?.history.held ?? 0;
    const until = this.model.now();
    const buzz = device && held ? buzzAt(device.history, until) : null;
    const energy = device && held ? energyInto(device.history, 10, until) : 0;
    setText(byId("buzz"), buzz ? (buzz.slow > 0.03 && !buzz.buzzes ? "moves" : buzz.buzzes ? `${(buzz.amplitude * 1e3).toFixed(2)} mm at ${buzz.frequency.toFixed(0)} Hz` : "quiet") : "–");
    byId("buzz").classList.toggle("bad", !!buzz?.buzzes);
    setText(byId("energy"), held ? `${energy * 1e3 > 0 ? "+" : ""}${(energy * 1e3).toFixed(1)} mJ` : "–");
    const active = device ? [...new Set([...device.items.values()].filter((item) => giving.includes(item.kind)).map((item) => item.kind.replaceAll("_", " ")))] : [];
    const says = device && held ? [buzzSentence(buzz, this.situation(device)), energySentence(energy, active)].filter(Boolean) : [];
    setText(byId("advice"), says.join(" "));
    byId("advice").hidden = says.length === 0;
    byId("advice-over").hidden = !buzz?.buzzes;
    setText(byId("advice-over"), buzz?.buzzes ? says[0] : "");
  }

  private clients(): void {
    const device = this.model.current();
    const status = device?.status;
    const facts = byId("servo-facts");
    const parts = status ? Object.entries(status.parts).map(([name, us]) => `${name} ${us < 100 ? us.toFixed(2) : us.toFixed(0)}`).join("  ") : "";
    setText(
      facts,
      status
        ? `${status.rate.toFixed(1)} of ${device!.info.rate} Hz · busy ${(100 * status.busy).toFixed(2)} % · cycle ${status.step.toFixed(1)} µs\nlateness median ${status.late_median.toFixed(1)} µs, at most ${status.late_max.toFixed(1)} µs · ${status.late} late cycles · ${status.overruns} overruns${device!.unseen ? ` · ${device!.unseen} reports not seen here` : ""}\ncycle µs: ${parts}`
        : "No servo is connected.",
    );
    facts.classList.toggle("bad", !!status && status.rate < 0.98 * device!.info.rate);
    byId("clients").replaceChildren(
      ...(status?.clients ?? []).map((client) => {
        const what = Object.entries(client.representations ?? {}).map(([kind, count]) => `${count} ${kind.replaceAll("_", " ")}`).join(", ");
        const scales = client.scales ? Object.entries(client.scales).filter(([, share]) => share < 0.995).map(([name, share]) => `${name} ×${share.toFixed(2)}`) : [];
        const marks = [client.silent ? "silent" : "", client.shed ? "shed" : "", client.armed ? "armed" : ""].filter(Boolean);
        return el(
          "tr",
          { class: client.silent || client.shed ? "bad" : "" },
          el("td", {}, el("b", {}, client.name || "unnamed"), el("small", {}, ` ${client.pid} ${marks.join(" ")}`)),
          ...(client.observer
            ? [el("td", { colspan: 4 }, "observes"), el("td", {}, String(client.missed))]
            : [
                el("td", {}, client.rate.toFixed(1)),
                el("td", {}, client.age ? `${(client.age * 1e3).toFixed(2)}` : "–"),
                el("td", { title: `commits ${client.commits}, merged ${client.merged}, refused ${client.refused}` }, `${client.merged}/${client.refused}`),
                el("td", {}, client.gain.toFixed(2)),
                el("td", {}, String(client.missed)),
              ]),
          ...(client.observer ? [] : [el("td.what", {}, what || "nothing", ...(scales.length ? [el("small.warn", {}, ` ${scales.join(" ")}`)] : []))]),
        );
      }),
    );
  }
}
