// Reports of one device, column by column, in a ring. A recording uses the same, as large as it is.

/** Names of the columns, in the order of the binary message (after t). */
export const names = ["px", "py", "pz", "vx", "vy", "vz", "fx", "fy", "fz", "late", "step", "scene", "state"] as const;
export type Column = (typeof names)[number];

export class History {
  readonly t: Float64Array;
  readonly columns: Record<Column, Float32Array>;
  /** Reports ever added; the newest is at (count - 1) % capacity. */
  count = 0;
  constructor(readonly capacity: number) {
    this.t = new Float64Array(capacity);
    this.columns = Object.fromEntries(names.map((name) => [name, new Float32Array(capacity)])) as Record<Column, Float32Array>;
  }
  /** How many are held. */
  get held(): number {
    return Math.min(this.count, this.capacity);
  }
  get last(): number {
    return this.count === 0 ? 0 : this.t[(this.count - 1) % this.capacity];
  }
  get first(): number {
    return this.count === 0 ? 0 : this.t[(this.count - this.held) % this.capacity];
  }
  clear(): void {
    this.count = 0;
  }
  /** `row`: 13 numbers from `at` on, in the order of `names`. */
  push(t: number, row: ArrayLike<number>, at = 0): void {
    if (this.count > 0 && t < this.last) this.clear(); // a servo that was started anew
    const place = this.count % this.capacity;
    this.t[place] = t;
    for (let k = 0; k < names.length; k++) this.columns[names[k]][place] = row[at + k];
    this.count++;
  }
  /** Where in the ring the k-th that is held is (0: the oldest). */
  place(k: number): number {
    return (this.count - this.held + k) % this.capacity;
  }
  /** The first k that is held with t >= `time`; held where there is none. */
  find(time: number): number {
    let low = 0;
    let high = this.held;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.t[this.place(middle)] < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** [t0, t1] in at most 2 `buckets` points: the least and the greatest of each bucket, so that no peak is lost. All columns
      share their times. */
  thin(t0: number, t1: number, buckets: number, wanted: Column[]): { t: number[]; values: number[][] } {
    const from = Math.max(0, this.find(t0) - 1);
    const to = Math.min(this.held, this.find(t1) + 1);
    const n = to - from;
    const t: number[] = [];
    const values: number[][] = wanted.map(() => []);
    if (n <= 0) return { t, values };
    const columns = wanted.map((name) => this.columns[name]);
    if (n <= 2 * buckets) {
      for (let k = from; k < to; k++) {
        const place = this.place(k);
        t.push(this.t[place]);
        for (let c = 0; c < columns.length; c++) values[c].push(columns[c][place]);
      }
      return { t, values };
    }
    // Buckets stand still as the window moves on, or the picture would shimmer.
    const stride = Math.ceil(n / buckets);
    const begin = this.count - this.held + from;
    const start = begin - (begin % stride);
    for (let b = Math.max(start, this.count - this.held); b < this.count - this.held + to; b += stride) {
      const end = Math.min(b + stride, this.count - this.held + to);
      const half = this.t[b % this.capacity];
      const late = this.t[(end - 1) % this.capacity];
      t.push(half, late > half ? (half + late) / 2 : half + 1e-9);
      for (let c = 0; c < columns.length; c++) {
        let low = Infinity;
        let high = -Infinity;
        let lowAt = 0;
        let highAt = 0;
        for (let k = b; k < end; k++) {
          const value = columns[c][k % this.capacity];
          if (value < low) (low = value), (lowAt = k);
          if (value > high) (high = value), (highAt = k);
        }
        if (lowAt <= highAt) values[c].push(low, high);
        else values[c].push(high, low);
      }
    }
    return { t, values };
  }

  /** [t0, t1] as CSV: what `names` says, with units in the head. */
  csv(t0: number, t1: number): string {
    const units = ["m", "m", "m", "m/s", "m/s", "m/s", "N", "N", "N", "us", "us", "N", ""];
    const lines = ["t [s]," + names.map((name, k) => (units[k] ? `${name} [${units[k]}]` : name)).join(",")];
    for (let k = this.find(t0); k < this.held; k++) {
      const place = this.place(k);
      if (this.t[place] > t1) break;
      lines.push([this.t[place].toFixed(6), ...names.map((name) => +this.columns[name][place].toPrecision(7))].join(","));
    }
    return lines.join("\n") + "\n";
  }
}
