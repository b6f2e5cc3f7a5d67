// The page: puts its parts together, and runs them once a frame.
import { Charts } from "./charts.ts";
import { ServoClock } from "./clock.ts";
import { Connection } from "./connection.ts";
import { Model } from "./model.ts";
import { Panel } from "./panel.ts";
import { Playground } from "./playground.ts";
import { Player } from "./recording.ts";
import { View } from "./scene/view.ts";
import { toggleTheme } from "./theme.ts";
import { byId, download, say, setText, tabs } from "./ui.ts";

const model = new Model();
model.note = (level, text) => say(level, text);

const counters = { frames: 0, messages: 0, reconnects: 0, workP50: 0, workMax: 0, drawP50: 0, rate: 0, items: 0, triangles: 0, calls: 0, renderer: "", ageP50: 0, ageP99: 0, ageWithin: 0 };

const where = new URL("./live", location.href);
where.protocol = where.protocol === "https:" ? "wss:" : "ws:";
const connection: Connection = new Connection(where.href, {
  message: (message) => {
    try {
      model.take(message);
    } catch (error) {
      say("error", (error as Error).message);
    }
  },
  reports: (reports) => model.takeReports(reports),
  strange: (text) => say("error", `knurl-web sent ${text}`),
  link: (state, why, retry) => {
    const banner = byId("banner");
    banner.hidden = state === "open";
    banner.dataset.state = state;
    if (state === "open") {
      if (connection.reconnects > 0) {
        view.forgetAssets();
        say("info", "Connected again.");
      }
      return;
    }
    if (state === "lost") {
      setText(banner, `${why[0].toUpperCase()}${why.slice(1)}; the next attempt is in ${retry} s. What you see is the last that came.`);
      for (const device of model.devices.values()) {
        device.frame = null;
        device.status = null;
      }
      model.forget();
    } else setText(banner, `${why}. Open the URL that knurl-web printed when it started; it has a new token.`);
  },
});

const view = new View(byId<HTMLCanvasElement>("scene"), model, { tip: byId("tip"), scale: byId("scale"), gizmo: byId<HTMLCanvasElement>("gizmo") }, {
  pull: (device, target) => pull(device.info.i, target),
  drag: (device, item, by) => playground.drag(device, item, by),
  say,
});
const charts = new Charts(model);
const panel = new Panel(model, () => connection);
const playground = new Playground(model, () => connection);
const player = new Player(model);
model.asset = (message) => void playground.sent(message);
model.forgetting = () => playground.remember();
model.on("recording", () => view.forgetAssets());

// ---- the mouse as a hand: one request at a time, the newest target wins
let pulling: { device: number; target: [number, number, number] | null } | null = null;
let pullBusy = false;
function pull(device: number, target: [number, number, number] | null): void {
  pulling = { device, target };
  if (!pullBusy) void sendPull();
}
async function sendPull(): Promise<void> {
  pullBusy = true;
  while (pulling) {
    const next = pulling;
    pulling = null;
    try {
      await connection.request("pull", next);
    } catch (error) {
      say("error", (error as Error).message);
    }
  }
  pullBusy = false;
}

// ---- buttons and keys
const chooseTab = tabs(byId("tabs"));
chooseTab("tab-state");
byId("theme").addEventListener("click", toggleTheme);
byId("fit").addEventListener("click", () => view.fit());
byId("follow").addEventListener("click", () => follow());
for (const axis of ["x", "y", "z"] as const) byId(`look-${axis}`).addEventListener("click", () => view.look(axis));
byId("shot").addEventListener("click", () => void shot());
byId("help").addEventListener("click", () => byId<HTMLDialogElement>("help-dialog").showModal());
for (const dialog of document.querySelectorAll("dialog")) dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
for (const button of document.querySelectorAll<HTMLElement>("[data-close]")) button.addEventListener("click", () => button.closest("dialog")?.close());

function follow(): void {
  const on = view.toggleFollow();
  byId("follow").setAttribute("aria-pressed", String(on));
}
async function shot(): Promise<void> {
  const blob = await view.picture();
  if (blob) download("knurl-scene.png", blob);
}
const keys: Record<string, () => void> = {
  "?": () => byId<HTMLDialogElement>("help-dialog").showModal(),
  f: () => view.fit(),
  h: follow,
  x: () => view.look("x"),
  y: () => view.look("y"),
  z: () => view.look("z"),
  t: toggleTheme,
  " ": () => (player.isOpen ? player.toggle() : charts.setPaused(!charts.paused)),
  p: () => charts.setPaused(!charts.paused),
  a: () => byId("arm").click(),
  d: () => byId("disarm").click(),
  r: () => byId("reset").click(),
  o: () => byId("open").click(),
  "1": () => chooseTab("tab-state"),
  "2": () => chooseTab("tab-clients"),
  "3": () => chooseTab("tab-playground"),
  "4": () => chooseTab("tab-log"),
  ",": () => player.step(-0.001),
  ".": () => player.step(0.001),
};
window.addEventListener("keydown", (event) => {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
  if (/^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName)) return;
  if (event.key === " " && /^(BUTTON|SUMMARY)$/.test(target.tagName)) return;
  const action = keys[event.key];
  if (!action) return;
  event.preventDefault();
  action();
});

// ---- files that are dropped
const drop = byId("drop");
window.addEventListener("dragover", (event) => {
  if (!event.dataTransfer?.types.includes("Files")) return;
  event.preventDefault();
  drop.hidden = false;
});
window.addEventListener("dragleave", (event) => {
  if (event.relatedTarget === null) drop.hidden = true;
});
window.addEventListener("drop", (event) => {
  event.preventDefault();
  drop.hidden = true;
  for (const file of event.dataTransfer?.files ?? [])
    if (/\.mcap$/i.test(file.name)) void player.open(file);
    else {
      chooseTab("tab-playground");
      void playground.loadMesh(file);
    }
});

// ---- each frame
const clock = new ServoClock();
window.setInterval(async () => {
  const sent = performance.now() / 1000;
  try {
    const answer = await connection.request("clock");
    clock.take(sent, performance.now() / 1000, Number(answer.t));
  } catch {
    // Not connected, or slow: the next one.
  }
}, 1000);
const work = new Float32Array(600);
const drawing = new Float32Array(600);
const at = new Float64Array(600);
let slow = 0;
function median(of: Float32Array, n: number): number {
  return n === 0 ? 0 : of.slice(0, n).sort()[n >> 1];
}
function frame(now: number): void {
  requestAnimationFrame(frame);
  const begin = performance.now();
  player.tick(now);
  view.draw(now / 1000);
  const drawn = performance.now();
  const newest = model.recording ? null : model.current()?.frame;
  if (newest) clock.drawn(newest.t, drawn / 1000);
  if (now - slow > 125) {
    slow = now;
    panel.slow();
  } else charts.draw();
  const place = counters.frames % work.length;
  work[place] = performance.now() - begin + connection.work;
  drawing[place] = drawn - begin;
  at[place] = now;
  connection.work = 0;
  counters.frames++;
  if (counters.frames % 20 === 0) {
    const n = Math.min(counters.frames, work.length);
    counters.workP50 = median(work, n);
    counters.drawP50 = median(drawing, n);
    counters.workMax = Math.max(...work.subarray(0, n));
    const oldest = counters.frames > work.length ? at[counters.frames % work.length] : at[0];
    counters.rate = (1000 * (n - 1)) / (now - oldest);
    Object.assign(counters, { messages: connection.messages, reconnects: connection.reconnects });
    const age = clock.age;
    Object.assign(counters, { ageP50: age.p50, ageP99: age.p99, ageWithin: age.within });
    const { triangles, calls, by } = view.info;
    Object.assign(counters, { triangles, calls, renderer: by });
  }
  counters.messages = connection.messages;
  counters.reconnects = connection.reconnects;
  counters.items = [...model.devices.values()].reduce((sum, device) => sum + device.items.size, 0);
}

const sizes = new ResizeObserver(() => {
  view.resize();
  charts.resize();
});
sizes.observe(byId("view"));
sizes.observe(byId("charts"));
view.resize();
connection.open();
requestAnimationFrame(frame);

window.addEventListener("error", (event) => say("error", `The page has a mistake: ${event.message}`));
window.addEventListener("unhandledrejection", (event) => say("error", `The page has a mistake: ${event.reason instanceof Error ? event.reason.message : String(event.reason)}`));

// What tests look at.
Object.assign(window, {
  knurl: { model, scene: view.scene, counters, view, charts, player, connection, resetCounters: () => void (counters.frames = 0) },
});
