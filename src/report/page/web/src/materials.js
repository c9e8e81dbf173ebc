/**
 * Materials of the scene by what they colour, and the page's colours for them. One small shader draws them all: compiling three.js's
 * own, one for each kind of material, took most of the time before the first frame.
 */
import { Color, DoubleSide, GLSL3, RawShaderMaterial, Vector3 } from "three";

/** @typedef {ReturnType<typeof makeMaterials>} Materials */

const VERTEX = /* glsl */ `
precision highp float;
uniform mat4 modelMatrix, modelViewMatrix, projectionMatrix;
uniform vec3 tone, sun;
uniform float lit, own, size, ratio;
in vec3 position, normal, color;
out vec3 shown;

vec3 sRGB(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, linear));
}

void main() {
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = size * ratio;
  // Lambert's law, with light from all around. Only bars are scaled unevenly, along their axis, which keeps these normals.
  vec3 n = mat3(modelMatrix) * normal;
  float light = 0.51 + 0.54 * max(dot(n, sun) * inversesqrt(max(dot(n, n), 1e-20)), 0.0);
  shown = sRGB(mix(tone, color, own) * mix(1.0, light, lit));
}`;

const FRAGMENT = /* glsl */ `
precision highp float;
uniform float opacity, size;
in vec3 shown;
out vec4 pixel;

void main() {
  if (size > 0.0 && distance(gl_PointCoord, vec2(0.5)) > 0.5) discard;
  pixel = vec4(shown, opacity);
}`;

/** What all materials share: the direction towards the sun, a unit vector in the base frame, and device pixels to a CSS pixel. */
const shared = { sun: { value: new Vector3(0, 0, 1) }, ratio: { value: 1 } };

class Paint extends RawShaderMaterial {
  /**
   * @param {object} kind
   * @param {number} [kind.lit] 1 for surfaces that are lighter towards the sun
   * @param {number} [kind.own] 1 for geometries with colours of their own
   * @param {number} [kind.size] of points, in CSS pixels
   * @param {number} [kind.opacity]
   */
  constructor({ lit = 0, own = 0, size = 0, opacity = 1, ...state }) {
    const uniforms = { tone: { value: new Color() }, lit: { value: lit }, own: { value: own }, size: { value: size }, opacity: { value: opacity } };
    super({ glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { ...uniforms, ...shared }, ...state });
  }

  /** @returns {Color} */
  get color() {
    return this.uniforms.tone.value;
  }
}

export function makeMaterials() {
  const lit = (state = {}) => new Paint({ lit: 1, ...state });
  // All lines are drawn in one way, as if seen through: a second way would cost time before the first frame.
  const line = (opacity = 1) => new Paint({ opacity, transparent: true });
  const glass = (/** @type {number} */ opacity) => new Paint({ opacity, transparent: true, side: DoubleSide, depthWrite: false });
  return {
    ...shared,
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
    view: new Paint({ own: 1, size: 4 }),
    viewMark: new Paint({ size: 16, depthTest: false }),
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
