/** Tables: sorting by a click on a column's header, and copying as tab-separated values. */
import { copyText } from "./copy.js";
import { element } from "./elements.js";

/** Makes every `table.sortable` of the page sortable and copyable. */
export function equipTables() {
  for (const table of document.querySelectorAll("table.sortable")) {
    makeSortable(/** @type {HTMLTableElement} */ (table));
    addCopyButton(/** @type {HTMLTableElement} */ (table));
  }
}

/** What a cell says, without the button that chooses its pose; a number as `data-value` gives it. */
function valueOf(/** @type {Element | undefined} */ cell) {
  if (!cell) return "";
  if (cell.hasAttribute("data-value")) return cell.getAttribute("data-value") ?? "";
  const copy = /** @type {Element} */ (cell.cloneNode(true));
  for (const button of copy.querySelectorAll(".choose")) button.remove();
  return copy.textContent.replace(/\s+/g, " ").trim();
}

/** A plainly written number; spaces may group its digits. NaN for anything else. */
function numberOf(/** @type {string} */ text) {
  const plain = text.replace(/(\d)\s(?=\d)/g, "$1").replace("\u2212", "-");
  return plain === "" ? NaN : Number(plain);
}

/** Numbers where all values of the column are, else texts; empty cells last. A stable order. */
function sorted(/** @type {HTMLTableRowElement[]} */ rows, /** @type {number} */ column, /** @type {number} */ sign) {
  const keyed = rows.map((row) => ({ row, text: valueOf(row.cells[column]) }));
  const numeric = keyed.every(({ text }) => text === "" || !Number.isNaN(numberOf(text)));
  const order = (/** @type {string} */ a, /** @type {string} */ b) =>
    numeric ? numberOf(a) - numberOf(b) : a.localeCompare(b, "en", { numeric: true });
  keyed.sort((a, b) =>
    a.text === "" || b.text === "" ? Number(a.text === "") - Number(b.text === "") : sign * order(a.text, b.text),
  );
  return keyed.map(({ row }) => row);
}

/** Header cells become buttons: ascending, descending, and the order in which the page was written. */
function makeSortable(/** @type {HTMLTableElement} */ table) {
  const body = table.tBodies[0];
  const header = table.tHead?.rows[table.tHead.rows.length - 1];
  if (!body || !header) return;
  const written = [...body.rows];
  for (const cell of header.cells) {
    if (cell.colSpan > 1 || !cell.textContent.trim()) continue;
    const button = element("button", { type: "button", className: "sort" });
    button.append(...cell.childNodes);
    cell.append(button);
    button.addEventListener("click", () => {
      const next = { none: "ascending", ascending: "descending", descending: "none" }[cell.getAttribute("aria-sort") ?? "none"] ?? "none";
      for (const other of header.cells) other.removeAttribute("aria-sort");
      if (next !== "none") cell.setAttribute("aria-sort", next);
      const rows = next === "none" ? written : sorted(written, cell.cellIndex, next === "ascending" ? 1 : -1);
      body.append(...rows);
    });
  }
}

/** The table as it stands, one line a row, for a spreadsheet. */
export function tabSeparated(/** @type {HTMLTableElement} */ table) {
  return [...table.rows].map((row) => [...row.cells].map(valueOf).join("\t")).join("\n") + "\n";
}

function addCopyButton(/** @type {HTMLTableElement} */ table) {
  const name = table.caption?.textContent.trim();
  const button = element("button", { type: "button", textContent: "Copy", title: "Copy the table, for a spreadsheet" });
  if (name) button.setAttribute("aria-label", `Copy the table: ${name}`);
  const outcome = element("span", { role: "status", className: "outcome" });
  button.addEventListener("click", async () => {
    outcome.textContent = (await copyText(tabSeparated(table))) ? "Copied" : "The browser refused to copy";
    setTimeout(() => (outcome.textContent = ""), 2500);
  });
  const tools = element("div", { className: "table-tools" });
  tools.append(outcome, button);
  (table.closest(".scroll") ?? table).before(tools);
}
