// What every check of a page needs: the browser, pages opened in it, and what holds for all pages.
//
// The browser is /usr/bin/chromium or $CHROMIUM; screenshots and printed pages go to the folder $SHOTS, if it is set.
import assert from "node:assert/strict";
import { mkdir, readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";
import { chromium } from "playwright-core";

export const WIDE = { width: 1440, height: 960 };
export const PHONE = { width: 360, height: 740 };
const AXE = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

const SHOTS = process.env.SHOTS;
if (SHOTS) await mkdir(SHOTS, { recursive: true });

/** Chromium without a graphics card: WebGL by SwiftShader, or none. */
export const launch = (...graphics) =>
  chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
      "--disable-sync", ...graphics],
  });
/** Chromium as it is on any machine. */
export const launchWithView = () => launch("--use-angle=swiftshader", "--enable-unsafe-swiftshader");

/** Claims that did not hold. */
export let failures = 0;

export async function check(claim, hold) {
  try {
    const remark = await hold();
    console.log(`ok    ${claim}${remark ? `: ${remark}` : ""}`);
  } catch (error) {
    failures++;
    console.log(`FAIL  ${claim}\n      ${String(error.message).replaceAll("\n", "\n      ")}`);
  }
}

/** Opens the page; what it complains of and asks the network for is collected in `page.complaints`. */
export async function open(browser, address, options = {}) {
  const context = await browser.newContext({ viewport: WIDE, reducedMotion: "reduce", ...options });
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  const page = await context.newPage();
  page.complaints = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) page.complaints.push(`${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => page.complaints.push(`error: ${error.message}`));
  page.on("request", (request) => {
    if (request.url() !== address && !/^(data|blob):/.test(request.url())) page.complaints.push(`request: ${request.url()}`);
  });
  await page.goto(address);
  return page;
}

export const close = (page) => page.context().close();

export const shoot = (page, name) => SHOTS && page.screenshot({ path: join(SHOTS, `${name}.png`), fullPage: true });
export const print = (page, name) => SHOTS && page.pdf({ path: join(SHOTS, `${name}.pdf`), format: "A4", preferCSSPageSize: true });

export async function assertAccessible(page, where) {
  await page.evaluate(AXE);
  const { violations, passes } = await page.evaluate(() => window.axe.run());
  const told = violations.flatMap(({ id, help, nodes }) =>
    nodes.map((node) => `${where}: ${id}: ${help}: ${node.html.slice(0, 160)} ${node.any[0]?.message ?? ""}`),
  );
  assert.deepEqual(told, []);
  return `${passes.length} rules`;
}

/** In a narrow window everything is in sight, or in a region that scrolls, has a name and takes the focus. */
export async function assertNothingCutOff(page) {
  const faults = await page.evaluate(() => {
    const told = [];
    for (const node of [document.documentElement, document.body]) {
      if (node.scrollWidth > node.clientWidth) told.push(`${node.tagName} is ${node.scrollWidth} px wide`);
    }
    for (const node of document.querySelectorAll("body *")) {
      if (node.closest(".scroll, .frame, svg, script") && !node.matches(".scroll, .frame, svg")) continue;
      const box = node.getBoundingClientRect();
      const name = `${node.tagName.toLowerCase()}.${node.getAttribute("class") ?? ""}`;
      if (box.width && (box.right > innerWidth + 0.5 || box.left < -0.5)) told.push(`${name} reaches from ${box.left} to ${box.right}`);
      const cut = getComputedStyle(node).overflowX === "hidden" && node.scrollWidth > node.clientWidth;
      if (cut) told.push(`${name} is cut off`);
    }
    for (const table of document.querySelectorAll("table")) {
      const region = table.closest(".scroll");
      if (table.offsetWidth > (region ?? document.documentElement).clientWidth && !region) told.push("a wide table has no region");
      const named = region?.hasAttribute("aria-label") || region?.hasAttribute("aria-labelledby");
      if (region && !(region.tabIndex === 0 && region.getAttribute("role") === "region" && named)) told.push("a region has no focus or name");
    }
    return told;
  });
  assert.deepEqual(faults, []);
}

/** There are some of each of `parts`, and all can be seen. */
export async function assertAllVisible(page, parts) {
  for (const part of parts) {
    const [count, visible] = await Promise.all([page.locator(part).count(), page.locator(`${part}:visible`).count()]);
    assert(count > 0, `${part}: none`);
    assert.equal(visible, count, part);
  }
}
