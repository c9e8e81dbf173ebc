/** Materials of the scene by what they colour, and the page's colours for them. Few kinds: each takes time before the first frame. */
import { DataTexture, DoubleSide, LineBasicMaterial, MeshBasicMaterial, MeshLambertMaterial, PointsMaterial } from "three";

/** @typedef {ReturnType<typeof makeMaterials>} Materials */

export function makeMaterials() {
  const lit = (options = {}) => new MeshLambertMaterial(options);
  // All lines are drawn in one way, as if seen through: a second way would cost time before the first frame.
  const line = (opacity = 1) => new LineBasicMaterial({ transparent: true, opacity });
  const glass = (/** @type {number} */ opacity) =>
    new MeshBasicMaterial({ transparent: true, opacity, side: DoubleSide, depthWrite: false });
  const points = { sizeAttenuation: false, map: disc(), alphaTest: 0.5 };
  return {
    body: lit(),
    otherBody: lit(),
    obstacle: lit(),
    edge: line(0.35),
    bone: lit(),
    knob: lit(),
    camera: lit(),
    beam: glass(0.1),
    beamLine: line(),
    frustum: glass(0.06),
    frustumLine: line(0.75),
    frustumNear: line(),
    boardLight: lit(),
    // The squares lie in the plate's surface: the offset draws them before it.
    boardDark: lit({ polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2 }),
    zone: line(0.8),
    grid: line(0.8),
    axes: [lit(), lit(), lit()],
    view: new PointsMaterial({ ...points, size: 4, vertexColors: true }),
    viewMark: new PointsMaterial({ ...points, size: 16, depthTest: false }),
  };
}

/** Gives the materials the page's colours; those of the views swept are their own. */
export function tint(/** @type {Materials} */ materials, /** @type {import("./theme.js").Theme} */ theme) {
  const { axes, ...m } = materials;
  const parts = {
    body: [m.body, m.bone],
    "body-other": [m.otherBody],
    obstacle: [m.obstacle],
    ink: [m.edge, m.frustum, m.frustumLine],
    accent: [m.knob],
    chosen: [m.camera, m.beam, m.beamLine, m.frustumNear, m.viewMark],
    "board-light": [m.boardLight],
    "board-dark": [m.boardDark],
    muted: [m.zone],
    line: [m.grid],
    // x, y, z as usual: red, green, blue, or what comes nearest.
    "series-2": [axes[0]],
    "series-3": [axes[1]],
    "series-1": [axes[2]],
  };
  for (const [name, coloured] of Object.entries(parts)) {
    for (const material of coloured) material.color.copy(theme[/** @type {keyof typeof parts} */ (name)]);
  }
}

/** A white disc, which makes points round. */
function disc() {
  const size = 32;
  const bytes = new Uint8Array(4 * size * size).fill(255);
  for (let i = 0; i < size * size; i++) {
    const x = (i % size) + 0.5 - size / 2;
    const y = Math.floor(i / size) + 0.5 - size / 2;
    bytes[4 * i + 3] = Math.hypot(x, y) <= size / 2 ? 255 : 0;
  }
  const texture = new DataTexture(bytes, size, size);
  texture.needsUpdate = true;
  return texture;
}
