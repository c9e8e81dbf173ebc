/** The 3-D view on paper: WebGL's canvas would be empty there, so a copy is printed, in the colours of the light scheme. */
import { element } from "./elements.js";

/**
 * @param {import("./view.js").View} view
 * @param {() => void} retint gives the scene the colours that the style sheet has now
 */
export function offerToPrinter(view, retint) {
  const copy = element("canvas", { className: "print-picture", role: "img", "aria-label": "The arm at the chosen pose, and all poses" });
  view.frame.append(copy);
  const onPaper = (/** @type {boolean} */ on) => {
    document.documentElement.classList.toggle("on-paper", on);
    retint();
  };
  window.addEventListener("beforeprint", () => {
    onPaper(true);
    view.render();
    copy.width = view.canvas.width;
    copy.height = view.canvas.height;
    copy.getContext("2d")?.drawImage(view.canvas, 0, 0);
    view.frame.style.setProperty("--ratio", String(copy.width / copy.height));
  });
  window.addEventListener("afterprint", () => onPaper(false));
}
