/** The arm: the bodies of its links, and the skeleton that stands for it where bodies are not known or not wanted. */
import { Group, LineSegments, Mesh, SphereGeometry } from "three";
import { transform } from "./kinematics.js";
import { makeBar, place, stretch } from "./placing.js";
import { sharpEdges, solidGeometry } from "./shapes.js";

/** @typedef {import("./kinematics.js").Pose} Pose */

export class Arm {
  /**
   * @param {any} data the scene document
   * @param {import("./materials.js").Materials} materials
   * @param {number} scale a typical length of the scene, in m
   */
  constructor(data, materials, scale) {
    this.links = data.links.map(() => new Group());
    this.solids = data.solids.map((/** @type {any} */ solid) => makeSolid(solid, data.links[solid.link], materials));
    for (const { link, group } of this.solids) this.links[link].add(group);
    this.bones = makeBones(data, materials, scale);
    this.skeleton = new Group().add(...this.bones.flatMap(({ bar, knob }) => [bar, knob]));
    this.group = new Group().add(...this.links, this.skeleton);
    /** Whether bodies are known of what moves, not only of what it stands on. */
    this.hasBodies = this.solids.some(({ link, obstacle }) => !obstacle && moves(data.links, link));
    this.showBodies(true);
  }

  /** Shows bodies or the skeleton; obstacles stay. */
  showBodies(/** @type {boolean} */ shown) {
    for (const { group, obstacle } of this.solids) group.visible = shown || obstacle;
    this.skeleton.visible = !shown || !this.hasBodies;
  }

  /** Moves every link to its pose in the base frame, and the skeleton's end to the camera. */
  moveTo(/** @type {{links: Pose[], camera: Pose}} */ { links, camera }) {
    this.links.forEach((/** @type {Group} */ group, /** @type {number} */ i) => place(group, links[i]));
    for (const { from, to, radius, bar, knob } of this.bones) {
      stretch(bar, links[from].position_m, (to === null ? camera : links[to]).position_m, radius);
      knob.position.fromArray(links[from].position_m);
    }
  }

  /** Points between which all bodies are, for links at these poses; in the base frame. */
  extent(/** @type {Pose[]} */ links) {
    return this.solids.flatMap(({ link, corners }) => corners.map((corner) => transform(links[link], corner)));
  }
}

/** Whether a joint moves a link. */
function moves(/** @type {import("./kinematics.js").Link[]} */ links, /** @type {number} */ link) {
  for (let i = /** @type {number | null} */ (link); i !== null; i = links[i].parent) {
    if (links[i].motion) return true;
  }
  return false;
}

function makeSolid(/** @type {any} */ { link, pose, shape }, /** @type {any} */ { obstacle }, materials) {
  const surface = solidGeometry(shape);
  const material = obstacle ? materials.obstacle : link % 2 ? materials.otherBody : materials.body;
  const group = new Group().add(new Mesh(surface, material));
  const edges = sharpEdges(shape, surface);
  if (edges) group.add(new LineSegments(edges, materials.edge));
  place(group, pose);
  return { link, obstacle, group, corners: boxAround(surface).map((corner) => transform(pose, corner)) };
}

/** The corners of the box around a surface, in its own frame. */
function boxAround(/** @type {import("three").BufferGeometry} */ surface) {
  surface.computeBoundingBox();
  const box = /** @type {import("three").Box3} */ (surface.boundingBox);
  const [low, high] = [box.min.toArray(), box.max.toArray()];
  return [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => [0, 1, 2].map((axis) => ((corner >> axis) & 1 ? high : low)[axis]));
}

/** Bars from every link's origin to its children's, thick on the way from the root to the camera. */
function makeBones(data, materials, scale) {
  const { links, camera_link } = data;
  const onTheWay = new Set();
  for (let i = camera_link; i !== null; i = links[i].parent) onTheWay.add(i);
  const ball = new SphereGeometry(1, 20, 14);
  const bone = (/** @type {number} */ from, /** @type {number | null} */ to, /** @type {boolean} */ thick) => {
    const radius = scale * (thick ? 0.025 : 0.01);
    const knob = new Mesh(ball, materials.knob);
    knob.scale.setScalar(1.5 * radius);
    return { from, to, radius, bar: makeBar(materials.bone), knob };
  };
  const between = links.flatMap((/** @type {any} */ { parent, obstacle }, /** @type {number} */ i) =>
    parent === null || obstacle ? [] : [bone(parent, i, onTheWay.has(i))],
  );
  return [...between, bone(camera_link, null, true)];
}
