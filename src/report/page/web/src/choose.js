/**
 * The chosen pose: one at a time, by its id, for the whole page. Whatever in the page belongs to a pose shows and sets it.
 */

/**
 * @typedef {"reader" | "tour"} Chooser who chose: the reader, or the tour that came to the pose
 * @typedef {(id: string, chooser: Chooser) => void} Listener
 */

export class Choice {
  /** @param {string[]} ids of the poses, in their order; the first is chosen by `start` */
  constructor(ids) {
    this.ids = ids;
    /** @type {string | null} */
    this.id = null;
    /** Whether the arm has left the chosen pose. */
    this.away = false;
    /** @type {Listener[]} */
    this.listeners = [];
  }

  /** @param {Listener} listener told after every change */
  onChange(listener) {
    this.listeners.push(listener);
  }

  /** Chooses a pose; one that the plan does not have is ignored. */
  choose(/** @type {string} */ id, /** @type {Chooser} */ chooser = "reader") {
    if ((id === this.id && !this.away) || !this.ids.includes(id)) return;
    this.id = id;
    this.away = false;
    for (const listener of this.listeners) listener(id, chooser);
  }

  /** Chooses the pose `by` places on, around the end; one back from where the arm has left the chosen pose is that pose. */
  step(/** @type {number} */ by) {
    const { length } = this.ids;
    const index = this.ids.indexOf(this.id ?? "") + (this.away && by < 0 ? 1 : 0);
    this.choose(this.ids[(index + by + length) % length]);
  }
}

/**
 * Marks of plots say to whom they belong by their title, "pose ID" or "view ID", which is read out and shown by the browser too.
 * Gives their owners the attribute that everything else has.
 */
export function nameMarks() {
  for (const title of document.querySelectorAll(":is(.plot, .timeline) svg title")) {
    const [, kind, id] = /^(pose|view) (\d+)\b/.exec(title.textContent.trim()) ?? [];
    const owner = title.parentElement;
    if (kind && owner && owner.tagName !== "svg") owner.setAttribute(`data-${kind}`, id);
  }
}

/** Shows the choice on all elements with `data-pose` or `data-pose-panel`, and lets the former choose. */
export function linkElements(/** @type {Choice} */ choice) {
  const mark = (/** @type {string | null} */ id) => {
    for (const element of document.querySelectorAll("[data-pose], [data-pose-panel]")) {
      const own = element.getAttribute("data-pose") ?? element.getAttribute("data-pose-panel");
      element.classList.toggle("chosen", own === id);
      element.querySelector(".choose")?.setAttribute("aria-pressed", String(own === id));
    }
  };
  mark(choice.id);
  choice.onChange(mark);
  const chooseFor = (/** @type {Event} */ event) => {
    const element = event.target instanceof Element && event.target.closest("[data-pose]");
    if (element) choice.choose(element.getAttribute("data-pose") ?? "");
    return Boolean(element);
  };
  document.addEventListener("click", chooseFor);
  document.addEventListener("keydown", (event) => {
    // Buttons and links make a click of these keys by themselves.
    const plain = event.target instanceof Element && !event.target.closest("button, a, input, select, summary");
    if (plain && (event.key === "Enter" || event.key === " ") && chooseFor(event)) event.preventDefault();
  });
}

/**
 * Tells which pose or view the pointer is over, by its id, or null.
 *
 * @param {"pose" | "view"} kind
 * @param {(id: string | null) => void} listener
 */
export function onHover(kind, listener) {
  let current = null;
  document.addEventListener("pointerover", (event) => {
    const element = event.target instanceof Element ? event.target.closest(`[data-${kind}]`) : null;
    const id = element?.getAttribute(`data-${kind}`) ?? null;
    if (id !== current) listener((current = id));
  });
}
