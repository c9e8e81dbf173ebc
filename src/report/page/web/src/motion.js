/**
 * Motion between configurations: joint values are interpolated, as an arm moves its joints.
 *
 * @typedef {{q: number[], distance: number}} State joint values in rad or m, and the camera's distance from the board in m
 */

const DURATION_MS = 600;

const stillness = window.matchMedia("(prefers-reduced-motion: reduce)");

export class Motion {
  /** @param {(state: State) => void} show */
  constructor(show) {
    this.show = show;
    /** @type {State | null} */
    this.state = null;
    this.frame = 0;
  }

  /** Shows a state at once. */
  set(/** @type {State} */ state) {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.state = state;
    this.show(state);
  }

  /** Moves to a state, from wherever the arm is; at once where the reader prefers reduced motion. */
  moveTo(/** @type {State} */ goal) {
    const from = this.state;
    if (!from || stillness.matches) return this.set(goal);
    cancelAnimationFrame(this.frame);
    const start = performance.now();
    const advance = (/** @type {number} */ now) => {
      const part = Math.min(Math.max((now - start) / DURATION_MS, 0), 1);
      if (part === 1) return this.set(goal);
      const eased = part * part * (3 - 2 * part);
      const between = (/** @type {number} */ a, /** @type {number} */ b) => a + eased * (b - a);
      this.state = { q: from.q.map((value, i) => between(value, goal.q[i])), distance: between(from.distance, goal.distance) };
      this.show(this.state);
      this.frame = requestAnimationFrame(advance);
    };
    this.frame = requestAnimationFrame(advance);
  }

  get moving() {
    return this.frame !== 0;
  }
}
