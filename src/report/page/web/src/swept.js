/** The views that the sweep found, as points coloured by their tilt. */
import { BufferAttribute, Color, Group, Points } from "three";
import { geometryOf } from "./shapes.js";

export class SweptViews {
  /**
   * @param {{ids: number[], positions_m: number[], tilt_deg: number[]}} views
   * @param {import("./materials.js").Materials} materials
   */
  constructor(views, materials) {
    this.views = views;
    const geometry = geometryOf(views.positions_m);
    this.colours = new BufferAttribute(new Float32Array(views.positions_m.length), 3);
    geometry.setAttribute("color", this.colours);
    this.mark = new Points(geometryOf([0, 0, 0]), materials.viewMark);
    this.mark.visible = false;
    this.mark.renderOrder = 1;
    this.group = new Group().add(new Points(geometry, materials.view), this.mark);
    /** Smallest and largest tilt in degrees, which the colours span; null without views. */
    this.tilts = views.tilt_deg.length
      ? views.tilt_deg.reduce(([least, most], tilt) => [Math.min(least, tilt), Math.max(most, tilt)], [Infinity, -Infinity])
      : null;
  }

  /** Marks the view with this id; none where it is null or not among them, as a page may have only a sample. */
  setMarked(/** @type {string | null} */ id) {
    const index = id === null ? -1 : this.views.ids.indexOf(Number(id));
    this.mark.visible = index >= 0;
    if (index >= 0) this.mark.position.fromArray(this.views.positions_m, 3 * index);
  }

  tint(/** @type {import("./theme.js").Theme} */ theme) {
    const [least, most] = this.tilts ?? [0, 0];
    const colour = new Color();
    this.views.tilt_deg.forEach((tilt, i) => {
      const part = most > least ? (tilt - least) / (most - least) : 0.5;
      colour.lerpColors(theme["ramp-low"], theme["ramp-high"], part);
      this.colours.setXYZ(i, colour.r, colour.g, colour.b);
    });
    this.colours.needsUpdate = true;
  }
}
