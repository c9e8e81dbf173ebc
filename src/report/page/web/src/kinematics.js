/**
 * Rigid poses and the arm's forward kinematics, in double precision and without three.js.
 *
 * `X_AB` is the pose of frame B in frame A; adjacent letters cancel: `X_AC = compose(X_AB, X_BC)`.
 *
 * @typedef {{position_m: number[], quaternion_xyzw: number[]}} Pose
 * @typedef {{joint: number, kind: "revolute" | "prismatic", axis: number[], multiplier: number, offset: number}} Motion
 * @typedef {{name: string, parent: number | null, origin: Pose, motion: Motion | null, obstacle: boolean}} Link
 */

/** @type {Pose} */
const IDENTITY = { position_m: [0, 0, 0], quaternion_xyzw: [0, 0, 0, 1] };

/** Hamilton's product: the rotation `b` followed by `a`. */
function multiply(/** @type {number[]} */ [ax, ay, az, aw], /** @type {number[]} */ [bx, by, bz, bw]) {
  return [
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
}

/** The vector `v` turned by the unit quaternion `q`. */
function rotate(/** @type {number[]} */ [x, y, z, w], /** @type {number[]} */ [vx, vy, vz]) {
  // v + 2 u × (u × v + w v) with u = (x, y, z)
  const cx = y * vz - z * vy + w * vx;
  const cy = z * vx - x * vz + w * vy;
  const cz = x * vy - y * vx + w * vz;
  return [vx + 2 * (y * cz - z * cy), vy + 2 * (z * cx - x * cz), vz + 2 * (x * cy - y * cx)];
}

/** A point of frame B in frame A. */
export function transform(/** @type {Pose} */ X_AB, /** @type {number[]} */ p_B) {
  return rotate(X_AB.quaternion_xyzw, p_B).map((value, i) => value + X_AB.position_m[i]);
}

/** @returns {Pose} */
export function compose(/** @type {Pose} */ X_AB, /** @type {Pose} */ X_BC) {
  return {
    position_m: transform(X_AB, X_BC.position_m),
    quaternion_xyzw: multiply(X_AB.quaternion_xyzw, X_BC.quaternion_xyzw),
  };
}

/** @returns {Pose} */
export function inverse(/** @type {Pose} */ X_AB) {
  const [x, y, z, w] = X_AB.quaternion_xyzw;
  const conjugate = [-x, -y, -z, w];
  return { position_m: rotate(conjugate, X_AB.position_m).map((value) => -value), quaternion_xyzw: conjugate };
}

/** The pose that a joint gives its link, relative to where the link is at zero. `q` in rad or m. @returns {Pose} */
function moved(/** @type {Motion | null} */ motion, /** @type {number[]} */ q) {
  if (!motion) return IDENTITY;
  const value = motion.multiplier * q[motion.joint] + motion.offset;
  const length = Math.hypot(...motion.axis);
  const along = (/** @type {number} */ scale) => motion.axis.map((component) => (component / length) * scale);
  return motion.kind === "prismatic"
    ? { position_m: along(value), quaternion_xyzw: IDENTITY.quaternion_xyzw }
    : { position_m: IDENTITY.position_m, quaternion_xyzw: [...along(Math.sin(value / 2)), Math.cos(value / 2)] };
}

/**
 * Where the links and the camera are in the base frame, in which the report draws.
 *
 * @param {{links: Link[], base_link: number, camera_link: number, camera: {pose: Pose}}} scene
 * @param {number[]} q joint values in rad or m
 * @returns {{links: Pose[], camera: Pose}}
 */
export function forwardKinematics(scene, q) {
  /** @type {Pose[]} poses of the links in the root's frame, parents first */
  const inRoot = [];
  for (const link of scene.links) {
    const parent = link.parent === null ? IDENTITY : inRoot[link.parent];
    inRoot.push(compose(compose(parent, link.origin), moved(link.motion, q)));
  }
  const X_base_root = inverse(inRoot[scene.base_link]);
  const links = inRoot.map((X_root_link) => compose(X_base_root, X_root_link));
  return { links, camera: compose(links[scene.camera_link], scene.camera.pose) };
}
