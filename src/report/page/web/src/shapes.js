/** Geometry of what the scene document describes, and of the few signs that the view adds. Lengths in m. */
import {
  BoxGeometry,
  BufferGeometry,
  CapsuleGeometry,
  CylinderGeometry,
  EdgesGeometry,
  Float32BufferAttribute,
  SphereGeometry,
} from "three";

/** Meshes with more triangles than this are drawn without their sharp edges, which take long to find. */
const EDGES_UP_TO_TRIANGLES = 3000;

/**
 * A geometry from coordinates, and the indices of its triangles where it has some.
 *
 * @param {number[]} coordinates
 * @param {number[] | null} [triangles]
 */
export function geometryOf(coordinates, triangles = null) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(coordinates, 3));
  if (triangles) geometry.setIndex(triangles);
  return geometry;
}

/** The surface of a solid; the triangles of a mesh are flat, whatever its vertices share. */
export function solidGeometry(/** @type {any} */ shape) {
  switch (shape.kind) {
    case "box":
      return new BoxGeometry(...shape.size_m);
    case "sphere":
      return new SphereGeometry(shape.radius_m, 32, 20);
    // three.js has these two along y, the document along z.
    case "cylinder":
      return new CylinderGeometry(shape.radius_m, shape.radius_m, shape.length_m, 40).rotateX(Math.PI / 2);
    case "capsule":
      return new CapsuleGeometry(shape.radius_m, shape.length_m, 10, 32).rotateX(Math.PI / 2);
    default: {
      const flat = geometryOf(shape.vertices_m, shape.triangles).toNonIndexed();
      flat.computeVertexNormals();
      return flat;
    }
  }
}

/** The sharp edges of a solid, or null where there are none or too much to look at. */
export function sharpEdges(/** @type {any} */ shape, /** @type {BufferGeometry} */ surface) {
  const triangles = (surface.index ?? surface.getAttribute("position")).count / 3;
  const smooth = shape.kind === "sphere" || shape.kind === "capsule";
  return smooth || triangles > EDGES_UP_TO_TRIANGLES ? null : new EdgesGeometry(surface, 35);
}

/** Convex polygons in the plane z = 0. */
export function polygons(/** @type {number[][][]} */ outlines) {
  const coordinates = [];
  const triangles = [];
  for (const outline of outlines) {
    const first = coordinates.length / 3;
    for (const [x, y] of outline) coordinates.push(x, y, 0);
    for (let i = 2; i < outline.length; i++) triangles.push(first, first + i - 1, first + i);
  }
  return geometryOf(coordinates, triangles);
}

/** The four edges of a rectangle in the plane z = 0, centred, as pairs of points. */
export function rectangle(/** @type {number} */ width, /** @type {number} */ height) {
  const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => [(x * width) / 2, (y * height) / 2, 0]);
  return geometryOf(loop(corners).flat());
}

/** Each point with the one after it, around. */
function loop(/** @type {number[][]} */ points) {
  return points.flatMap((point, i) => [point, points[(i + 1) % points.length]]);
}

/**
 * What a camera sees down to the depth 1: `outline` is the border of its picture as rays (x, y, 1).
 *
 * @param {number[][]} outline
 */
export function frustum(outline) {
  const border = outline.map(([x, y]) => [x, y, 1]);
  // The rays next to the picture's corners are drawn; the border may be bent by the lens.
  const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([sx, sy]) =>
    border.reduce((best, ray) => (sx * ray[0] + sy * ray[1] > sx * best[0] + sy * best[1] ? ray : best)),
  );
  const rays = corners.flatMap((corner) => [[0, 0, 0], corner]);
  const [left, right] = corners;
  // A gable says which side of the picture is its upper one.
  const gable = [(left[0] + right[0]) / 2, Math.min(left[1], right[1]) - 0.25 * (right[0] - left[0]), 1];
  const sides = geometryOf([0, 0, 0, ...border.flat()], border.flatMap((_, i) => [0, i + 1, ((i + 1) % border.length) + 1]));
  return {
    corners,
    sides,
    edges: geometryOf([...loop(border), ...rays].flat()),
    edgesWithGable: geometryOf([...loop(border), ...rays, left, gable, gable, right].flat()),
  };
}

/** Lines of a square grid in the plane z = 0, around the origin, `count` squares to each side. */
export function grid(/** @type {number} */ spacing, /** @type {number} */ count) {
  const coordinates = [];
  const end = spacing * count;
  for (let i = -count; i <= count; i++) {
    coordinates.push(i * spacing, -end, 0, i * spacing, end, 0, -end, i * spacing, 0, end, i * spacing, 0);
  }
  return geometryOf(coordinates);
}
