/** What stands still: the board, the ground's grid, the axes of the base frame. */
import { BoxGeometry, Group, LineSegments, Mesh, Vector3 } from "three";
import { makeBar, place, stretch } from "./placing.js";
import { grid, polygons, rectangle } from "./shapes.js";

/** @typedef {import("./materials.js").Materials} Materials */

/** The printed board as a plate, a little wider than what is printed, and the border of its zone. */
export function makeBoard(/** @type {any} */ board, /** @type {Materials} */ materials) {
  const [width, height] = board.size_m.map((/** @type {number} */ side) => side + board.spacing_m);
  const thickness = 0.15 * board.spacing_m;
  const plate = new BoxGeometry(width, height, thickness).translate(0, 0, -thickness / 2);
  const group = new Group().add(new Mesh(plate, materials.boardLight), new Mesh(polygons(board.pattern_m), materials.boardDark));
  if (board.zone_m) group.add(new LineSegments(rectangle(board.zone_m[0], board.zone_m[1]), materials.zone));
  place(group, board.pose);
  return group;
}

/**
 * A level grid around `origin`, which reaches under all `points`.
 *
 * @returns {{lines: LineSegments, spacing: number}} the width of its squares in m
 */
export function makeGround(
  /** @type {Vector3} */ origin,
  /** @type {Vector3} */ up,
  /** @type {Vector3[]} */ points,
  /** @type {Materials} */ materials,
) {
  const away = (/** @type {Vector3} */ point) => point.clone().sub(origin).projectOnPlane(up).length();
  const reach = points.reduce((most, point) => Math.max(most, away(point)), 0);
  const spacing = roundUp(reach / 5);
  const lines = new LineSegments(grid(spacing, Math.ceil(reach / spacing)), materials.grid);
  lines.position.copy(origin);
  lines.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), up);
  return { lines, spacing };
}

/** The axes of the base frame; `ends` are where their letters are put. */
export function makeAxes(/** @type {number} */ length, /** @type {Materials} */ materials) {
  const ends = [0, 1, 2].map((axis) => new Vector3().setComponent(axis, length));
  const bars = materials.axes.map((material, i) => {
    const bar = makeBar(material);
    stretch(bar, [0, 0, 0], ends[i].toArray(), 0.024 * length);
    return bar;
  });
  return { group: new Group().add(...bars), ends };
}

/** The next of 1, 2, 5, 10 times a power of ten. */
function roundUp(/** @type {number} */ length) {
  const power = 10 ** Math.floor(Math.log10(length || 1));
  return [1, 2, 5].map((factor) => factor * power).find((round) => round >= length) ?? 10 * power;
}
