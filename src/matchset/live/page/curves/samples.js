// The last 30 s of a number, as least, largest and greatest deviation of each twentieth of a second. So a curve costs
// the same at 30 and at 500 samples a second, and a page that is open for a week holds no more than one that was opened now.

export const SECONDS = 30;
export const PER_SECOND = 20;
const CAPACITY = SECONDS * PER_SECOND + 2;

export class Samples {
  constructor() {
    this.low = new Float64Array(CAPACITY);
    this.high = new Float64Array(CAPACITY);
    this.sigma = new Float64Array(CAPACITY);
    this.bin = new Float64Array(CAPACITY); // which twentieth of a second a place holds
    this.lost = new Uint8Array(CAPACITY);
    this.clear();
  }

  clear() {
    this.bin.fill(-1);
    this.last = -Infinity;
  }

  // NaN: it was lost.
  add(time, value, sigma) {
    this.last = time;
    const bin = Math.floor(time * PER_SECOND);
    const place = bin % CAPACITY;
    if (this.bin[place] !== bin) {
      this.bin[place] = bin;
      this.low[place] = this.high[place] = NaN;
      this.sigma[place] = this.lost[place] = 0;
    }
    if (Number.isNaN(value)) { this.lost[place] = 1; return; }
    if (!(this.low[place] <= value)) this.low[place] = value;
    if (!(this.high[place] >= value)) this.high[place] = value;
    if (sigma > this.sigma[place]) this.sigma[place] = sigma;
  }

  // Calls take(seconds before now, low, high, sigma, lost) for each twentieth of a second that has a sample, oldest first.
  each(take) {
    const newest = Math.floor(this.last * PER_SECOND);
    for (let bin = Math.max(0, newest - CAPACITY + 2); bin <= newest; bin++) {
      const place = bin % CAPACITY;
      if (this.bin[place] !== bin) continue;
      const ago = this.last - Math.min((bin + 0.5) / PER_SECOND, this.last);
      take(ago, this.low[place], this.high[place], this.sigma[place], this.lost[place]);
    }
  }
}
