/**
 * A tour in time, in double precision and without three.js: where the arm is when.
 *
 * All joints of a leg start and stop together: for `ramp_s` they speed up, and for as long they slow down, evenly but for `ease_s` at the
 * beginning and the end of that, in which the acceleration grows and falls evenly.
 *
 * @typedef {{start_s: number, seconds: number, ramp_s: number, ease_s?: number, to: number[]}} Leg
 * @typedef {{from: number | null, to: number | null, start_s: number, seconds: number, legs: Leg[]}} Move
 * @typedef {{id: number, start_s: number, seconds: number}} PictureTime
 * @typedef {{measured_m: number[], pairs?: string[][], nearest?: number[]}} Curve
 */

/** The share of a leg that is done `time` seconds after it began: 0 before, 1 after it. */
function shareDone(/** @type {Leg} */ { seconds, ramp_s, ease_s = 0 }, /** @type {number} */ time) {
  const spent = Math.min(Math.max(time, 0), seconds);
  const left = seconds - spent;
  if (left === 0) return 1;
  const pass = seconds - ramp_s;
  const acceleration = 1 / ((ramp_s - ease_s) * pass);
  const eased = (/** @type {number} */ t) => (acceleration * t ** 3) / (6 * ease_s);
  const inFirstHalf = (/** @type {number} */ t) => {
    if (t >= ramp_s) return (t - ramp_s / 2) / pass;
    if (t < ease_s) return eased(t);
    if (t > ramp_s - ease_s) return (t - ramp_s / 2) / pass + eased(ramp_s - t);
    return acceleration * ((t - ease_s / 2) ** 2 / 2 + ease_s ** 2 / 24);
  };
  return spent <= left ? inFirstHalf(spent) : 1 - inFirstHalf(left);
}

/** Number of the last of ascending numbers that is at most `value`; -1 where all are more. */
function lastUpTo(/** @type {number[]} */ ascending, /** @type {number} */ value) {
  let [low, high] = [0, ascending.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (ascending[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

export class Timeline {
  /** @param {any} data the timeline of the scene document */
  constructor(data) {
    /** When the tour ends, in s. */
    this.end = data.end_s;
    /** @type {number[]} */
    this.start = data.start;
    /** @type {Move[]} */
    this.moves = data.moves;
    /** @type {PictureTime[]} */
    this.pictures = data.pictures;
    this.legs = this.moves.flatMap(({ legs }) => legs);
    this.legStarts = this.legs.map(({ start_s }) => start_s);
    /** @type {number[]} when margins were measured */
    this.measured = data.measured_s ?? [];
    /** @type {Curve | null} */
    this.clearance = data.clearance ?? null;
    /** @type {Curve | null} */
    this.changingClearance = data.changing_clearance ?? null;
    /** @type {Curve | null} */
    this.tipOverMargin = data.tip_over_margin ?? null;
  }

  /** Joint values in rad or m at a time in s. */
  configurationAt(/** @type {number} */ time) {
    const i = lastUpTo(this.legStarts, time);
    if (i < 0) return this.start;
    const leg = this.legs[i];
    const from = i > 0 ? this.legs[i - 1].to : this.start;
    const share = shareDone(leg, time - leg.start_s);
    return from.map((value, j) => {
      const between = (1 - share) * value + share * leg.to[j];
      return Math.min(Math.max(between, Math.min(value, leg.to[j])), Math.max(value, leg.to[j]));
    });
  }

  /** The id of the pose at which the arm takes pictures at a time in s, or null. */
  pictureAt(/** @type {number} */ time) {
    const found = this.pictures.find(({ start_s, seconds }) => start_s <= time && time <= start_s + seconds);
    return found ? String(found.id) : null;
  }

  /** The id of the pose where the last pictures were taken or are being taken at a time in s; null before the first. */
  lastPictureAt(/** @type {number} */ time) {
    const next = this.pictures.findIndex(({ start_s }) => start_s > time);
    const last = this.pictures.at(next < 0 ? -1 : next - 1);
    return last && next !== 0 ? String(last.id) : null;
  }

  /** The move that the arm is on at a time in s, or null. */
  moveAt(/** @type {number} */ time) {
    return this.moves.find(({ start_s, seconds }) => start_s <= time && time <= start_s + seconds) ?? null;
  }

  /** When the arm comes to a pose, in s; null for none of the tour's. */
  arrivalAt(/** @type {string} */ id) {
    return this.pictures.find((picture) => String(picture.id) === id)?.start_s ?? null;
  }

  /**
   * A margin at a time in s as it was measured, in m, between samples on the line from one to the next; with the links that are nearest
   * at the sample before, where it is of links.
   */
  marginAt(/** @type {Curve} */ curve, /** @type {number} */ time) {
    const last = this.measured.length - 1;
    const before = Math.min(Math.max(lastUpTo(this.measured, time), 0), last);
    const after = Math.min(before + 1, last);
    const [from, to] = [this.measured[before], this.measured[after]];
    const share = to > from ? Math.min(Math.max((time - from) / (to - from), 0), 1) : 0;
    const value = (1 - share) * curve.measured_m[before] + share * curve.measured_m[after];
    const nearest = share < 0.5 ? before : after;
    return { value, links: curve.nearest && curve.pairs ? curve.pairs[curve.nearest[nearest]] : null };
  }
}
