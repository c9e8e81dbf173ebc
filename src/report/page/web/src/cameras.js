/** The arm's camera with what it sees, strongly, and the cameras of all other poses as small frustums. */
import { BoxGeometry, CylinderGeometry, Group, LineSegments, Mesh } from "three";
import { place } from "./placing.js";
import { frustum } from "./shapes.js";

export class Cameras {
  /**
   * @param {any} data the scene document
   * @param {import("./materials.js").Materials} materials
   * @param {number} scale a typical length of the scene, in m
   */
  constructor(data, materials, scale) {
    this.materials = materials;
    const seen = frustum(data.camera.outline);
    this.beam = new Group().add(new LineSegments(seen.edges, materials.beamLine), new Mesh(seen.sides, materials.beam));
    this.own = new Group().add(...housing(0.11 * scale, materials.camera), this.beam);
    /** @type {Map<string, {group: Group, lines: LineSegments}>} by the pose's id */
    this.frustums = new Map();
    for (const pose of data.poses) {
      const lines = new LineSegments(seen.edgesWithGable, materials.frustumLine);
      const group = new Group().add(lines, new Mesh(seen.sides, materials.frustum));
      place(group, pose.camera);
      group.scale.setScalar(0.15 * scale);
      this.frustums.set(String(pose.id), { group, lines });
    }
    this.group = new Group().add(this.own, ...[...this.frustums.values()].map(({ group }) => group));
    this.shown = true;
    /** @type {string | null} */
    this.chosen = null;
  }

  /** Moves the arm's camera; its frustum reaches as far as the board, `distance` in m. */
  moveTo(/** @type {import("./kinematics.js").Pose} */ pose, /** @type {number} */ distance) {
    place(this.own, pose);
    this.beam.scale.setScalar(distance);
  }

  /** The pose that the arm is at, if it is at one, is shown by its own camera, instead of a small frustum. */
  setChosen(/** @type {string | null} */ id) {
    this.chosen = id;
    this.show(this.shown);
  }

  /** Marks the small frustum of the pose that is pointed at. */
  setNear(/** @type {string | null} */ near) {
    const { frustumLine, frustumNear } = this.materials;
    for (const [id, { lines }] of this.frustums) lines.material = id === near ? frustumNear : frustumLine;
  }

  /** Shows the frustums, or the arm's camera alone. */
  show(/** @type {boolean} */ shown) {
    this.shown = shown;
    this.beam.visible = shown;
    for (const [id, { group }] of this.frustums) group.visible = shown && id !== this.chosen;
  }
}

/** A small camera behind its centre of projection, looking along z. */
function housing(/** @type {number} */ size, /** @type {import("three").Material} */ material) {
  const box = new BoxGeometry(0.8 * size, 0.55 * size, 0.5 * size).translate(0, 0, -0.45 * size);
  const lens = new CylinderGeometry(0.2 * size, 0.2 * size, 0.25 * size, 24).rotateX(Math.PI / 2);
  return [new Mesh(box, material), new Mesh(lens.translate(0, 0, -0.1 * size), material)];
}
