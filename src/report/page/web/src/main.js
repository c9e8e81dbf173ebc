/**
 * The script of a report. The page is whole without it; it adds the 3-D view and links it with tables, plots and pictures.
 */
import { Vector3 } from "three";
import { Choice, linkElements, nameMarks, onHover } from "./choose.js";
import { Controls } from "./controls.js";
import { forwardKinematics } from "./kinematics.js";
import { Motion } from "./motion.js";
import { Player } from "./player.js";
import { offerToPrinter } from "./print.js";
import { Stage } from "./scene.js";
import { equipTables } from "./tables.js";
import { readTheme } from "./theme.js";
import { Timeline } from "./timeline.js";
import { Track } from "./track.js";
import { openCanvas, View } from "./view.js";

document.documentElement.classList.add("js");
const source = document.getElementById("scene-data");
const section = document.getElementById("view3d");
const shown = source && section && startView(JSON.parse(source.textContent), section);
// The script of a page with a view stands right after its place, before what is below is read.
if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", linkPage);
else linkPage();

/** The picture beside the view is faint while the arm is not where it is taken. */
function markPicture(/** @type {boolean} */ away) {
  document.getElementById("picture")?.classList.toggle("away", away);
}

/** Chooses the first pose and shows it, if the browser can. */
function startView(/** @type {any} */ data, /** @type {HTMLElement} */ section) {
  const choice = new Choice(data.poses.map((/** @type {any} */ pose) => String(pose.id)));
  const player = data.timeline && new Player(new Timeline(data.timeline));
  const controls = new Controls(section, data, choice, player);
  choice.step(1);
  if (player) linkTour(choice, player);
  show(data, choice, controls, player);
  return { data, choice, player };
}

/** Keeps the chosen pose and the time of the tour with each other: where the arm comes to a pose that is chosen, and the other way round. */
function linkTour(/** @type {Choice} */ choice, /** @type {Player} */ player) {
  player.onTime((time, cause) => {
    if (cause === "chosen") return;
    const last = player.timeline.lastPictureAt(time);
    if (last !== null && last !== choice.id) choice.choose(last, "tour");
    choice.away = player.timeline.pictureAt(time) === null;
    markPicture(choice.away);
  });
  choice.onChange((id, chooser) => {
    markPicture(false);
    if (chooser === "tour") return;
    player.play(false);
    const arrival = player.timeline.arrivalAt(id);
    if (arrival !== null) player.seek(arrival, "chosen");
  });
  document.addEventListener("click", (event) => {
    const button = event.target instanceof Element && event.target.closest("button[data-time]");
    if (!button) return;
    player.play(false);
    player.seek(Number(button.getAttribute("data-time")));
  });
}

/** Links what the page has with the choice, and tables with their tools. */
function linkPage() {
  nameMarks();
  equipTables();
  if (!shown) return;
  const { data, choice, player } = shown;
  linkElements(choice);
  const place = document.querySelector(".timeline");
  if (player && place) new Track(/** @type {HTMLElement} */ (place), data, player, choice);
}

/** Builds the 3-D view and keeps it with the chosen pose. */
function show(
  /** @type {any} */ data,
  /** @type {Choice} */ choice,
  /** @type {Controls} */ controls,
  /** @type {Player | null} */ player,
) {
  const { canvas, context } = openCanvas(controls.frame);
  if (!context) {
    controls.refuse("The 3-D view needs WebGL 2, which this browser does not offer. Everything else of the report is here.");
    return;
  }
  const stage = new Stage(data);
  stage.tint(readTheme());
  const view = new View(controls.frame, canvas, context, stage);
  const poseOf = (/** @type {string} */ id) => data.poses[choice.ids.indexOf(id)];
  const motion = new Motion((q) => {
    stage.showConfiguration(q);
    view.requestRender();
  });

  labelPoses(data, stage, view);
  const setNear = (/** @type {string | null} */ id) => {
    stage.cameras.setNear(id);
    for (const label of view.labels) label.node.classList.toggle("near", id !== null && label.id === id);
    view.requestRender();
  };
  const setChosen = (/** @type {string} */ id) => {
    stage.cameras.setChosen(id);
    for (const label of view.labels) label.node.classList.toggle("chosen", label.id === id);
  };
  setChosen(choice.id ?? "");
  if (choice.id !== null) motion.set(poseOf(choice.id).joints);
  choice.onChange((id, chooser) => {
    setChosen(id);
    if (chooser === "reader") motion.moveTo(poseOf(id).joints);
  });
  player?.onTime((time, cause) => {
    if (cause === "chosen") return;
    stage.cameras.setChosen(player.timeline.pictureAt(time));
    motion.set(player.timeline.configurationAt(time));
  });

  onHover("pose", setNear);
  onHover("view", (id) => {
    stage.views.setMarked(id);
    view.requestRender();
  });
  view.onPointer((id) => choice.choose(id), setNear);
  canvas.setAttribute("aria-describedby", "view3d-help");
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (view.key(event) || controls.key(event)) event.preventDefault();
  });
  controls.homeButton.addEventListener("click", () => view.home());
  const toggle = (/** @type {string} */ label, /** @type {(shown: boolean) => void} */ act) =>
    controls.addToggle(label, (shown) => {
      act(shown);
      view.requestRender();
    });
  if (stage.views.tilts) toggle("Views swept", (shown) => (stage.views.group.visible = shown));
  toggle("Frustums", (shown) => {
    stage.cameras.show(shown);
    view.overlay.classList.toggle("without-poses", !shown);
  });
  if (stage.arm.hasBodies) toggle("Bodies", (shown) => stage.arm.showBodies(shown));
  controls.addLegend(stage.views.tilts, stage.ground.spacing);

  const retint = () => {
    stage.tint(readTheme());
    view.requestRender();
  };
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", retint);
  offerToPrinter(view, retint);

  view.render();
  view.finish();
  performance.mark("calipose-first-frame");
  offerHook(data, choice, player, stage, view, motion);
}

/** Numbers beside the cameras, letters at the base frame's axes. */
function labelPoses(/** @type {any} */ data, /** @type {Stage} */ stage, /** @type {View} */ view) {
  for (const pose of data.poses) {
    view.addLabel(pose.label, "pose", new Vector3().fromArray(pose.camera.position_m), String(pose.id));
  }
  stage.axes.ends.forEach((end, i) => view.addLabel("xyz"[i], "axis", end));
}

/** What the check of the page looks at: `window.caliposeReport`. */
function offerHook(data, choice, player, stage, view, motion) {
  Object.assign(window, {
    caliposeReport: {
      poses: data.poses,
      timeline: data.timeline,
      chosen: () => choice.id,
      /** Time of the tour that is shown now, in s. */
      time: () => player?.time ?? null,
      playing: () => player?.playing ?? false,
      /** Joint values in rad or m at a time of the tour. */
      configurationAt: (/** @type {number} */ time) => player.timeline.configurationAt(time),
      /** Joint values in rad or m that are shown now. */
      configuration: () => motion.q,
      moving: () => motion.moving,
      /** The camera's pose in the base frame at joint values, by the page's own kinematics. */
      cameraAt: (/** @type {number[]} */ q) => forwardKinematics(data, q).camera,
      /** Where a pose's camera is in the window, in CSS pixels. */
      project: (/** @type {number} */ id) =>
        view.project(stage.cameras.frustums.get(String(id))?.group.position ?? new Vector3()),
      /** Draws now and returns the canvas, to be read before the next frame. */
      render: () => (view.render(), view.canvas),
    },
  });
}
