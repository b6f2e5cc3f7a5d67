// How old a picture is: the servo's clock seen from here, by asking what time it is (NTP's exchange, RFC 5905 section 8, with
// one stamp of the server), and the age of each report that is drawn.

/** Of the last exchanges the one that took the shortest is believed: half of what it took bounds its error. */
export class ServoClock {
  private readonly exchanges: { offset: number; took: number }[] = [];
  private readonly ages = new Float32Array(600);
  private count = 0;
  private last = 0;

  /** Seconds: `sent` and `came` of this clock, `theirs` of the servo's. */
  take(sent: number, came: number, theirs: number): void {
    this.exchanges.push({ offset: theirs - (sent + came) / 2, took: came - sent });
    if (this.exchanges.length > 16) this.exchanges.shift();
  }
  private get best(): { offset: number; took: number } | undefined {
    return this.exchanges.reduce<{ offset: number; took: number } | undefined>((best, one) => (best && best.took <= one.took ? best : one), undefined);
  }
  /** A report of that time has been drawn now. Counted once each. */
  drawn(t: number, now: number): void {
    const best = this.best;
    if (!best || t === this.last) return;
    this.last = t;
    this.ages[this.count++ % this.ages.length] = now + best.offset - t;
  }
  /** ms, from the device's read to the end of drawing; `within`: the offset's error is no larger. */
  get age(): { p50: number; p99: number; within: number } {
    const n = Math.min(this.count, this.ages.length);
    const sorted = this.ages.slice(0, n).sort();
    const at = (share: number) => (n === 0 ? 0 : 1000 * sorted[Math.min(n - 1, Math.floor(share * n))]);
    return { p50: at(0.5), p99: at(0.99), within: 500 * (this.best?.took ?? 0) };
  }
}
