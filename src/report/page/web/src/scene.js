/** The scene in three dimensions, put together. All of it is in the base frame; lengths are in m. */
import { Scene, Vector3 } from "three";
import { Arm } from "./arm.js";
import { Cameras } from "./cameras.js";
import { forwardKinematics, transform } from "./kinematics.js";
import { makeMaterials, tint } from "./materials.js";
import { makeAxes, makeBoard, makeGround } from "./surroundings.js";
import { SweptViews } from "./swept.js";

/** Views that are looked at to find out how far all reach. */
const EXTENT_VIEWS = 1000;

export class Stage {
  /** @param {any} data the scene document */
  constructor(data) {
    this.data = data;
    this.up = new Vector3().fromArray(data.up).normalize();
    this.materials = makeMaterials();
    // What has no size of its own is drawn in proportion to how far the cameras are from the board.
    const scale = median(data.poses.map((/** @type {any} */ pose) => pose.distance_m));
    this.arm = new Arm(data, this.materials, scale);
    this.cameras = new Cameras(data, this.materials, scale);
    this.views = new SweptViews(data.views, this.materials);
    this.axes = makeAxes(0.25 * scale, this.materials);
    this.showConfiguration(data.poses[0].joints);
    /** Points that a view of everything has inside. */
    this.extent = this.#extent();
    this.ground = makeGround(this.arm.links[0].position, this.up, this.extent, this.materials);

    this.scene = new Scene().add(this.arm.group, this.cameras.group, this.views.group, this.axes.group, this.ground.lines);
    this.scene.add(makeBoard(data.board, this.materials));
    this.materials.sun.value.copy(this.up).multiplyScalar(2).add(new Vector3(0.7, -1.1, 0.4)).normalize();
  }

  /** Moves the arm and its camera, whose frustum reaches as far as the board; joint values in rad or m. */
  showConfiguration(/** @type {number[]} */ q) {
    const poses = forwardKinematics(this.data, q);
    this.arm.moveTo(poses);
    const toBoard = this.data.board.pose.position_m.map((value, i) => value - poses.camera.position_m[i]);
    this.cameras.moveTo(poses.camera, Math.hypot(...toBoard));
  }

  /** Gives everything the page's colours. */
  tint(/** @type {import("./theme.js").Theme} */ theme) {
    tint(this.materials, theme);
    this.views.tint(theme);
  }

  #extent() {
    const { board, views, poses, links, timeline } = this.data;
    const [x, y] = board.size_m.map((/** @type {number} */ side) => (side + board.spacing_m) / 2);
    const points = [[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]].map((corner) => transform(board.pose, corner));
    // Evenly spaced ones are enough to tell how far the views reach.
    const stride = 3 * Math.ceil(views.ids.length / EXTENT_VIEWS);
    for (let i = 0; i < views.positions_m.length; i += stride) points.push(views.positions_m.slice(i, i + 3));
    const turns = (timeline?.moves ?? []).flatMap(({ legs }) => legs.map(({ to }) => to));
    for (const joints of [...poses.map(({ joints }) => joints), ...turns]) {
      const at = forwardKinematics(this.data, joints);
      const origins = at.links.filter((_, i) => !links[i].obstacle).map((link) => link.position_m);
      points.push(at.camera.position_m, ...origins, ...this.arm.extent(at.links));
    }
    return points.map((point) => new Vector3().fromArray(point));
  }
}

function median(/** @type {number[]} */ values) {
  return [...values].sort((a, b) => a - b)[values.length >> 1];
}
