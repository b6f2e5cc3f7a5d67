// Colours, of the page (style.css) and of what is drawn on a canvas.

export type Theme = "dark" | "light";

const systemDark = window.matchMedia("(prefers-color-scheme: dark)");
let chosen: Theme | null = null;
try {
  const kept = localStorage.getItem("knurl theme");
  if (kept === "dark" || kept === "light") chosen = kept;
} catch {
  // no storage: the system's
}
const listeners: (() => void)[] = [];

export function theme(): Theme {
  return chosen ?? (systemDark.matches ? "dark" : "light");
}
function apply(): void {
  document.documentElement.dataset.theme = theme();
  for (const listener of listeners) listener();
}
export function toggleTheme(): void {
  chosen = theme() === "dark" ? "light" : "dark";
  try {
    localStorage.setItem("knurl theme", chosen);
  } catch {
    // not kept
  }
  apply();
}
export function onTheme(listener: () => void): void {
  listeners.push(listener);
}
systemDark.addEventListener("change", apply);
apply();

export interface Palette {
  background: number;
  grid: number;
  hand: number;
  arm: number;
  workspace: number;
  force: number;
  torque: number;
  contact: number;
  asleep: number;
  claims: number[];
  mine: number;
  /** x, y, z, and a sum. */
  axes: [string, string, string, string];
  text: string;
  lines: string;
  warn: string;
}
const dark: Palette = {
  background: 0x14171c, grid: 0x2a303a, hand: 0xf2f4f8, arm: 0x8a93a3, workspace: 0x39424f, force: 0xff9d4d, torque: 0xc792ea, contact: 0xffe08a,
  asleep: 0x5c6470, claims: [0x5aa9e6, 0xb78be0, 0xe0a458, 0x7fb069, 0xe27d9b, 0x8fa3bf], mine: 0x3fc1a5,
  axes: ["#ff7b72", "#7ee08a", "#79b8ff", "#e6e9ef"], text: "#aab2bf", lines: "#2a303a", warn: "#f0b429",
};
const light: Palette = {
  background: 0xf7f8fa, grid: 0xd9dee6, hand: 0x1d232b, arm: 0x6d7786, workspace: 0xc2cad5, force: 0xd9600a, torque: 0x8e44ad, contact: 0xb88600,
  asleep: 0xa9b1bc, claims: [0x1f77b4, 0x7d4fb3, 0xb06f12, 0x4b8a35, 0xb83e66, 0x51647f], mine: 0x0d8f75,
  axes: ["#d1242f", "#1a7f37", "#0969da", "#24292f"], text: "#57606a", lines: "#e1e5eb", warn: "#b35900",
};
export function palette(): Palette {
  return theme() === "dark" ? dark : light;
}

/** Colour of a share of the peak force, 0 to 1: cool, yellow, red. */
export function heat(share: number): [number, number, number] {
  const x = Math.min(1, Math.max(0, share));
  const stops: [number, number, number][] = [[0.28, 0.5, 0.72], [0.3, 0.75, 0.6], [0.98, 0.8, 0.3], [0.93, 0.27, 0.2]];
  const at = Math.sqrt(x) * 3;
  const k = Math.min(2, Math.floor(at));
  const s = at - k;
  return [0, 1, 2].map((c) => stops[k][c] + s * (stops[k + 1][c] - stops[k][c])) as [number, number, number];
}
