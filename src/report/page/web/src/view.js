/** The window on the scene: canvas, camera, labels, and what is under the pointer. */
import { PerspectiveCamera, Quaternion, Vector3, WebGLRenderer } from "three";
import { element } from "./elements.js";
import { Orbit } from "./orbit.js";

const FIELD_OF_VIEW_DEG = 32;
/** A click chooses the pose within this many CSS pixels. */
const REACH_PX = 22;
/** A pointer that went further than this, in CSS pixels, has turned the view and clicked nothing. */
const CLICK_PX = 5;

/** A canvas that fills `frame`, with its WebGL context, which is null where the browser has none. */
export function openCanvas(/** @type {HTMLElement} */ frame) {
  const canvas = element("canvas", { tabIndex: 0, role: "application", "aria-label": "3-D view of the arm and its poses" });
  frame.append(canvas);
  // Of its size from the start: another one later would cost the making of new buffers.
  const { width, height, ratio } = sizeOf(frame);
  Object.assign(canvas, { width: Math.floor(width * ratio), height: Math.floor(height * ratio) });
  const context = canvas.getContext("webgl2", { antialias: true, alpha: true });
  // three.js asks for many extensions, each of which waits for the graphics process; the view needs none.
  if (context) context.getExtension = () => null;
  return { canvas, context };
}

/** Width and height of the frame in CSS pixels, and device pixels drawn to a CSS pixel. */
function sizeOf(/** @type {HTMLElement} */ frame) {
  return { width: frame.clientWidth, height: frame.clientHeight, ratio: Math.min(window.devicePixelRatio, 2) };
}

export class View {
  /**
   * @param {HTMLElement} frame which the canvas fills
   * @param {HTMLCanvasElement} canvas
   * @param {WebGL2RenderingContext} context of the canvas
   * @param {import("./scene.js").Stage} stage
   */
  constructor(frame, canvas, context, stage) {
    this.stage = stage;
    this.frame = frame;
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, context });
    // Asking for errors would wait for every shader; the check of the page sees them as an empty canvas.
    this.renderer.debug.checkShaderErrors = false;
    this.renderer.setClearColor(0, 0);
    this.overlay = element("div", { className: "labels", "aria-hidden": "true" });
    frame.append(this.overlay);

    this.camera = new PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, 0.01, 100);
    this.camera.up.copy(stage.up);
    /** Whether the view is still as `home` made it; then it stays so when the frame's size changes. */
    this.atHome = true;
    this.orbit = new Orbit(this.camera, this.canvas, () => {
      this.atHome = false;
      this.requestRender();
    });
    this.canvas.addEventListener("webglcontextrestored", () => this.requestRender());

    this.pending = 0;
    this.size = "";
    /** @type {{at: Vector3, node: HTMLElement, id: string | null}[]} */
    this.labels = [];
    this.#resize();
    this.home();
    // Drawn in this very frame: a canvas of a new size is empty.
    new ResizeObserver(() => {
      if (!this.#resize()) return;
      if (this.atHome) this.home();
      this.render();
    }).observe(frame);
  }

  /** Draws before the next repaint; there is no endless loop. */
  requestRender() {
    this.pending ||= requestAnimationFrame(() => this.render());
  }

  /** Draws now. */
  render() {
    cancelAnimationFrame(this.pending);
    this.pending = 0;
    this.renderer.render(this.stage.scene, this.camera);
    this.#placeLabels();
  }

  /** Waits until what was drawn is there: reading a pixel takes that long. */
  finish() {
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  /**
   * A text at a point of the scene.
   *
   * @param {string} text
   * @param {string} className
   * @param {Vector3} at
   * @param {string | null} id of the pose, where it is one's
   */
  addLabel(text, className, at, id = null) {
    const node = element("span", { className, textContent: text });
    this.overlay.append(node);
    this.labels.push({ at, node, id });
    return node;
  }

  /** Shows the whole scene from the printed side of the board, from a little above. */
  home() {
    const { board } = this.stage.data;
    const { up } = this.stage;
    const printed = new Vector3(0, 0, 1).applyQuaternion(new Quaternion().fromArray(board.pose.quaternion_xyzw));
    // A board that lies flat is looked at from behind the arm, one below the arm's base from anywhere.
    const behind = new Vector3().fromArray(board.pose.position_m).negate();
    const fronts = [printed, behind, new Vector3(1, 0, 0), new Vector3(0, 1, 0)].map((front) => front.projectOnPlane(up));
    const front = fronts.find((each, i) => each.length() > [0.3, 0.01, 0.1, 0.1][i]) ?? fronts[0];
    const direction = front.normalize().applyAxisAngle(up, 0.95).addScaledVector(up, 0.5).normalize();
    this.#fit(this.stage.extent, direction);
    this.atHome = true;
  }

  /** Looks along `-direction` from where all points are just inside. */
  #fit(/** @type {Vector3[]} */ points, /** @type {Vector3} */ direction) {
    const right = new Vector3().crossVectors(this.stage.up, direction).normalize();
    const top = new Vector3().crossVectors(direction, right);
    const axes = [right, top, direction];
    const spans = axes.map((axis) => {
      const along = points.map((point) => point.dot(axis));
      return [least(along), -least(along.map((value) => -value))];
    });
    const centre = new Vector3();
    axes.forEach((axis, i) => centre.addScaledVector(axis, (spans[i][0] + spans[i][1]) / 2));
    const slope = Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360) * 0.92;
    const distance = -least(
      points.map((point) => {
        const from = point.clone().sub(centre);
        const wide = Math.max(Math.abs(from.dot(right)) / this.camera.aspect, Math.abs(from.dot(top)));
        return -(wide / slope + from.dot(direction));
      }),
    );
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.orbit.limits = [distance / 20, distance * 4];
    this.orbit.look(centre.clone().addScaledVector(direction, distance), centre);
  }

  /** Keys that move the view; true where the key was one of them. */
  key(/** @type {KeyboardEvent} */ event) {
    if (event.key !== "h" && event.key !== "H" && event.key !== "Home") return this.orbit.key(event);
    this.home();
    return true;
  }

  /** Where a point of the scene is in the window, in CSS pixels from the viewport's corner. */
  project(/** @type {Vector3} */ point) {
    const { x, y, z } = point.clone().project(this.camera);
    const box = this.canvas.getBoundingClientRect();
    return { x: box.left + ((x + 1) / 2) * box.width, y: box.top + ((1 - y) / 2) * box.height, inFront: z < 1 };
  }

  /** The pose whose camera is within reach of a place in the window, by its id, or null. */
  poseAt(/** @type {number} */ x, /** @type {number} */ y) {
    let best = { id: /** @type {string | null} */ (null), away: REACH_PX };
    for (const [id, { group }] of this.stage.cameras.frustums) {
      const at = this.project(group.position);
      const away = Math.hypot(at.x - x, at.y - y);
      if (at.inFront && away < best.away) best = { id, away };
    }
    return best.id;
  }

  /**
   * @param {(id: string) => void} clicked a pose was clicked
   * @param {(id: string | null) => void} near the pointer is near a pose's camera, or no longer
   */
  onPointer(clicked, near) {
    /** @type {PointerEvent | null} */
    let down = null;
    let last = null;
    const pointAt = (/** @type {string | null} */ id) => {
      if (id === last) return;
      this.canvas.style.cursor = id === null ? "" : "pointer";
      near((last = id));
    };
    this.canvas.addEventListener("pointerdown", (event) => (down = event));
    this.canvas.addEventListener("pointerup", (event) => {
      const still = down && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) <= CLICK_PX;
      down = null;
      const id = still ? this.poseAt(event.clientX, event.clientY) : null;
      if (id !== null) clicked(id);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (event.buttons === 0) pointAt(this.poseAt(event.clientX, event.clientY));
    });
    this.canvas.addEventListener("pointerleave", () => pointAt(null));
  }

  #placeLabels() {
    for (const { at, node } of this.labels) {
      const { x, y, z } = at.clone().project(this.camera);
      const inside = z < 1 && Math.abs(x) < 0.99 && Math.abs(y) < 0.99;
      node.style.visibility = inside ? "" : "hidden";
      // In parts of the frame, which has another size on paper.
      node.style.left = `${50 * (x + 1)}%`;
      node.style.top = `${50 * (1 - y)}%`;
    }
  }

  /** Fits the canvas to its frame; false where it does already. */
  #resize() {
    const { width, height, ratio } = sizeOf(this.frame);
    const size = `${width} ${height} ${ratio}`;
    if (!width || !height || size === this.size) return false;
    this.size = size;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.stage.materials.ratio.value = ratio;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    return true;
  }
}

/** Smallest of many values; the arguments of `Math.min` are limited. */
function least(/** @type {number[]} */ values) {
  return values.reduce((a, b) => Math.min(a, b), Infinity);
}
