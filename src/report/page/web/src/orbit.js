/** Moves a camera around a target: by mouse, touch, wheel and keys. */
import { Vector3 } from "three";

const KEY_RAD = Math.PI / 24;
const KEY_ZOOM = 1.15;
/** Dragging over the canvas's height turns by this angle. */
const DRAG_RAD = Math.PI;
/** The camera stays this far from the vertical, in rad. */
const FROM_VERTICAL_RAD = 0.03;

export class Orbit {
  /**
   * @param {import("three").PerspectiveCamera} camera
   * @param {HTMLCanvasElement} canvas
   * @param {() => void} changed called after every movement
   */
  constructor(camera, canvas, changed) {
    this.camera = camera;
    this.canvas = canvas;
    this.changed = changed;
    this.target = new Vector3();
    /** Least and largest distance from the target, in m. */
    this.limits = [0, Infinity];
    /** @type {Map<number, PointerEvent>} pointers that are down, as they were last */
    this.pointers = new Map();
    const listen = (/** @type {string} */ name, /** @type {any} */ listener) =>
      canvas.addEventListener(name, listener, { passive: false });
    listen("pointerdown", (/** @type {PointerEvent} */ event) => {
      // A finger may be about to scroll the page: only its tap gives the view the focus.
      if (event.pointerType === "mouse") canvas.focus({ preventScroll: true });
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, event);
    });
    listen("pointermove", (/** @type {PointerEvent} */ event) => this.#drag(event));
    for (const end of ["pointerup", "pointercancel"]) {
      listen(end, (/** @type {PointerEvent} */ event) => this.pointers.delete(event.pointerId));
    }
    listen("click", () => canvas.focus({ preventScroll: true }));
    listen("contextmenu", (/** @type {Event} */ event) => event.preventDefault());
    listen("wheel", (/** @type {WheelEvent} */ event) => this.#wheel(event));
  }

  /** Puts the camera at `position` and lets it look at `target`. */
  look(/** @type {Vector3} */ position, /** @type {Vector3} */ target) {
    this.target.copy(target);
    this.#moveTo(position.clone().sub(target));
  }

  /** Turns around the target, by angles in rad: to the right about the vertical, and up. */
  turn(/** @type {number} */ right, /** @type {number} */ up) {
    const vertical = this.camera.up;
    const offset = this.#offset().applyAxisAngle(vertical, right);
    const polar = offset.angleTo(vertical);
    const next = Math.min(Math.max(polar - up, FROM_VERTICAL_RAD), Math.PI - FROM_VERTICAL_RAD);
    offset.applyAxisAngle(new Vector3().crossVectors(vertical, offset).normalize(), next - polar);
    this.#moveTo(offset);
  }

  /** Shifts the camera and its target, by parts of the canvas's height. */
  pan(/** @type {number} */ right, /** @type {number} */ up) {
    const offset = this.#offset();
    this.#shiftTarget(right, up);
    this.#moveTo(offset);
  }

  /** Multiplies the distance; what is at the place in the window (CSS pixels) stays there. */
  zoom(/** @type {number} */ factor, /** @type {{clientX: number, clientY: number} | null} */ place = null) {
    const offset = this.#offset();
    const before = offset.length();
    const after = Math.min(Math.max(before * factor, this.limits[0]), this.limits[1]);
    if (place) {
      const box = this.canvas.getBoundingClientRect();
      const right = (place.clientX - box.left - box.width / 2) / box.height;
      const up = (box.top + box.height / 2 - place.clientY) / box.height;
      const part = 1 - after / before;
      this.#shiftTarget(right * part, up * part);
    }
    this.#moveTo(offset.setLength(after));
  }

  /** Keys that move the camera; true where the key was one of them. */
  key(/** @type {KeyboardEvent} */ { key, shiftKey }) {
    const [x, y] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[key] ?? [0, 0];
    if (x || y) shiftKey ? this.pan(0.05 * x, 0.05 * y) : this.turn(KEY_RAD * x, KEY_RAD * y);
    else if (key === "+" || key === "=") this.zoom(1 / KEY_ZOOM);
    else if (key === "-" || key === "_") this.zoom(KEY_ZOOM);
    else return false;
    return true;
  }

  #drag(/** @type {PointerEvent} */ event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    this.pointers.set(event.pointerId, event);
    const height = this.canvas.clientHeight;
    const x = (event.clientX - before.clientX) / height;
    const y = (event.clientY - before.clientY) / height;
    const other = [...this.pointers.values()].find(({ pointerId }) => pointerId !== event.pointerId);
    if (other) {
      const span = (/** @type {PointerEvent} */ one) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
      // Each of two fingers carries half of the shift.
      this.pan(-x / 2, y / 2);
      const middle = { clientX: (event.clientX + other.clientX) / 2, clientY: (event.clientY + other.clientY) / 2 };
      this.zoom(span(before) / Math.max(span(event), 1), middle);
    } else if (event.buttons & 1 && !event.shiftKey && !event.ctrlKey && !event.metaKey) {
      this.turn(-DRAG_RAD * x, DRAG_RAD * y);
    } else {
      this.pan(-x, y);
    }
  }

  /** The wheel scrolls the page until the view has the focus. */
  #wheel(/** @type {WheelEvent} */ event) {
    if (document.activeElement !== this.canvas && !event.ctrlKey) return;
    event.preventDefault();
    // Lines or pages instead of pixels, where the browser counts in them; and no leaps.
    const pixels = event.deltaY * ([1, 16, 100][event.deltaMode] ?? 1);
    this.zoom(Math.exp(Math.min(Math.max(pixels, -150), 150) * 0.0015), event);
  }

  /** From the target to the camera. */
  #offset() {
    return this.camera.position.clone().sub(this.target);
  }

  /** By parts of what fits into the canvas's height of the plane through the target. */
  #shiftTarget(/** @type {number} */ right, /** @type {number} */ up) {
    const height = 2 * Math.tan((this.camera.fov * Math.PI) / 360) * this.#offset().length();
    this.target.add(new Vector3(right * height, up * height, 0).applyQuaternion(this.camera.quaternion));
  }

  #moveTo(/** @type {Vector3} */ offset) {
    this.camera.position.copy(this.target).add(offset);
    this.camera.lookAt(this.target);
    this.changed();
  }
}
