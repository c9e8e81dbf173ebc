// Writes a report of an invented arm by the page's contract, for work on the page's script and style: `node mock.mjs PAGE.html`.
// Its kinematics are matrices by Rodrigues' formula, apart from the quaternions of the page.
import { readFile, writeFile } from "node:fs/promises";

const WEB = new URL("../../../src/report/page/web/", import.meta.url);
const POSES = 10;
const VIEWS = 4000;

/** Numbers in [0, 1), always the same (mulberry32). */
let seed = 2026;
function random() {
  seed = (seed + 0x6d2b79f5) | 0;
  let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
  t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
  return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
}

// Rigid motions as [R, p] with R three rows.
const apply = ([R, p], v) => R.map((row, i) => row[0] * v[0] + row[1] * v[1] + row[2] * v[2] + p[i]);
const column = (R, j) => R.map((row) => row[j]);
const times = ([R, p], [S, q]) => [
  R.map((row) => [0, 1, 2].map((j) => column(S, j).reduce((sum, value, k) => sum + row[k] * value, 0))),
  apply([R, p], q),
];
const inverse = ([R, p]) => {
  const T = [0, 1, 2].map((j) => column(R, j));
  return [T, apply([T, [0, 0, 0]], p).map((value) => -value)];
};
const shift = (p) => [[[1, 0, 0], [0, 1, 0], [0, 0, 1]], p];
function turn([x, y, z], angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const C = 1 - c;
  return [[[c + x * x * C, x * y * C - z * s, x * z * C + y * s], [y * x * C + z * s, c + y * y * C, y * z * C - x * s],
    [z * x * C - y * s, z * y * C + x * s, c + z * z * C]], [0, 0, 0]];
}
function pose([R, p]) {
  // Shepperd's method, the branch of the largest component.
  const t = R[0][0] + R[1][1] + R[2][2];
  const four = [R[0][0], R[1][1], R[2][2]].map((d) => Math.sqrt(Math.max(0, 1 + 2 * d - t))).concat(Math.sqrt(Math.max(0, 1 + t)));
  const k = four.indexOf(Math.max(...four));
  const q = [0, 0, 0, 0];
  q[k] = four[k] / 2;
  const [a, b, c] = [R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1]];
  const [d, e, f] = [R[0][1] + R[1][0], R[0][2] + R[2][0], R[1][2] + R[2][1]];
  const rest = [[0, d, e, a], [d, 0, f, b], [e, f, 0, c], [a, b, c, 0]][k];
  rest.forEach((value, i) => { if (i !== k) q[i] = value / (4 * q[k]); });
  return { position_m: p, quaternion_xyzw: q };
}

const HALF = Math.PI / 2;
const joints = [
  { name: "waist", kind: "revolute", unit: "deg", min: -70, max: 70 },
  { name: "shoulder", kind: "revolute", unit: "deg", min: -70, max: 60 },
  { name: "slide", kind: "prismatic", unit: "mm", min: 0, max: 180 },
  { name: "wrist", kind: "revolute", unit: "deg", min: -75, max: 75 },
];
const motion = (joint, axis, multiplier = 1, offset = 0) => ({ joint, kind: joints[joint].kind, axis, multiplier, offset });
const links = [
  { name: "vehicle", parent: null, X: shift([0, 0, 0]), motion: null },
  { name: "mount", parent: 0, X: shift([0.05, 0, 0.18]), motion: null },
  { name: "column", parent: 1, X: shift([0, 0, 0.05]), motion: motion(0, [0, 0, 1]) },
  { name: "upper arm", parent: 2, X: shift([0, 0, 0.16]), motion: motion(1, [0, 1, 0], 1, -0.3) },
  { name: "forearm", parent: 3, X: times(shift([0, 0, 0.34]), turn([0, 1, 0], HALF)), motion: motion(2, [0, 0, 1]) },
  { name: "head", parent: 4, X: times(shift([0, 0, 0.26]), turn([0, 1, 0], -HALF)), motion: motion(3, [0, -1, 0]) },
  { name: "iris", parent: 5, X: shift([0.03, 0, 0]), motion: motion(2, [1, 0, 0], 0.1) },
  { name: "pillar", parent: 0, X: shift([0.75, -0.55, 0]), motion: null, obstacle: true },
];
const X_base_board = [[[0, 0, -1], [-1, 0, 0], [0, 1, 0]], [0.95, 0.08, 0.28]];
// z forward, x right, y down, at the head's front
const X_head_camera = [[[0, 0, 1], [-1, 0, 0], [0, -1, 0]], [0.06, 0, 0.02]];
const board = { columns: 9, rows: 6, square_m: 0.03, zone_m: [0.36, 0.27] };
const lens = { f: 900, width: 1280, height: 720 };

/** Poses of links and camera in the mount's frame, which is the base. */
function kinematics(q) {
  const inRoot = [];
  for (const { parent, X, motion: m } of links) {
    const value = m ? m.multiplier * q[m.joint] + m.offset : 0;
    const moved = !m ? shift([0, 0, 0]) : m.kind === "prismatic" ? shift(m.axis.map((a) => a * value)) : turn(m.axis, value);
    inRoot.push(times(times(parent === null ? shift([0, 0, 0]) : inRoot[parent], X), moved));
  }
  const back = inverse(inRoot[1]);
  return { camera: times(times(back, inRoot[5]), X_head_camera) };
}

const pixels = (X_base_camera) => {
  const X = times(inverse(X_base_camera), X_base_board);
  const corners = [];
  for (let row = 0; row < board.rows; row++) {
    for (let col = 0; col < board.columns; col++) {
      const [x, y, z] = apply(X, [(col - 4) * board.square_m, (row - 2.5) * board.square_m, 0]);
      corners.push([(lens.f * x) / z + lens.width / 2, (lens.f * y) / z + lens.height / 2, z]);
    }
  }
  return corners;
};

const degrees = (angle) => (angle * 180) / Math.PI;
const found = [];
for (let id = 1; found.length < VIEWS; id++) {
  const display = joints.map(({ min, max }) => min + random() * (max - min));
  const q = display.map((value, i) => (joints[i].unit === "deg" ? (value * Math.PI) / 180 : value / 1000));
  const { camera } = kinematics(q);
  const corners = pixels(camera);
  if (!corners.every(([u, v, z]) => z > 0.1 && u > 0 && u < lens.width && v > 0 && v < lens.height)) continue;
  const normal = column(X_base_board[0], 2);
  const away = camera[1].map((value, i) => value - X_base_board[1][i]);
  const distance = Math.hypot(...away);
  const facing = normal.reduce((sum, value, i) => sum + value * away[i], 0) / distance;
  const tilt = degrees(Math.acos(-column(camera[0], 2).reduce((sum, value, i) => sum + value * normal[i], 0)));
  if (facing > 0.2) found.push({ id: id * 17, q, display, camera, corners, tilt, distance });
}
// Chosen: far from one another in what they are, greedily.
const chosen = [found[0]];
while (chosen.length < POSES) {
  const apart = (a, b) => Math.hypot(...a.q.map((value, i) => value - b.q[i]), (a.distance - b.distance) * 2);
  const worth = (view) => Math.min(...chosen.map((other) => apart(view, other)));
  chosen.push(found.reduce((best, view) => (worth(view) > worth(best) ? view : best)));
}
const share = chosen.map((_, i) => (1.3 - 0.06 * i) / 10.3);

const outline = [];
const border = 16;
for (const [from, to] of [[[0, 0], [1, 0]], [[1, 0], [1, 1]], [[1, 1], [0, 1]], [[0, 1], [0, 0]]]) {
  for (let i = 0; i < border; i++) {
    const [x, y] = [0, 1].map((k) => from[k] + ((to[k] - from[k]) * i) / border - 0.5);
    const [u, v] = [(x * lens.width) / lens.f, (y * lens.height) / lens.f];
    const bent = 1 + 0.08 * (u * u + v * v);
    outline.push([u * bent, v * bent]);
  }
}

// A wedge as a mesh: a vehicle's nose.
const wedge = { kind: "mesh", vertices_m: [0, -0.16, 0, 0, 0.16, 0, 0.16, 0.16, 0, 0.16, -0.16, 0, 0, -0.16, 0.16, 0, 0.16, 0.16],
  triangles: [0, 1, 2, 0, 2, 3, 0, 4, 5, 0, 5, 1, 3, 2, 5, 3, 5, 4, 0, 3, 4, 1, 5, 2] };
const solid = (link, X, shape) => ({ link, pose: pose(X), shape });
const scene = {
  format: "calipose.scene", version: 1, calipose: "0.1.0",
  problem: { name: "Invented arm", sha256: "0".repeat(64) },
  joints,
  links: links.map(({ name, parent, X, motion: m, obstacle = false }) => ({ name, parent, origin: pose(X), motion: m, obstacle })),
  base_link: 1, camera_link: 5,
  solids: process.argv.includes("--without-bodies") ? [] : [
    solid(0, shift([-0.1, 0, 0.1]), { kind: "box", size_m: [0.5, 0.32, 0.16] }),
    solid(0, shift([0.15, 0, 0.02]), wedge),
    ...[[-0.28, 0.2], [-0.28, -0.2], [0.1, 0.2], [0.1, -0.2]].map(([x, y]) =>
      solid(0, times(shift([x, y, 0.06]), turn([1, 0, 0], HALF)), { kind: "cylinder", radius_m: 0.07, length_m: 0.06 })),
    solid(2, shift([0, 0, 0.06]), { kind: "cylinder", radius_m: 0.06, length_m: 0.18 }),
    solid(2, shift([0, 0, 0.16]), { kind: "sphere", radius_m: 0.065 }),
    solid(3, shift([0, 0, 0.17]), { kind: "capsule", radius_m: 0.04, length_m: 0.28 }),
    solid(3, shift([0, 0, 0.34]), { kind: "sphere", radius_m: 0.055 }),
    solid(4, shift([0, 0, 0.12]), { kind: "box", size_m: [0.05, 0.06, 0.26] }),
    solid(5, shift([-0.01, 0, 0]), { kind: "box", size_m: [0.08, 0.07, 0.07] }),
    solid(6, times(shift([0.02, 0, 0.02]), turn([0, 1, 0], HALF)), { kind: "cylinder", radius_m: 0.02, length_m: 0.03 }),
    solid(7, shift([0, 0, 0.35]), { kind: "box", size_m: [0.12, 0.12, 0.7] }),
  ],
  board: { pose: pose(X_base_board), ...board },
  camera: { pose: pose(X_head_camera), width_px: lens.width, height_px: lens.height, outline },
  views: { ids: found.map((view) => view.id), positions_m: found.flatMap((view) => view.camera[1].map((x) => Number(x.toFixed(4)))),
    tilt_deg: found.map((view) => view.tilt), distance_m: found.map((view) => view.distance) },
  poses: chosen.map((view, i) => ({ id: view.id, joints: view.q, joints_display: view.display, camera: pose(view.camera),
    tilt_deg: view.tilt, distance_m: view.distance, share: share[i], label: String(i + 1) })),
  up: [0, 0, 1],
};

// The page

const table = (name, head, rows, tall = "") => `<div class="scroll${tall}" role="region" tabindex="0" aria-label="${name}">
<table class="sortable"><caption>${name}</caption>
<thead><tr>${head.map((cell) => `<th scope="col">${cell}</th>`).join("")}</tr></thead>
<tbody>
${rows.join("\n")}
</tbody></table></div>`;

const poseRows = chosen.map((view, i) => `<tr data-pose="${view.id}"><td data-value="${i + 1}"><button type="button" class="choose" aria-label="Show pose ${i + 1}">show</button>${i + 1}</td><td>${view.id}</td>${
  view.display.map((value, j) => `<td>${value.toFixed(joints[j].unit === "deg" ? 1 : 0)}</td>`).join("")
}<td>${view.tilt.toFixed(1)}</td><td>${(1000 * view.distance).toFixed(0)}</td><td data-value="${share[i]}">${(100 * share[i]).toFixed(1)} %</td></tr>`);

const intrinsics = [["f<sub>x</sub>", 900, 1.1], ["f<sub>y</sub>", 900, 1.2], ["c<sub>x</sub>", 640, 1.9], ["c<sub>y</sub>", 360, 1.7], ["k<sub>1</sub>", -0.12, 0.004]];
const intrinsicRows = intrinsics.map(([name, value, sd]) => `<tr><td>${name}</td><td>${String(value).replace("-", "\u2212")}</td><td>${sd}</td><td class="wrap">Standard deviation over simulated calibrations agrees with the prediction.</td></tr>`);

const frameOfPlot = (title, label, xs, ys, content) => `<figure class="plot"><svg viewBox="0 0 480 300" role="img" aria-label="${label}">
${xs.map(([x, text]) => `<path class="gridline" d="M${x} 16V250"/><text x="${x}" y="268" text-anchor="middle">${text}</text>`).join("")}
${ys.map(([y, text]) => `<path class="gridline" d="M48 ${y}H470"/><text x="42" y="${y + 4}" text-anchor="end">${text}</text>`).join("")}
${content}</svg><figcaption>${title}</figcaption></figure>`;
const tiltX = (view) => 48 + (view.tilt / 80) * 422;
const distanceY = (view) => 250 - ((view.distance - 0.2) / 1.0) * 234;
const scatter = frameOfPlot("Views swept, and the chosen poses, by tilt and distance.", "Distance against tilt",
  [0, 20, 40, 60, 80].map((t) => [48 + (t / 80) * 422, `${t}°`]), [0.2, 0.6, 1, 1.2].map((d) => [250 - (d - 0.2) * 234, `${d} m`]),
  found.filter((_, i) => i % 10 === 0).map((view) => `<circle cx="${tiltX(view).toFixed(1)}" cy="${distanceY(view).toFixed(1)}" r="2" fill="var(--series-6)"><title>view ${view.id}, tilt ${view.tilt.toFixed(1)}°</title></circle>`).join("") +
  chosen.map((view, i) => `<g><title>pose ${view.id}: number ${i + 1}</title><circle cx="${tiltX(view).toFixed(1)}" cy="${distanceY(view).toFixed(1)}" r="6" fill="var(--series-1)"/></g>`).join(""));
const bars = frameOfPlot("Share of the information, pose by pose.", "Share of the information",
  chosen.map((_, i) => [70 + i * 41, i + 1]), [0, 0.05, 0.1, 0.15].map((s) => [250 - s * 1500, `${100 * s} %`]),
  chosen.map((view, i) => `<rect x="${56 + i * 41}" y="${(250 - share[i] * 1500).toFixed(1)}" width="28" height="${(share[i] * 1500).toFixed(1)}" fill="var(--series-1)"><title>pose ${view.id}: ${(100 * share[i]).toFixed(1)} %</title></rect>`).join(""));

const panels = chosen.map((view, i) => `<article class="panel" data-pose-panel="${view.id}">
<h3>Pose ${i + 1}</h3>
<svg viewBox="0 0 1280 720" role="img" aria-label="What the camera sees at pose ${i + 1}"><rect width="1280" height="720" fill="none" stroke="var(--line)" stroke-width="4"/>
${view.corners.map(([u, v]) => `<circle cx="${u.toFixed(1)}" cy="${v.toFixed(1)}" r="9" fill="var(--series-1)"/>`).join("")}</svg>
<dl class="facts"><dt>configuration</dt><dd>${view.id}</dd>${joints.map((joint, j) => `<dt>${joint.name}</dt><dd>${view.display[j].toFixed(1)} ${joint.unit === "deg" ? "°" : "mm"}</dd>`).join("")}
<dt>tilt</dt><dd>${view.tilt.toFixed(1)}°</dd><dt>distance</dt><dd>${(1000 * view.distance).toFixed(0)} mm</dd></dl>
</article>`);

const [css, script] = await Promise.all(["report.css", "dist/report.js"].map((file) => readFile(new URL(file, WEB), "utf8")));
const page = `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Invented arm: calibration poses</title>
<style>
${css}</style>
</head>
<body>
<header class="page-head">
<p class="kicker">calipose 0.1.0 · report of plan.json</p>
<h1>Invented arm</h1>
<p class="verdict good"><strong>The plan does what it predicts.</strong> No 10 of the 4 000 views can give more than 1.87 % more information.</p>
<dl class="figures">
<div><dt>Poses</dt><dd>10 <small>of 4 000 views</small></dd></div>
<div><dt>Map error</dt><dd>1.62 <small>px RMS</small></dd><dd>measured 1.59 px</dd></div>
<div><dt>Certified efficiency</dt><dd>0.982</dd></div>
<div><dt>k-means, 10 poses</dt><dd>19.6 <small>px RMS</small></dd></div>
</dl>
</header>
<nav class="contents" aria-label="Contents"><a href="#poses">Poses</a><a href="#plots">Plots</a><a href="#intrinsics">Intrinsics</a></nav>
<main>
<div class="stage">
<section id="view3d" hidden><h2>The poses in space</h2></section>
<section id="picture"><h2>What the camera sees</h2>
<div class="panels">
${panels.join("\n")}
</div></section>
</div>
<section id="poses"><h2>Poses</h2>
<p>Joint values of the ten poses, in the order of their share of the information.</p>
${table("Poses", ["Pose", "Configuration", ...joints.map((joint) => `${joint.name}, ${joint.unit === "deg" ? "°" : "mm"}`), "Tilt, °", "Distance, mm", "Share"], poseRows)}
</section>
<section id="plots"><h2>Plots</h2>
<div class="plots">
${scatter}
${bars}
</div></section>
<section id="intrinsics"><h2>Intrinsics</h2>
${table("Intrinsics", ["Parameter", "Nominal", "Standard deviation", "Remark"], intrinsicRows)}
</section>
</main>
<footer class="page-foot">Made by calipose 0.1.0. Problem <code>${scene.problem.sha256}</code>.</footer>
<script type="application/json" id="scene-data">${JSON.stringify(scene).replaceAll("</", "<\\/")}</script>
<script>${script}</script>
</body>
</html>
`;
await writeFile(process.argv[2], page);
