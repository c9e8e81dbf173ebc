/** The time axis of the tour's drawing: a cursor to drag or to move by keys, and what there is at its time. */
import { element } from "./elements.js";

/** What an arrow key goes, in s; with Shift ten times as far. */
const KEY_S = 0.1;

const HELP =
  "Click into the drawing or drag its cursor. Keys in it: arrows by a tenth of a second, Shift and arrows by a second, N and P next and previous pose, " +
  "Home and End, space plays.";

export class Track {
  /**
   * @param {HTMLElement} place of the drawing
   * @param {any} data the scene document
   * @param {import("./player.js").Player} player
   * @param {import("./choose.js").Choice} choice
   */
  constructor(place, data, player, choice) {
    this.data = data;
    this.player = player;
    this.timeline = player.timeline;
    this.cursor = element("div", { className: "cursor" });
    this.slider = element("div", {
      className: "track", role: "slider", tabIndex: 0, "aria-label": "Time of the tour", "aria-valuemin": 0,
      "aria-valuemax": this.timeline.end.toFixed(1), "aria-orientation": "horizontal",
    }, this.cursor);
    place.append(this.slider);
    /** @type {{value: HTMLElement, at: (time: number) => string}[]} */
    this.facts = [];
    const readout = element("dl", { className: "readout" });
    for (const [name, at] of this.#readings()) {
      const value = element("dd");
      // Names of links take two places.
      const className = name.startsWith("Nearest") ? "long" : "";
      readout.append(element("div", { className }, element("dt", { textContent: name }), value));
      this.facts.push({ value, at });
    }
    place.after(readout, element("p", { className: "help", textContent: HELP }));
    this.#listenToPointer();
    this.slider.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (this.#key(event, choice)) event.preventDefault();
    });
    player.onTime((_, cause) => this.#show(cause !== "played"));
    player.onPlay(() => this.#show(true));
    this.#show(true);
  }

  /** Names, and what there is to read at a time. @returns {[string, (time: number) => string][]} */
  #readings() {
    const { timeline } = this;
    const margin = (/** @type {string} */ name, /** @type {any} */ curve) => {
      if (!curve) return [];
      return [[name, (/** @type {number} */ time) => {
        const { value, links } = timeline.marginAt(curve, time);
        return `${(1000 * value).toFixed(1)} mm${links ? `, ${links.join(" – ")}` : ""}`;
      }]];
    };
    const joints = this.data.joints.map((/** @type {any} */ { name, unit }, /** @type {number} */ j) => {
      const shown = (/** @type {number} */ value) =>
        unit === "deg" ? `${((180 / Math.PI) * value).toFixed(1)}°` : `${(1000 * value).toFixed(1)} ${unit}`;
      return [name, (/** @type {number} */ time) => shown(timeline.configurationAt(time)[j])];
    });
    return /** @type {any} */ ([
      ["Time", (/** @type {number} */ time) => `${time.toFixed(1)} s of ${timeline.end.toFixed(1)} s`],
      ["Where", (/** @type {number} */ time) => whereabouts(this.data, timeline, time)],
      ...margin("Nearest links", timeline.clearance),
      ...margin("Nearest of those whose distance changes", timeline.changingClearance),
      ...margin("Tip-over margin", timeline.tipOverMargin),
      ...joints,
    ]);
  }

  #listenToPointer() {
    const seek = (/** @type {PointerEvent} */ event) => {
      const { left, width } = this.slider.getBoundingClientRect();
      this.player.seek(((event.clientX - left) / width) * this.timeline.end);
    };
    this.slider.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      this.slider.setPointerCapture(event.pointerId);
      this.player.play(false);
      seek(event);
    });
    this.slider.addEventListener("pointermove", (event) => {
      if (this.slider.hasPointerCapture(event.pointerId)) seek(event);
    });
  }

  /** True where the key was one of the slider's. */
  #key(/** @type {KeyboardEvent} */ { key, shiftKey }, /** @type {import("./choose.js").Choice} */ choice) {
    const { player, timeline } = this;
    const forth = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[key];
    if (key === " ") {
      player.play(!player.playing);
      return true;
    }
    if (key === "PageUp" || key === "n" || key === "N") choice.step(1);
    else if (key === "PageDown" || key === "p" || key === "P") choice.step(-1);
    else if (forth || key === "Home" || key === "End") {
      player.play(false);
      player.seek(forth ? player.time + forth * KEY_S * (shiftKey ? 10 : 1) : key === "Home" ? 0 : timeline.end);
    } else return false;
    return true;
  }

  /** Moves the cursor, and says what there is; readers of the screen are told where `told`, not at every step of the playing. */
  #show(/** @type {boolean} */ told) {
    const { time } = this.player;
    this.cursor.style.left = `${(100 * time) / (this.timeline.end || 1)}%`;
    for (const { value, at } of this.facts) value.textContent = at(time);
    if (!told) return;
    this.slider.setAttribute("aria-valuenow", time.toFixed(1));
    this.slider.setAttribute("aria-valuetext", `${time.toFixed(1)} s, ${whereabouts(this.data, this.timeline, time)}`);
  }
}

/** "at pose 3", "from pose 3 to pose 4" */
export function whereabouts(
  /** @type {any} */ data,
  /** @type {import("./timeline.js").Timeline} */ timeline,
  /** @type {number} */ time,
) {
  const name = (/** @type {number | string | null} */ id) => {
    const pose = data.poses.find((/** @type {any} */ each) => String(each.id) === String(id));
    return pose ? `pose ${pose.label}` : "home";
  };
  const picture = timeline.pictureAt(time);
  if (picture !== null) return `at ${name(picture)}`;
  const move = timeline.moveAt(time);
  return move ? `from ${name(move.from)} to ${name(move.to)}` : "";
}
