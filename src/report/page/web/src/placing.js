/** Putting objects where the document says. */
import { CylinderGeometry, Mesh, Vector3 } from "three";

const Z = new Vector3(0, 0, 1);

/** Puts an object at a pose of the document. */
export function place(/** @type {import("three").Object3D} */ object, /** @type {import("./kinematics.js").Pose} */ pose) {
  object.position.fromArray(pose.position_m);
  object.quaternion.fromArray(pose.quaternion_xyzw);
}

/** A round bar, not yet anywhere. */
export function makeBar(/** @type {import("three").Material} */ material) {
  return new Mesh(new CylinderGeometry(1, 1, 1, 16).rotateX(Math.PI / 2), material);
}

/** Lets a bar reach from one point to another; one without length is hidden. Lengths in m. */
export function stretch(
  /** @type {Mesh} */ bar,
  /** @type {number[]} */ from,
  /** @type {number[]} */ to,
  /** @type {number} */ radius,
) {
  const start = new Vector3().fromArray(from);
  const way = new Vector3().fromArray(to).sub(start);
  const length = way.length();
  bar.visible = length > 1e-6;
  if (!bar.visible) return;
  bar.position.copy(start).addScaledVector(way, 0.5);
  bar.quaternion.setFromUnitVectors(Z, way.divideScalar(length));
  bar.scale.set(radius, radius, length);
}
