/** The page's colours, as its style sheet gives them, for what is drawn outside of it. */
import { Color } from "three";

const NAMES = /** @type {const} */ ([
  "ink", "muted", "line", "accent", "chosen", "series-1", "series-2", "series-3",
  "body", "body-other", "obstacle", "board-light", "board-dark", "ramp-low", "ramp-high",
]);

/** @typedef {Record<typeof NAMES[number], Color>} Theme */

/** @returns {Theme} */
export function readTheme() {
  const style = getComputedStyle(document.documentElement);
  const colours = NAMES.map((name) => [name, new Color(style.getPropertyValue(`--${name}`).trim())]);
  return Object.fromEntries(colours);
}
