/** The section of the 3-D view: its frame, its buttons, the line that says what is shown. */
import { element } from "./elements.js";
import { SPEEDS } from "./player.js";
import { whereabouts } from "./track.js";

const HELP =
  "Drag to turn, right button or two fingers to shift, wheel (after a click) or pinch to zoom; click a camera to choose its pose. " +
  "Keys in the view: arrows turn, Shift and arrows shift, + and − zoom, N and P next and previous pose, space plays the tour, H whole scene.";

/** "Pose 3 of 10: configuration 256707, tilt 55.3°, distance 710 mm" */
export function describe(/** @type {any} */ pose, /** @type {number} */ count) {
  const facts = [`configuration ${pose.id}`, `tilt ${pose.tilt_deg.toFixed(1)}°`, `distance ${(1000 * pose.distance_m).toFixed(0)} mm`];
  return `Pose ${pose.label} of ${count}: ${facts.join(", ")}`;
}

export class Controls {
  /**
   * @param {HTMLElement} section
   * @param {any} data the scene document
   * @param {import("./choose.js").Choice} choice
   * @param {import("./player.js").Player | null} player of the tour, where it is known
   */
  constructor(section, data, choice, player) {
    this.data = data;
    this.choice = choice;
    this.player = player;
    this.frame = element("div", { className: "frame" });
    this.status = element("p", { className: "status", role: "status", "aria-live": "polite" });
    this.list = element("select", { "aria-label": "Pose" });
    for (const pose of data.poses) {
      this.list.append(element("option", { value: String(pose.id), textContent: `Pose ${pose.label} · ${pose.id}` }));
    }
    this.list.addEventListener("change", () => choice.choose(this.list.value));
    this.homeButton = button("Whole scene", "Show the whole scene again (H)", () => {});
    this.toggles = element("div", { className: "toggles", role: "group", "aria-label": "Shown" });
    this.bar = element("div", { className: "bar" },
      element("div", { className: "stepper", role: "group", "aria-label": "Poses" },
        button("‹", "Previous pose (P)", () => choice.step(-1)),
        this.list,
        button("›", "Next pose (N)", () => choice.step(1)),
      ),
      ...(player ? [this.#makePlayer(player)] : []),
      this.homeButton,
      this.toggles,
    );
    section.append(this.status, this.frame, this.bar, element("p", { className: "help", id: "view3d-help" }, HELP));
    section.hidden = false;
    choice.onChange((id) => this.#show(id));
  }

  /** What plays the tour, and how fast; the status says where the arm is when that is another place. */
  #makePlayer(/** @type {import("./player.js").Player} */ player) {
    const play = button("Play", "Play the tour as the arm goes it (space)", () => player.play(!player.playing));
    play.setAttribute("aria-pressed", "false");
    player.onPlay((on) => {
      play.textContent = on ? "Pause" : "Play";
      play.setAttribute("aria-pressed", String(on));
    });
    const speed = element("select", { "aria-label": "Speed of the playing" });
    for (const each of SPEEDS) speed.append(element("option", { value: String(each), textContent: `×${each}` }));
    speed.addEventListener("change", () => (player.speed = Number(speed.value)));
    player.onTime((time) => {
      const away = player.timeline.pictureAt(time) === null;
      if (!away) return this.#show(this.choice.id ?? "");
      const where = `On the way ${whereabouts(this.data, player.timeline, time)}`;
      if (this.status.textContent !== where) this.status.textContent = where;
    });
    return element("div", { className: "stepper", role: "group", "aria-label": "Tour" }, play, speed);
  }

  /** A box to tick for a part of the scene, ticked at first. */
  addToggle(/** @type {string} */ label, /** @type {(shown: boolean) => void} */ changed) {
    const box = element("input", { type: "checkbox", checked: true });
    box.addEventListener("change", () => changed(box.checked));
    this.toggles.append(element("label", {}, box, label));
  }

  /** Keys of the view that are about poses; true where the key was one of them. */
  key(/** @type {KeyboardEvent} */ event) {
    if (event.key === "n" || event.key === "N") this.choice.step(1);
    else if (event.key === "p" || event.key === "P") this.choice.step(-1);
    else if (event.key === " " && this.player) this.player.play(!this.player.playing);
    else return false;
    return true;
  }

  /** What says which colour is which tilt, and how wide the grid's squares are. */
  addLegend(/** @type {number[] | null} */ tilts, /** @type {number} */ spacing_m) {
    const legend = element("div", { className: "legend" });
    if (tilts) {
      const [least, most] = tilts.map((tilt) => `${tilt.toFixed(0)}°`);
      legend.append(element("span", {}, "views by tilt ", least, " ", element("i", { className: "ramp" }), " ", most));
    }
    legend.append(element("span", {}, `grid ${Number(spacing_m.toPrecision(2))} m`));
    this.frame.append(legend);
  }

  /** Says in the view's place why there is none. */
  refuse(/** @type {string} */ reason) {
    this.frame.replaceChildren(element("p", { className: "refusal", textContent: reason }));
    this.frame.classList.add("empty");
    for (const part of [this.homeButton, this.toggles]) part.hidden = true;
  }

  #show(/** @type {string} */ id) {
    const pose = this.data.poses[this.choice.ids.indexOf(id)];
    this.list.value = id;
    const told = describe(pose, this.data.poses.length);
    // A reader of the screen is told what is set, be it the same.
    if (this.status.textContent !== told) this.status.textContent = told;
  }
}

function button(/** @type {string} */ text, /** @type {string} */ title, /** @type {() => void} */ act) {
  const made = element("button", { type: "button", textContent: text, title });
  if (text.length < 2) made.setAttribute("aria-label", title);
  made.addEventListener("click", act);
  return made;
}
