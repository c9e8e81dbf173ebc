/** The time of the tour that is shown, and its running on. */

/** Playing speeds, as multiples of real time. */
export const SPEEDS = [1, 2, 4, 8];

/** @typedef {"played" | "sought" | "chosen"} Cause why the time is another: it ran on, or the reader set it or chose a pose */

export class Player {
  /** @param {import("./timeline.js").Timeline} timeline */
  constructor(timeline) {
    this.timeline = timeline;
    /** In s from the beginning of the tour. */
    this.time = timeline.pictures[0]?.start_s ?? 0;
    this.speed = SPEEDS[0];
    /** Of the next step, or 0. */
    this.frame = 0;
    /** @type {((time: number, cause: Cause) => void)[]} */
    this.timeListeners = [];
    /** @type {((playing: boolean) => void)[]} */
    this.playListeners = [];
  }

  /** @param {(time: number, cause: Cause) => void} listener told after every change of the time */
  onTime(listener) {
    this.timeListeners.push(listener);
  }

  /** @param {(playing: boolean) => void} listener told when playing begins and ends */
  onPlay(listener) {
    this.playListeners.push(listener);
  }

  get playing() {
    return this.frame !== 0;
  }

  /** Goes to a time, or to the nearest that the tour has. */
  seek(/** @type {number} */ time, /** @type {Cause} */ cause = "sought") {
    this.time = Math.min(Math.max(time, 0), this.timeline.end);
    for (const listener of this.timeListeners) listener(this.time, cause);
  }

  /** Lets the time run on, or no longer. From the end, and from the first pose where the tour begins before it, it runs from the start. */
  play(/** @type {boolean} */ on) {
    if (on === this.playing) return;
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    if (on) {
      const first = this.timeline.pictures[0]?.start_s;
      if (this.time >= this.timeline.end || this.time === first) this.seek(0);
      let last = performance.now();
      const run = (/** @type {number} */ now) => {
        this.frame = requestAnimationFrame(run);
        const passed = Math.max(now - last, 0) / 1000;
        last = now;
        this.seek(this.time + this.speed * passed, "played");
        if (this.time >= this.timeline.end) this.play(false);
      };
      this.frame = requestAnimationFrame(run);
    }
    for (const listener of this.playListeners) listener(on);
  }
}
