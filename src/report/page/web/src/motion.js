/**
 * Motion between configurations, of joint values in rad or m: they are interpolated, as an arm moves its joints.
 */

const DURATION_MS = 600;

const stillness = window.matchMedia("(prefers-reduced-motion: reduce)");

export class Motion {
  /** @param {(q: number[]) => void} show */
  constructor(show) {
    this.show = show;
    /** @type {number[] | null} what is shown now */
    this.q = null;
    this.frame = 0;
  }

  /** Shows a configuration at once. */
  set(/** @type {number[]} */ q) {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.q = q;
    this.show(q);
  }

  /** Moves to a configuration, from wherever the arm is; at once where the reader prefers reduced motion. */
  moveTo(/** @type {number[]} */ goal) {
    const from = this.q;
    if (!from || stillness.matches) return this.set(goal);
    cancelAnimationFrame(this.frame);
    const start = performance.now();
    const advance = (/** @type {number} */ now) => {
      const part = Math.min(Math.max((now - start) / DURATION_MS, 0), 1);
      if (part === 1) return this.set(goal);
      const eased = part * part * (3 - 2 * part);
      this.q = from.map((value, i) => value + eased * (goal[i] - value));
      this.show(this.q);
      this.frame = requestAnimationFrame(advance);
    };
    this.frame = requestAnimationFrame(advance);
  }

  get moving() {
    return this.frame !== 0;
  }
}
