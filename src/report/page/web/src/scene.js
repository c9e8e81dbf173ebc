/**
 * The scene in three dimensions: the arm, the board, the cameras, the views. All of it is in the base frame.
 *
 * @typedef {import("./theme.js").Theme} Theme
 * @typedef {import("./kinematics.js").Pose} Pose
 */
import {
  AmbientLight,
  BoxGeometry,
  BufferAttribute,
  Color,
  CylinderGeometry,
  DataTexture,
  DirectionalLight,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  Points,
  PointsMaterial,
  Quaternion,
  Scene,
  SphereGeometry,
  Vector3,
} from "three";
import { forwardKinematics, transform } from "./kinematics.js";
import { darkSquares, frustum, geometryOf, grid, rectangle, sharpEdges, solidGeometry } from "./shapes.js";

const UP_OF_SHAPES = new Vector3(0, 0, 1);

export class Stage {
  /** @param {any} data the scene document */
  constructor(data) {
    this.data = data;
    this.scene = new Scene();
    /** Materials by what they colour; `applyTheme` gives them the page's colours. */
    this.materials = makeMaterials();
    /** One group a link, moved by `showConfiguration`. */
    this.links = data.links.map(() => this.#add(new Group()));
    this.camera = this.#add(new Group());
    this.skeleton = this.#add(new Group());
    /** @type {Map<string, Group>} the small frustums, by the pose's id */
    this.frustums = new Map();
    this.distance = median(data.poses.map((/** @type {any} */ pose) => pose.distance_m)) || 0.5;
    this.up = new Vector3(...data.up).normalize();

    this.#lights();
    this.#solids();
    this.#skeletonOfLinks();
    this.#cameraBody();
    this.#board();
    this.#poses();
    this.#views();
    this.showConfiguration(data.poses[0]?.joints ?? data.joints.map(() => 0), this.distance);
    this.extent = this.#extent();
    this.#ground();
    this.show("bodies", true);
  }

  /** Whether bodies are known of the arm itself; without, it is always drawn as a skeleton. */
  get hasBodies() {
    return this.armSolids > 0;
  }

  /**
   * Moves the arm and its camera.
   *
   * @param {number[]} q joint values in rad or m
   * @param {number} distance m from the camera to the board, to which its frustum is drawn
   */
  showConfiguration(q, distance) {
    const poses = forwardKinematics(this.data, q);
    poses.links.forEach((pose, i) => place(this.links[i], pose));
    place(this.camera, poses.camera);
    this.beam.scale.setScalar(distance);
    for (const bone of this.bones) {
      const from = poses.links[bone.from].position_m;
      const to = bone.to === null ? poses.camera.position_m : poses.links[bone.to].position_m;
      stretch(bone.tube, from, to, bone.radius);
      bone.knob.position.set(...from);
    }
  }

  /** Shows one pose strongly, by the arm's own camera, instead of its small frustum. */
  setChosen(/** @type {string | null} */ id) {
    this.chosen = id;
    for (const [own, group] of this.frustums) group.visible = this.frustumsShown && own !== id;
  }

  /** Marks the small frustum of a pose that is pointed at. */
  setNear(/** @type {string | null} */ id) {
    const { frustumLine, frustumNear } = this.materials;
    for (const [own, group] of this.frustums) {
      group.children[0].material = own === id ? frustumNear : frustumLine;
    }
  }

  /** Marks one of the views swept, by its id; false where the document does not have it. */
  markView(/** @type {string | null} */ id) {
    const index = id === null ? -1 : this.data.views.ids.findIndex((/** @type {number} */ own) => String(own) === id);
    this.mark.visible = index >= 0;
    if (index >= 0) this.mark.position.fromArray(this.data.views.positions_m, 3 * index);
    return index >= 0;
  }

  /** @param {"views" | "frustums" | "bodies"} what */
  show(what, /** @type {boolean} */ shown) {
    if (what === "views") this.views.visible = shown;
    if (what === "frustums") {
      this.frustumsShown = shown;
      this.beam.visible = shown;
      this.setChosen(this.chosen ?? null);
    }
    if (what === "bodies") {
      for (const solid of this.ownSolids) solid.visible = shown;
      this.skeleton.visible = !shown || !this.hasBodies;
    }
  }

  /** Points that a view of everything must have inside. @returns {Vector3[]} */
  #extent() {
    const { board, views, poses } = this.data;
    const half = [(board.columns + 1) * board.square_m * 0.6, (board.rows + 1) * board.square_m * 0.6];
    const points = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) =>
      transform(board.pose, [x * half[0], y * half[1], 0]),
    );
    for (let i = 0; i < views.positions_m.length; i += 3) points.push(views.positions_m.slice(i, i + 3));
    for (const pose of poses) {
      const at = forwardKinematics(this.data, pose.joints);
      points.push(pose.camera.position_m);
      at.links.forEach((link, i) => !this.data.links[i].obstacle && points.push(link.position_m));
      this.data.solids.forEach((/** @type {any} */ { link }, /** @type {number} */ i) => {
        for (const corner of this.solidCorners[i]) points.push(transform(at.links[link], corner));
      });
    }
    return points.map((point) => new Vector3(...point));
  }

  /** Gives everything the page's colours. */
  applyTheme(/** @type {Theme} */ theme) {
    const m = this.materials;
    m.body.color.copy(theme.body);
    m.otherBody.color.copy(theme["body-other"]);
    m.obstacle.color.copy(theme.obstacle);
    m.edge.color.copy(theme.ink);
    m.bone.color.copy(theme.body);
    m.knob.color.copy(theme.accent);
    m.camera.color.copy(theme.chosen);
    m.beam.color.copy(theme.chosen);
    m.beamLine.color.copy(theme.chosen);
    m.frustum.color.copy(theme.ink);
    m.frustumLine.color.copy(theme.ink);
    m.frustumNear.color.copy(theme.chosen);
    m.paper.color.copy(theme["print-light"]);
    m.print.color.copy(theme["print-dark"]);
    m.zone.color.copy(theme.muted);
    m.grid.color.copy(theme.line);
    m.mark.color.copy(theme.chosen);
    m.axes.forEach((axis, i) => axis.color.copy(theme[/** @type {const} */ (["series-2", "series-3", "series-1"])[i]]));
    this.#colourViews(theme);
  }

  /** @template {import("three").Object3D} T */
  #add(/** @type {T} */ object) {
    this.scene.add(object);
    return object;
  }

  #lights() {
    this.#add(new AmbientLight(0xffffff, 1.6));
    const sun = this.#add(new DirectionalLight(0xffffff, 1.7));
    sun.position.copy(this.up).multiplyScalar(2).add(new Vector3(0.7, -1.1, 0.4));
  }

  #solids() {
    this.armSolids = 0;
    /** @type {Group[]} solids that "bodies" hides: all but the obstacles */
    this.ownSolids = [];
    /** @type {number[][][]} of every solid, in its link's frame */
    this.solidCorners = [];
    const moves = this.data.links.map(() => false);
    this.data.links.forEach((/** @type {any} */ link, /** @type {number} */ i) => {
      moves[i] = link.motion !== null || (link.parent !== null && moves[link.parent]);
    });
    for (const { link, pose, shape } of this.data.solids) {
      const surface = solidGeometry(shape);
      this.solidCorners.push(boxAround(surface, pose));
      const obstacle = this.data.links[link].obstacle;
      const { obstacle: standing, body, otherBody } = this.materials;
      const group = new Group();
      group.add(new Mesh(surface, obstacle ? standing : link % 2 ? otherBody : body));
      const edges = sharpEdges(shape, surface);
      if (edges) group.add(new LineSegments(edges, this.materials.edge));
      place(group, pose);
      this.links[link].add(group);
      if (obstacle) continue;
      this.ownSolids.push(group);
      if (moves[link]) this.armSolids++;
    }
  }

  /** Tubes from every link's origin to its children's, thick on the way from the root to the camera. */
  #skeletonOfLinks() {
    const { links, camera_link } = this.data;
    const onTheWay = new Set();
    for (let i = camera_link; i !== null; i = links[i].parent) onTheWay.add(i);
    const tube = new CylinderGeometry(1, 1, 1, 16).rotateX(Math.PI / 2);
    const knob = new SphereGeometry(1, 20, 14);
    const { bone, knob: knobMaterial } = this.materials;
    const between = (/** @type {number} */ from, /** @type {number | null} */ to, /** @type {boolean} */ thick) => {
      const radius = this.distance * (thick ? 0.025 : 0.01);
      const made = { from, to, radius, tube: new Mesh(tube, bone), knob: new Mesh(knob, knobMaterial) };
      made.knob.scale.setScalar(radius * 1.5);
      this.skeleton.add(made.tube, made.knob);
      return made;
    };
    this.bones = links.flatMap((/** @type {any} */ link, /** @type {number} */ i) =>
      link.parent === null || link.obstacle ? [] : [between(link.parent, i, onTheWay.has(i))],
    );
    this.bones.push(between(camera_link, null, true));
  }

  #cameraBody() {
    const size = 0.11 * this.distance;
    const { camera, beam, beamLine } = this.materials;
    const housing = new Mesh(new BoxGeometry(0.8 * size, 0.55 * size, 0.5 * size).translate(0, 0, -0.45 * size), camera);
    const lens = new CylinderGeometry(0.2 * size, 0.2 * size, 0.25 * size, 24).rotateX(Math.PI / 2);
    this.camera.add(housing, new Mesh(lens.translate(0, 0, -0.1 * size), camera));

    this.frustumGeometry = frustum(this.data.camera.outline);
    this.beam = new Group();
    this.beam.add(new LineSegments(this.frustumGeometry.edges, beamLine), new Mesh(this.frustumGeometry.sides, beam));
    this.camera.add(this.beam);
  }

  #board() {
    const { board } = this.data;
    const { paper, print, zone } = this.materials;
    const group = this.#add(new Group());
    place(group, board.pose);
    const [width, height] = [board.columns + 2, board.rows + 2].map((count) => count * board.square_m);
    const thickness = 0.15 * board.square_m;
    group.add(new Mesh(new BoxGeometry(width, height, thickness).translate(0, 0, -thickness / 2), paper));
    group.add(new Mesh(darkSquares(board), print));
    if (board.zone_m) group.add(new LineSegments(rectangle(...board.zone_m), zone));
  }

  #poses() {
    this.frustumsShown = true;
    const { frustumLine, frustum: fill } = this.materials;
    for (const pose of this.data.poses) {
      const group = this.#add(new Group());
      group.add(new LineSegments(this.frustumGeometry.edgesWithGable, frustumLine));
      group.add(new Mesh(this.frustumGeometry.sides, fill));
      place(group, pose.camera);
      group.scale.setScalar(0.15 * this.distance);
      this.frustums.set(String(pose.id), group);
    }
  }

  #views() {
    const { point, mark } = this.materials;
    const { positions_m } = this.data.views;
    const geometry = geometryOf(positions_m);
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(positions_m.length), 3));
    this.views = this.#add(new Points(geometry, point));
    this.mark = this.#add(new Points(geometryOf([0, 0, 0]), mark));
    this.mark.visible = false;
    this.mark.renderOrder = 2;
  }

  /** Smallest and largest tilt of the views in degrees, which the colours span. */
  get tilts() {
    const { tilt_deg } = this.data.views;
    const limits = [Infinity, -Infinity];
    for (const tilt of tilt_deg) limits.splice(0, 2, Math.min(limits[0], tilt), Math.max(limits[1], tilt));
    return limits;
  }

  #colourViews(/** @type {Theme} */ theme) {
    const { tilt_deg } = this.data.views;
    const [least, most] = this.tilts;
    const attribute = this.views.geometry.getAttribute("color");
    const colour = new Color();
    for (let i = 0; i < tilt_deg.length; i++) {
      const part = most > least ? (tilt_deg[i] - least) / (most - least) : 0.5;
      colour.copy(theme["ramp-low"]).lerp(theme["ramp-high"], part);
      attribute.setXYZ(i, colour.r, colour.g, colour.b);
    }
    attribute.needsUpdate = true;
  }

  /** The grid through the root's origin, level, and the axes of the base frame. */
  #ground() {
    const root = this.links[0].position;
    const reach = Math.max(...this.extent.map((point) => point.clone().sub(root).projectOnPlane(this.up).length()));
    this.spacing = roundSpacing(reach / 5);
    const count = Math.ceil(reach / this.spacing);
    const lines = this.#add(new LineSegments(grid(this.spacing, count), this.materials.grid));
    lines.position.copy(root);
    lines.quaternion.copy(new Quaternion().setFromUnitVectors(UP_OF_SHAPES, this.up));

    const tube = new CylinderGeometry(1, 1, 1, 12).rotateX(Math.PI / 2);
    /** Ends of the axes, where their letters are. */
    this.axisEnds = this.materials.axes.map((material, i) => {
      const axis = this.#add(new Mesh(tube, material));
      const end = [0, 0, 0];
      end[i] = 0.25 * this.distance;
      stretch(axis, [0, 0, 0], end, 0.006 * this.distance);
      return new Vector3(...end);
    });
  }
}

function makeMaterials() {
  const lit = (options = {}) => new MeshLambertMaterial(options);
  const line = (opacity = 1) => new LineBasicMaterial({ transparent: opacity < 1, opacity });
  const glass = (/** @type {number} */ opacity) =>
    new MeshBasicMaterial({ transparent: true, opacity, side: DoubleSide, depthWrite: false });
  const disc = discTexture();
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
    paper: lit(),
    // The squares lie in the plate's surface: the offset draws them before it.
    print: lit({ polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2 }),
    zone: line(0.8),
    grid: line(0.8),
    axes: [lit(), lit(), lit()],
    point: new PointsMaterial({ size: 4, sizeAttenuation: false, vertexColors: true, map: disc, alphaTest: 0.5 }),
    mark: new PointsMaterial({ size: 16, sizeAttenuation: false, map: disc, alphaTest: 0.5, depthTest: false }),
  };
}

/** A white disc, which makes points round. */
function discTexture() {
  const size = 32;
  const bytes = new Uint8Array(4 * size * size).fill(255);
  for (let i = 0; i < size * size; i++) {
    const [x, y] = [(i % size) + 0.5 - size / 2, Math.floor(i / size) + 0.5 - size / 2];
    bytes[4 * i + 3] = Math.hypot(x, y) <= size / 2 ? 255 : 0;
  }
  const texture = new DataTexture(bytes, size, size);
  texture.needsUpdate = true;
  return texture;
}

/** Puts an object at a pose of the document. */
function place(/** @type {import("three").Object3D} */ object, /** @type {Pose} */ pose) {
  object.position.set(...pose.position_m);
  object.quaternion.set(...pose.quaternion_xyzw);
}

/** Lets a tube of length and radius 1 along z reach from one point to another. */
function stretch(tube, from, to, radius) {
  const [a, b] = [new Vector3(...from), new Vector3(...to)];
  const length = a.distanceTo(b);
  tube.visible = length > 1e-6;
  if (!tube.visible) return;
  tube.position.copy(a).add(b).multiplyScalar(0.5);
  tube.quaternion.setFromUnitVectors(UP_OF_SHAPES, b.sub(a).divideScalar(length));
  tube.scale.set(radius, radius, length);
}

/** The corners of a box around a solid, in its link's frame. */
function boxAround(/** @type {import("three").BufferGeometry} */ surface, /** @type {Pose} */ pose) {
  surface.computeBoundingBox();
  const { min, max } = surface.boundingBox;
  return [0, 1, 2, 3, 4, 5, 6, 7].map((corner) =>
    transform(pose, [corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z]),
  );
}

/** 1, 2 or 5 times a power of ten, not above `length` by more than it must be. */
function roundSpacing(/** @type {number} */ length) {
  const power = 10 ** Math.floor(Math.log10(length || 1));
  return [1, 2, 5, 10].map((factor) => factor * power).find((spacing) => spacing >= length * 0.999) ?? power;
}

function median(/** @type {number[]} */ values) {
  return [...values].sort((a, b) => a - b)[values.length >> 1];
}
