// Strip charts. One is drawn a frame, by turns, so that a frame's work stays small.
import uPlot from "uplot";
import type { Column } from "./history.ts";
import type { Device, Model } from "./model.ts";
import { onTheme, palette } from "./theme.ts";
import { byId, download, el, say, setText } from "./ui.ts";

interface Threshold {
  at: number;
  text: string;
}
interface Spec {
  id: string;
  title: string;
  unit: string;
  /** Of the history; factor to the unit. */
  columns?: { name: Column; label: string; factor: number }[];
  /** Or of the status that comes four times a second. */
  status?: "age" | "parts";
  thresholds?(device: Device): Threshold[];
  /** The least span of the y axis. */
  least: number;
  zero?: boolean;
}

const xyz = (prefix: "p" | "v" | "f", factor: number): Spec["columns"] =>
  ["x", "y", "z"].map((axis) => ({ name: `${prefix}${axis}` as Column, label: axis, factor }));

const specs: Spec[] = [
  {
    id: "position", title: "Position", unit: "mm", columns: xyz("p", 1e3), least: 2,
    thresholds: ({ info }) => [{ at: 1e3 * (info.centre[2] + info.radius), text: "workspace" }, { at: 1e3 * (info.centre[2] - info.radius), text: "workspace" }],
  },
  { id: "velocity", title: "Velocity", unit: "mm/s", columns: xyz("v", 1e3), least: 20, thresholds: () => [{ at: 1500, text: "fault" }, { at: -1500, text: "fault" }] },
  {
    id: "force", title: "Force", unit: "N", columns: [...xyz("f", 1)!, { name: "scene", label: "asked for", factor: 1 }], least: 0.5,
    thresholds: ({ info }) => [{ at: info.peak_force, text: "peak" }, { at: -info.peak_force, text: "peak" }],
  },
  {
    id: "lateness", title: "Lateness", unit: "µs", columns: [{ name: "late", label: "read", factor: 1 }, { name: "step", label: "written", factor: 1 }], least: 50, zero: true,
    thresholds: ({ info }) => [{ at: 0.5e6 / info.rate, text: "half a period" }, { at: 1e6 / info.rate, text: "period: late" }],
  },
  { id: "parts", title: "Cycle parts", unit: "µs", status: "parts", least: 5, zero: true },
  { id: "age", title: "Age at use", unit: "ms", status: "age", least: 1, zero: true },
];

const tints = ["#5aa9e6", "#e0a458", "#7fb069", "#b78be0", "#e27d9b", "#3fc1a5", "#c9b458", "#8fa3bf"];

class Chart {
  private plot: uPlot | null = null;
  private labels = "";
  readonly box: HTMLElement;
  private readonly holder: HTMLElement;
  thresholds: Threshold[] = [];
  private width = 0;
  private height = 0;
  constructor(
    readonly spec: Spec,
    private readonly charts: Charts,
  ) {
    this.holder = el("div.plot");
    this.box = el("figure.chart", { id: `chart-${spec.id}`, "aria-label": `${spec.title} in ${spec.unit} over time` }, el("figcaption", {}, spec.title, el("span.unit", {}, ` ${spec.unit}`), el("span.legend")), this.holder);
  }
  /** Asking for it in each frame would lay the page out in each. */
  measure(): void {
    this.width = this.holder.clientWidth;
    this.height = this.holder.clientHeight;
  }
  reset(): void {
    this.plot?.destroy();
    this.plot = null;
    this.labels = "";
  }
  private build(labels: string[], tint: string[]): void {
    this.plot?.destroy();
    const p = palette();
    const { spec } = this;
    const legend = this.box.querySelector(".legend")!;
    legend.replaceChildren(
      ...labels.map((label, k) => {
        const mark = el("i");
        mark.style.background = tint[k];
        return el("span", {}, mark, label);
      }),
    );
    const axis: uPlot.Axis = { stroke: p.text, grid: { stroke: p.lines, width: 1 }, ticks: { show: false }, font: "10px system-ui, sans-serif" };
    this.plot = new uPlot(
      {
        width: Math.max(80, this.width),
        height: Math.max(40, this.height),
        legend: { show: false },
        padding: [6, 10, 0, 0],
        cursor: { sync: { key: "knurl" }, drag: { x: true, y: false }, points: { size: 5 } },
        scales: {
          x: { time: false, auto: false, range: () => this.charts.window().map((t) => t - this.charts.origin()) as [number, number] },
          y: {
            range: (_u, low, high) => {
              if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) return spec.zero ? [0, spec.least] : [-spec.least / 2, spec.least / 2];
              if (spec.zero) return [0, Math.max(spec.least, 1.1 * high)];
              const middle = (low + high) / 2;
              const half = Math.max(spec.least / 2, 0.55 * (high - low));
              return [middle - half, middle + half];
            },
          },
        },
        series: [{}, ...labels.map((label, k) => ({ label, stroke: tint[k], width: label === "asked for" ? 0.6 : 1.2, points: { show: false }, spanGaps: true }))],
        axes: [
          { ...axis, size: 18, gap: 2, space: 60, values: (_u, splits) => splits.map((t) => `${+t.toFixed(3)}`) },
          { ...axis, size: 44, gap: 3, space: 24, values: (_u, splits) => splits.map((v) => `${+v.toPrecision(4)}`) },
        ],
        hooks: {
          draw: [(u) => this.mark(u)],
          setSelect: [
            (u) => {
              if (u.select.width < 4) return;
              const origin = this.charts.origin();
              this.charts.zoom(origin + u.posToVal(u.select.left, "x"), origin + u.posToVal(u.select.left + u.select.width, "x"));
              u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
            },
          ],
        },
      },
      [[], ...labels.map(() => [])],
      this.holder,
    );
    this.plot.over.addEventListener("dblclick", () => this.charts.unzoom());
  }
  /** Thresholds, and where a recording is looked at. */
  private mark(u: uPlot): void {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = palette().warn;
    ctx.setLineDash([4, 4]);
    ctx.lineWidth = 1;
    ctx.font = `${10 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textAlign = "left";
    ctx.textBaseline = "bottom";
    for (const { at, text } of this.thresholds) {
      const y = u.valToPos(at, "y", true);
      if (!(y >= bbox.top && y <= bbox.top + bbox.height)) continue;
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
      ctx.fillText(text, bbox.left + 4, y);
    }
    const cursor = this.charts.cursor();
    if (cursor !== null) {
      const x = u.valToPos(cursor - this.charts.origin(), "x", true);
      ctx.setLineDash([]);
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    }
    ctx.restore();
  }
  draw(device: Device): void {
    if (!this.width) return;
    const [t0, t1] = this.charts.window();
    const origin = this.charts.origin();
    const { spec } = this;
    this.thresholds = spec.thresholds?.(device) ?? [];
    let data: uPlot.AlignedData;
    if (spec.columns) {
      const labels = spec.columns.map((column) => column.label);
      if (this.labels !== labels.join()) {
        this.labels = labels.join();
        this.build(labels, spec.columns.length > 2 ? palette().axes : tints);
      }
      const buckets = Math.max(60, Math.min(400, Math.round(this.width / 2)));
      const thin = device.history.thin(t0, t1, buckets, spec.columns.map((column) => column.name));
      for (const [c, column] of spec.columns.entries()) if (column.factor !== 1) for (let k = 0; k < thin.values[c].length; k++) thin.values[c][k] *= column.factor;
      for (let k = 0; k < thin.t.length; k++) thin.t[k] -= origin;
      data = [thin.t, ...thin.values];
    } else {
      const samples = device.ages.filter((sample) => sample.t >= t0 - 1 && sample.t <= t1 + 1);
      const keys = new Set<string>();
      for (const sample of samples) for (const key of spec.status === "age" ? sample.age.keys() : Object.keys(sample.parts)) if (key !== "sleep") keys.add(key);
      const labels = [...keys].slice(0, tints.length);
      if (this.labels !== labels.join() || !this.plot) {
        this.labels = labels.join();
        this.build(labels, tints);
      }
      data = [
        samples.map((sample) => sample.t - origin),
        ...labels.map((key) => samples.map((sample) => (spec.status === "age" ? (sample.age.get(key) === undefined ? null : sample.age.get(key)! * 1e3) : (sample.parts[key] ?? null)))),
      ];
    }
    if (this.plot!.width !== this.width || this.plot!.height !== this.height) this.plot!.setSize({ width: this.width, height: this.height });
    this.plot!.setData(data, true);
  }
  get canvas(): HTMLCanvasElement | null {
    return this.plot?.ctx.canvas ?? null;
  }
}

export class Charts {
  readonly charts: Chart[];
  private turn = 0;
  private span = 10;
  paused = false;
  private pausedAt = 0;
  private frozen: [number, number] | null = null;
  constructor(private readonly model: Model) {
    this.charts = specs.map((spec) => new Chart(spec, this));
    byId("charts").append(...this.charts.map((chart) => chart.box));
    onTheme(() => this.charts.forEach((chart) => chart.reset()));
    byId("charts").addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const [t0, t1] = this.window();
        const factor = event.deltaY > 0 ? 1.25 : 0.8;
        if (this.frozen) {
          const middle = (t0 + t1) / 2;
          const half = Math.min(600, Math.max(0.005, ((t1 - t0) / 2) * factor));
          this.frozen = [middle - half, middle + half];
        } else this.setSpan(Math.min(30, Math.max(0.1, this.span * factor)));
      },
      { passive: false },
    );
    byId<HTMLSelectElement>("span").addEventListener("change", (event) => {
      this.span = Number((event.target as HTMLSelectElement).value);
      this.frozen = null;
      this.setPaused(false);
    });
    byId("pause").addEventListener("click", () => this.setPaused(!this.paused));
    byId("csv").addEventListener("click", () => this.csv());
    byId("png").addEventListener("click", () => void this.png());
    model.on("selected", () => this.unzoom());
    model.on("recording", () => this.unzoom());
  }
  private setSpan(span: number): void {
    this.span = span;
    const select = byId<HTMLSelectElement>("span");
    select.value = [...select.options].some((option) => Number(option.value) === span) ? String(span) : "";
  }
  setPaused(on: boolean): void {
    if (on === this.paused && !this.frozen) return;
    if (on && !this.paused) this.pausedAt = this.model.now();
    this.frozen = on ? (this.frozen ?? this.window()) : null;
    this.paused = on;
    const button = byId("pause");
    button.setAttribute("aria-pressed", String(on));
    setText(button, on ? "Go on" : "Pause");
  }
  zoom(t0: number, t1: number): void {
    this.setPaused(true);
    this.frozen = [t0, t1];
  }
  unzoom(): void {
    this.frozen = null;
    this.setPaused(false);
  }
  window(): [number, number] {
    if (this.frozen) return this.frozen;
    const now = this.model.now();
    // A recording shows what is around the cursor.
    if (this.model.recording) {
      const { first, last } = this.model.recording.history;
      const span = Math.min(this.span, Math.max(0.01, last - first));
      const from = Math.min(Math.max(first, now - span / 2), Math.max(first, last - span));
      return [from, from + span];
    }
    return [now - this.span, now];
  }
  cursor(): number | null {
    return this.model.recording ? this.model.cursor : null;
  }
  /** What the axis counts from: a recording from its beginning, else from now; where it is paused, from then. */
  origin(): number {
    return this.model.recording ? 0 : this.paused ? this.pausedAt : this.model.now();
  }
  /** Draws one chart. */
  draw(): void {
    const device = this.model.current();
    if (!device) return;
    this.turn = (this.turn + 1) % this.charts.length;
    this.charts[this.turn].draw(device);
  }
  resize(): void {
    for (const chart of this.charts) chart.measure();
    const device = this.model.current();
    if (device) for (const chart of this.charts) chart.draw(device);
  }
  csv(): void {
    const device = this.model.current();
    if (!device?.history.held) return say("warning", "There is nothing to export yet.");
    const [t0, t1] = this.window();
    download(`${device.info.name}.csv`, device.history.csv(t0, t1), "text/csv");
  }
  async png(): Promise<void> {
    const canvases = this.charts.map((chart) => chart.canvas).filter((canvas) => canvas !== null && canvas.width > 0) as HTMLCanvasElement[];
    if (!canvases.length) return say("warning", "There is nothing to export yet.");
    const out = document.createElement("canvas");
    out.width = Math.max(...canvases.map((canvas) => canvas.width));
    const head = 18 * devicePixelRatio;
    out.height = canvases.reduce((sum, canvas) => sum + canvas.height + head, 0);
    const ctx = out.getContext("2d")!;
    ctx.fillStyle = getComputedStyle(document.body).backgroundColor;
    ctx.fillRect(0, 0, out.width, out.height);
    let y = 0;
    this.charts.forEach((chart) => {
      if (!chart.canvas?.width) return;
      ctx.fillStyle = palette().text;
      ctx.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
      ctx.fillText(`${chart.spec.title} [${chart.spec.unit}]`, 4, y + 0.75 * head);
      ctx.drawImage(chart.canvas, 0, y + head);
      y += chart.canvas.height + head;
    });
    const blob = await new Promise<Blob | null>((resolve) => out.toBlob(resolve, "image/png"));
    if (blob) download(`${this.model.current()?.info.name ?? "knurl"}.png`, blob);
  }
}
