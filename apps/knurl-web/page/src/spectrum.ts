// Whether the hand buzzes, and how much energy a device gave it. The formulas are in ../page.md.
import type { History } from "./history.ts";

/** In place; lengths of a power of two. */
export function fft(re: Float64Array, im: Float64Array): void {
  const n = re.length;
  for (let i = 1, j = 0; i < n; i++) {
    let bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) {
      [re[i], re[j]] = [re[j], re[i]];
      [im[i], im[j]] = [im[j], im[i]];
    }
  }
  for (let size = 2; size <= n; size <<= 1) {
    const angle = (-2 * Math.PI) / size;
    const wr = Math.cos(angle);
    const wi = Math.sin(angle);
    for (let start = 0; start < n; start += size) {
      let ur = 1;
      let ui = 0;
      for (let k = 0; k < size / 2; k++) {
        const a = start + k;
        const b = a + size / 2;
        const xr = re[b] * ur - im[b] * ui;
        const xi = re[b] * ui + im[b] * ur;
        re[b] = re[a] - xr;
        im[b] = im[a] - xi;
        re[a] += xr;
        im[a] += xi;
        [ur, ui] = [ur * wr - ui * wi, ur * wi + ui * wr];
      }
    }
  }
}

export interface Buzz {
  /** Dominant frequency above 15 Hz (Hz). */
  frequency: number;
  /** Amplitude of the position at it (m), over all axes. */
  amplitude: number;
  /** Root mean square of the speed below 15 Hz (m/s). */
  slow: number;
  /** Its share of the power above 15 Hz. */
  share: number;
  /** The hand is at rest otherwise, and buzzes. */
  buzzes: boolean;
}

export const lowest = 15; // Hz: below it a hand moves by itself
export const restSpeed = 0.03; // m/s
export const leastAmplitude = 0.02e-3; // m: below it encoders tick

/** Of velocities (m/s), x, y, z, each of the same length (a power of two), `rate` a second. */
export function buzzOf(axes: Float64Array[], rate: number): Buzz {
  const n = axes[0].length;
  const power = new Float64Array(n / 2);
  for (const axis of axes) {
    let mean = 0;
    for (const value of axis) mean += value / n;
    const re = new Float64Array(n);
    const im = new Float64Array(n);
    for (let k = 0; k < n; k++) re[k] = (axis[k] - mean) * (0.5 - 0.5 * Math.cos((2 * Math.PI * k) / n)); // Hann
    fft(re, im);
    for (let k = 0; k < n / 2; k++) power[k] += re[k] * re[k] + im[k] * im[k];
  }
  const bin = rate / n;
  const from = Math.ceil(lowest / bin);
  let peak = from;
  let above = 0;
  let below = 0;
  // Amplitudes of velocity count by 1 / f, since it is the position's amplitude that is asked for.
  for (let k = 1; k < n / 2; k++) {
    if (k < from) below += power[k];
    else {
      above += power[k];
      if (power[k] / (k * k) > power[peak] / (peak * peak)) peak = k;
    }
  }
  let line = 0;
  let moment = 0;
  for (let k = Math.max(from - 2, peak - 3); k <= Math.min(n / 2 - 1, peak + 3); k++) {
    line += power[k];
    moment += power[k] * k;
  }
  const frequency = line > 0 ? (moment / line) * bin : 0;
  const norm = (n * n * 3) / 8; // mean square of the Hann window is 3/8
  const speed = 2 * Math.sqrt(line / norm); // amplitude
  const amplitude = frequency > 0 ? speed / (2 * Math.PI * frequency) : 0;
  const slow = Math.sqrt((2 * below) / norm);
  const share = above > 0 ? Math.min(1, line / above) : 0;
  return {
    frequency,
    amplitude,
    slow,
    share,
    buzzes: amplitude > leastAmplitude && slow < restSpeed && share > 0.3,
  };
}

export const span = 1.024; // s
const points = 1024;

/** Of the last 1.024 s before `until`; null: there is no such time yet. */
export function buzzAt(history: History, until = history.last): Buzz | null {
  const begin = until - span;
  const first = history.find(begin);
  const last = Math.min(history.held - 1, history.find(until));
  if (history.held < 256 || history.t[history.place(0)] > begin || last - first < 128) return null;
  const axes = [history.columns.vx, history.columns.vy, history.columns.vz].map((column) => {
    const out = new Float64Array(points);
    let k = first;
    for (let i = 0; i < points; i++) {
      const time = begin + (span * i) / points;
      while (k < last && history.t[history.place(k + 1)] <= time) k++;
      const a = history.place(k);
      const b = history.place(Math.min(k + 1, last));
      const gap = history.t[b] - history.t[a];
      const share = gap > 0 ? Math.min(1, Math.max(0, (time - history.t[a]) / gap)) : 0;
      out[i] = column[a] + share * (column[b] - column[a]);
    }
    return out;
  });
  return buzzOf(axes, points / span);
}

/** Work of the sent force on the hand (J), over [until - seconds, until]: the sum of F_k . (p_k+1 - p_k). A cycle's force is held until
    the next, so this is its work, delay included; a filtered velocity would come too late. */
export function energyInto(history: History, seconds: number, until = history.last): number {
  const { px, py, pz, fx, fy, fz } = history.columns;
  let sum = 0;
  let before = -1;
  for (let k = history.find(until - seconds); k < history.held; k++) {
    const place = history.place(k);
    if (history.t[place] > until) break;
    // A hole in the reports says nothing about the time between.
    if (before >= 0 && history.t[place] - history.t[before] < 0.05)
      sum += fx[before] * (px[place] - px[before]) + fy[before] * (py[place] - py[before]) + fz[before] * (pz[place] - pz[before]);
    before = place;
  }
  return sum;
}

export interface Situation {
  kMax: number; // N/m; infinite: not known
  stiffest: number; // N/m of what is touched, as asked for
  late: number; // late cycles in the last seconds
  forced: boolean; // a force was on
  vibrations: number[]; // Hz, of those that are rendered on purpose
  textured: boolean;
}

/** What a person should know about a buzz; "" where there is nothing to say. */
export function buzzSentence(buzz: Buzz | null, s: Situation): string {
  if (!buzz || !buzz.buzzes) return "";
  const head = `${(buzz.amplitude * 1e3).toFixed(2)} mm at ${buzz.frequency.toFixed(0)} Hz`;
  const meant = s.vibrations.find((f) => Math.abs(f - buzz.frequency) < Math.max(3, 0.05 * f));
  if (!s.forced) return `The hand shakes: ${head}, and no force of the device is on: a table that shakes, or a noisy encoder, usually causes this.`;
  if (meant !== undefined) return `The hand vibrates: ${head}, as a vibration of ${meant} Hz asks for.`;
  const bound = Number.isFinite(s.kMax) ? ` (${Math.round(s.kMax)} N/m)` : "";
  if (s.stiffest > s.kMax)
    return `The hand buzzes: ${head}. What it touches asks for ${Math.round(s.stiffest)} N/m, more than the device's k_max${bound}; lower the stiffness or add damping of 1 to 3 N s/m.`;
  if (s.late > 0)
    return `The hand buzzes: ${head}. The servo had ${s.late} late cycles meanwhile, which usually cause this: run knurl doctor; until then lower the stiffness.`;
  if (s.textured && buzz.frequency > 60)
    return `The hand buzzes: ${head}. A texture finer than the encoder usually causes this; give it a longer wavelength, or less amplitude.`;
  return `The hand buzzes: ${head}. A stiffness above the device's k_max${bound}, a late servo, or too little damping usually cause this; lower the stiffness or add damping of 1 to 3 N s/m.`;
}

/** What a person should know about energy (J over 10 s); "" where it is as it should be. */
export function energySentence(energy: number, activeEffects: string[]): string {
  if (energy < 0.02) return "";
  const given = `In 10 s the device gave the hand ${(energy * 1e3).toFixed(0)} mJ.`;
  return activeEffects.length
    ? `${given} ${activeEffects.join(", ")} may do so; surfaces alone never give more than they took.`
    : `${given} Surfaces take energy or return it; what gives goes on its own: a moving surface, forces from the application's loop, or a wall that is too stiff.`;
}
