// Opens the report of a plan in Chromium, from disk as a reader does, and holds it to what it must show and do: node check.mjs PAGE.html
import assert from "node:assert/strict";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import {
  PHONE, assertAccessible, assertAllVisible, assertNothingCutOff, check, close, failures, launch, launchWithView, open, print, shoot,
} from "./browser.mjs";

/** For a machine with a core to spare; a busy one may be given longer. */
const FIRST_FRAME_MS = Number(process.env.FIRST_FRAME_MS ?? 1000);
/** The page is opened until its first frame comes in time, at most this often: what else the machine does can only add. */
const LOADS = 20;

const [file] = process.argv.slice(2);
if (!file) throw new Error("usage: node check.mjs PAGE.html");
const address = pathToFileURL(resolve(file)).href;
const browser = await launchWithView();

/** Opens the page and waits for its 3-D view; the time is in `page.firstFrame`, ms from the start of the navigation. */
async function openView(options) {
  const page = await open(browser, address, options);
  const mark = () => performance.getEntriesByName("calipose-first-frame")[0]?.startTime;
  page.firstFrame = await (await page.waitForFunction(mark, null, { timeout: 30_000 })).jsonValue();
  return page;
}

const chosen = (page) => page.evaluate(() => window.caliposeReport.chosen());
const status = (page) => page.locator("#view3d .status").textContent();
const ids = (page) => page.evaluate(() => window.caliposeReport.poses.map((pose) => String(pose.id)));
const settle = (page) => page.waitForFunction(() => !window.caliposeReport.moving());

/** What the canvas shows: a digest of its pixels, and how many colours there are. */
const picture = (page) =>
  page.evaluate(() => {
    const canvas = window.caliposeReport.render();
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
    copy.drawImage(canvas, 0, 0);
    const pixels = new Uint32Array(copy.getImageData(0, 0, canvas.width, canvas.height).data.buffer);
    let digest = 0;
    for (const pixel of pixels) digest = (Math.imul(digest, 31) + pixel) | 0;
    return { digest, colours: new Set(pixels).size };
  });

/** Does something and asserts that the canvas shows another picture (or the same). */
async function changesPicture(page, act, what, changed = true) {
  const before = (await picture(page)).digest;
  await act();
  await settle(page);
  (changed ? assert.notEqual : assert.equal)((await picture(page)).digest, before, `${what}: the canvas's picture`);
}

/** Where the camera of a pose is in the window, of one that is not chosen and whose camera is farthest from the others. */
async function cameraInView(page) {
  await page.locator("#view3d [role=application]").scrollIntoViewIfNeeded();
  const spots = await page.evaluate(() => window.caliposeReport.poses.map(({ id }) => ({ id, ...window.caliposeReport.project(id) })));
  const now = await chosen(page);
  const alone = (spot) => Math.min(...spots.filter((other) => other !== spot).map((other) => Math.hypot(other.x - spot.x, other.y - spot.y)));
  return spots.filter(({ id }) => String(id) !== now).reduce((best, each) => (alone(each) > alone(best) ? each : best));
}

/** The pose, its panel alone and its row are shown as chosen. */
async function assertChosen(page, id, by) {
  assert.equal(await chosen(page), id, `${by}: the chosen pose`);
  assert.match(await status(page), new RegExp(`configuration ${id}\\b`), `${by}: the status`);
  const shown = await page.locator("[data-pose-panel]:visible").evaluateAll((all) => all.map((panel) => panel.dataset.posePanel));
  assert.deepEqual([...new Set(shown)], [id], `${by}: the panels shown`);
  const rows = await page.locator("tr[data-pose].chosen").evaluateAll((all) => all.map((row) => row.dataset.pose));
  assert.deepEqual([...new Set(rows)], [id], `${by}: the rows marked`);
}

const time = (page) => page.evaluate(() => window.caliposeReport.time());

/** The tour's cursor is where the time is. */
async function assertCursor(page) {
  const [left, expected] = await page.evaluate(() => {
    const { time, timeline } = window.caliposeReport;
    return [parseFloat(document.querySelector("#tour .cursor").style.left), (100 * time()) / timeline.end_s];
  });
  assert(Math.abs(left - expected) < 1e-3, `the cursor at ${left} %, the time at ${expected} %`);
}

/** The arm is where the tour is at its time, and so is the cursor. */
async function assertArm(page) {
  await settle(page);
  const [shown, expected] = await page.evaluate(() => {
    const { configuration, configurationAt, time } = window.caliposeReport;
    return [configuration(), configurationAt(time())];
  });
  shown.forEach((value, j) => assert(Math.abs(value - expected[j]) < 1e-9, `joint ${j + 1}: ${value}, ${expected[j]}`));
  await assertCursor(page);
}

// The page in a wide window

await check(`the first frame of the 3-D view comes within ${FIRST_FRAME_MS} ms`, async () => {
  const times = [];
  while (times.length < LOADS && !(times.at(-1) <= FIRST_FRAME_MS)) {
    const page = await openView();
    times.push(page.firstFrame);
    await close(page);
  }
  const told = `${times.map((time) => time.toFixed(0)).join(", ")} ms`;
  assert(times.at(-1) <= FIRST_FRAME_MS, told);
  return told;
});

const page = await openView();
const all = await ids(page);
const at = (index) => all[(index + all.length) % all.length];
await shoot(page, "light");

await check("the canvas is not empty", async () => {
  const { colours } = await picture(page);
  assert(colours > 100, `${colours} colours`);
  return `${colours} colours`;
});

await check("the page's kinematics put the camera where the document says", async () => {
  const worst = await page.evaluate(() => {
    const errors = window.caliposeReport.poses.map(({ joints, camera }) => {
      const { position_m, quaternion_xyzw } = window.caliposeReport.cameraAt(joints);
      const sign = Math.sign(quaternion_xyzw.reduce((sum, value, i) => sum + value * camera.quaternion_xyzw[i], 0));
      const away = [...position_m.map((value, i) => value - camera.position_m[i]),
        ...quaternion_xyzw.map((value, i) => sign * value - camera.quaternion_xyzw[i])];
      return Math.max(...away.map(Math.abs));
    });
    return errors.includes(NaN) ? NaN : Math.max(...errors);
  });
  assert(worst <= 1e-9, `largest difference ${worst}`);
  return `largest difference ${worst.toExponential(1)}`;
});

await check("buttons and the list step from pose to pose", async () => {
  assert.equal(await chosen(page), at(0));
  await changesPicture(page, () => page.getByRole("button", { name: /^next pose/i }).click(), "next");
  await assertChosen(page, at(1), "next");
  for (let i = 0; i < 2; i++) await page.getByRole("button", { name: /^previous pose/i }).click();
  await assertChosen(page, at(-1), "previous, around the start");
  await changesPicture(page, () => page.getByLabel("Pose", { exact: true }).selectOption(at(2)), "list");
  await assertChosen(page, at(2), "list");
});

await check("a row of the table chooses its pose, by a click and by its button", async () => {
  const row = page.locator(`tr[data-pose="${at(3)}"]`).first();
  await row.locator("td").last().click();
  await assertChosen(page, at(3), "row");
  const choose = page.locator(`tr[data-pose="${at(4)}"] .choose`).first();
  await choose.focus();
  await page.keyboard.press("Enter");
  await assertChosen(page, at(4), "button");
  assert.equal(await choose.getAttribute("aria-pressed"), "true");
});

await check("a plot's mark chooses its pose", async () => {
  const plots = await page.locator(".plot:has([data-pose])").count();
  assert(plots > 0, "no plot has marks of poses");
  for (let i = 0; i < plots; i++) {
    const mark = page.locator(".plot:has([data-pose])").nth(i).locator(`[data-pose="${at(5 + i)}"]`).first();
    // To the mark itself, whatever lies above it.
    await mark.dispatchEvent("click");
    await assertChosen(page, at(5 + i), `plot ${i + 1}`);
    assert.match((await mark.getAttribute("class")) ?? "", /\bchosen\b/);
  }
  return `${plots} plots`;
});

await check("a click on a camera in the 3-D view chooses its pose", async () => {
  const spot = await cameraInView(page);
  await page.mouse.click(spot.x, spot.y);
  await assertChosen(page, String(spot.id), "camera");
});

await check("the view turns, shifts and zooms by mouse, wheel and keys, and H brings the whole scene back", async () => {
  const canvas = page.locator("#view3d [role=application]");
  await canvas.focus();
  await page.keyboard.press("h");
  const whole = (await picture(page)).digest;
  const box = await canvas.boundingBox();
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  await changesPicture(page, async () => {
    await page.mouse.move(...middle);
    await page.mouse.down();
    await page.mouse.move(middle[0] + 60, middle[1] + 20, { steps: 4 });
    await page.mouse.up();
  }, "dragging");
  await changesPicture(page, async () => {
    await page.mouse.wheel(0, -240);
    await page.waitForTimeout(100);
  }, "wheel");
  for (const key of ["ArrowLeft", "ArrowUp", "Shift+ArrowRight", "+", "-"]) {
    await changesPicture(page, () => page.keyboard.press(key), key);
  }
  // A camera that the pointer is near stands out.
  await page.mouse.move(0, 0);
  await page.keyboard.press("h");
  assert.equal((await picture(page)).digest, whole, "H: the canvas's picture");
});

await check("the wheel scrolls the page until the view has the focus", async () => {
  await page.locator("#view3d [role=application]").evaluate((canvas) => canvas.blur());
  await page.evaluate(() => scrollTo(0, 0));
  await page.locator("#view3d [role=application]").hover();
  await changesPicture(page, async () => {
    await page.mouse.wheel(0, 120);
    await page.waitForFunction(() => scrollY > 0);
  }, "wheel without focus", false);
});

await check("keys in the view step and play", async () => {
  await page.getByLabel("Speed of the playing").selectOption("8");
  await page.locator("#view3d [role=application]").focus();
  // Playing ends at the last pose, whereas keys go on to the first.
  if (all.indexOf(await chosen(page)) === all.length - 1) await page.keyboard.press("n");
  const before = all.indexOf(await chosen(page));
  await page.keyboard.press("n");
  await assertChosen(page, at(before + 1), "N");
  await page.keyboard.press("p");
  await assertChosen(page, at(before), "P");
  await page.keyboard.press(" ");
  await page.waitForFunction((id) => window.caliposeReport.chosen() === id, at(before + 1), { timeout: 30_000 });
  await page.keyboard.press(" ");
  const stopped = await time(page);
  await page.waitForTimeout(300);
  assert.equal(await time(page), stopped, "after a second space");
  await page.keyboard.press("n");
});

// The tour in time

await check("the joints are at each pose when its pictures are taken", async () => {
  const worst = await page.evaluate(() => {
    const { poses, timeline, configurationAt } = window.caliposeReport;
    const off = timeline.pictures.flatMap(({ id, start_s, seconds }) => {
      const { joints } = poses.find((pose) => pose.id === id);
      return [start_s, start_s + seconds].flatMap((time) => configurationAt(time).map((value, j) => Math.abs(value - joints[j])));
    });
    return off.includes(NaN) ? NaN : Math.max(...off);
  });
  assert(worst < 1e-9, `largest difference ${worst}`);
  return `largest difference ${worst.toExponential(1)}`;
});

await check("a pose that is chosen is where the tour's cursor goes", async () => {
  for (const index of [3, 0]) {
    await page.getByLabel("Pose", { exact: true }).selectOption(at(index));
    const arrival = await page.evaluate((i) => window.caliposeReport.timeline.pictures[i].start_s, index);
    assert.equal(await time(page), arrival);
    await assertCursor(page);
    assert.match(await page.locator(".readout").textContent(), new RegExp(`at pose ${index + 1}(?!\\d)`));
  }
});

await check("a click on the tour's drawing and dragging set its time, and the arm is where the tour is then", async () => {
  const track = page.locator("#tour .track");
  await track.scrollIntoViewIfNeeded();
  const box = await track.boundingBox();
  const end = await page.evaluate(() => window.caliposeReport.timeline.end_s);
  const y = box.y + box.height / 2;
  const aim = (share) => box.x + share * box.width;
  await changesPicture(page, () => page.mouse.click(aim(0.37), y), "a click");
  assert(Math.abs((await time(page)) - 0.37 * end) < (end / box.width) * 1.5, `at ${await time(page)} of ${end} s`);
  await assertArm(page);
  await changesPicture(page, async () => {
    await page.mouse.down();
    await page.mouse.move(aim(0.6), y + 40, { steps: 5 });
    await page.mouse.up();
  }, "dragging");
  assert(Math.abs((await time(page)) - 0.6 * end) < (end / box.width) * 1.5, `at ${await time(page)} of ${end} s`);
  await assertArm(page);
  const there = await time(page);
  await page.mouse.move(aim(0.2), y);
  assert.equal(await time(page), there, "after the button is let go");
  // In the middle of every picture its pose is chosen.
  for (const { id, start_s, seconds } of await page.evaluate(() => window.caliposeReport.timeline.pictures.slice(0, 4))) {
    if (seconds * (box.width / end) < 3) continue;
    await page.mouse.click(aim((start_s + seconds / 2) / end), y);
    await assertChosen(page, String(id), "a click on its pictures");
    await assertArm(page);
  }
});

await check("keys move the tour's cursor", async () => {
  await page.locator("#tour .track").focus();
  const end = await page.evaluate(() => window.caliposeReport.timeline.end_s);
  for (const [key, change] of [["Home", null], ["ArrowRight", 0.1], ["Shift+ArrowRight", 1], ["ArrowLeft", -0.1], ["Shift+ArrowLeft", -1]]) {
    const before = await time(page);
    await page.keyboard.press(key);
    const expected = change === null ? 0 : Math.min(Math.max(before + change, 0), end);
    assert(Math.abs((await time(page)) - expected) < 1e-9, `${key}: ${await time(page)}`);
    await assertArm(page);
  }
  await page.keyboard.press("End");
  assert.equal(await time(page), end, "End");
  await page.keyboard.press("PageDown");
  await page.keyboard.press("PageUp");
  const slider = await page.locator("#tour .track").evaluate((node) => [node.getAttribute("aria-valuenow"), node.getAttribute("aria-valuetext")]);
  assert.equal(slider[0], (await time(page)).toFixed(1), "aria-valuenow");
  assert.match(slider[1], /pose \d+/, "aria-valuetext");
});

await check("buttons show where the tour comes closest to anything", async () => {
  const buttons = page.locator("#tour [data-time]");
  const curves = await page.evaluate(() => {
    const { clearance, changing_clearance, tip_over_margin, measured_s } = window.caliposeReport.timeline;
    // Links that are nearest of all are shown once.
    const other = changing_clearance?.least === clearance?.least ? null : changing_clearance;
    return [clearance, other, tip_over_margin].filter(Boolean).map(({ measured_m, least, nearest, pairs }) => ({
      time: measured_s[least], isLeast: measured_m.every((value) => value >= measured_m[least]),
      shown: `${(1000 * measured_m[least]).toFixed(1)} mm${pairs ? `, ${pairs[nearest[least]].join(" – ")}` : ""}`,
    }));
  });
  assert((await buttons.count()) >= curves.length, "a button for each");
  for (const [i, curve] of curves.entries()) {
    assert(curve.isLeast, "the least that was measured");
    await buttons.nth(i).click();
    assert.equal(await time(page), curve.time);
    await assertArm(page);
    assert((await page.locator(".readout").textContent()).includes(curve.shown), `the readout says ${curve.shown}`);
  }
  return curves.length ? `${curves.length} curves` : "nothing is tested of this plan";
});

await check("playing moves the cursor and the arm as fast as is asked, chooses poses, and ends at the end", async () => {
  await page.locator("#tour .track").focus();
  await page.keyboard.press("Home");
  const end = await page.evaluate(() => window.caliposeReport.timeline.end_s);
  const play = page.getByRole("button", { name: "Play", exact: true });
  for (const speed of ["1", "8"]) {
    await page.getByLabel("Speed of the playing").selectOption(speed);
    await play.click();
    const run = await page.evaluate(() => new Promise((done) => {
      const seen = [];
      const look = (now) => {
        const { time, configuration, configurationAt } = window.caliposeReport;
        const off = configurationAt(time()).map((value, j) => Math.abs(value - configuration()[j]));
        const cursor = document.querySelector("#tour .cursor").style.left;
        seen.push({ now, time: time(), off: Math.max(...off), cursor: parseFloat(cursor) });
        if (seen.length < 4 || now - seen[0].now < 400) requestAnimationFrame(look);
        else done(seen);
      };
      requestAnimationFrame(look);
    }));
    await page.getByRole("button", { name: "Pause", exact: true }).click();
    assert(run.every(({ off }) => off === 0), "the arm is where the tour is");
    assert(run.every(({ time, cursor }) => Math.abs(cursor - (100 * time) / end) < 1e-3), "so is the cursor");
    const [first, last] = [run[0], run.at(-1)];
    const ratio = (last.time - first.time) / ((last.now - first.now) / 1000);
    assert(Math.abs(ratio - Number(speed)) < 0.05 * Number(speed), `×${speed}: ${ratio}`);
  }
  // The poses on the way to the end, one after the other; slowly, so that a busy machine draws each.
  await page.getByLabel("Speed of the playing").selectOption("1");
  const expected = await page.evaluate(() => {
    const now = window.caliposeReport.time();
    return window.caliposeReport.timeline.pictures.filter(({ start_s, seconds }) => start_s + seconds > now).slice(-3).map(({ id }) => String(id));
  });
  const from = await page.evaluate((id) => window.caliposeReport.timeline.pictures.find((picture) => String(picture.id) === id).start_s, expected[0]);
  const share = (from - 0.05) / end;
  const box = await page.locator("#tour .track").boundingBox();
  await page.mouse.click(box.x + Math.max(share, 0) * box.width, box.y + box.height / 2);
  const seen = page.evaluate(() => new Promise((done) => {
    const ids = [];
    let begun = false;
    const look = () => {
      const { chosen, playing } = window.caliposeReport;
      begun ||= playing();
      if (begun && ids.at(-1) !== chosen()) ids.push(chosen());
      if (playing() || !begun) requestAnimationFrame(look);
      else done(ids);
    };
    look();
  }));
  await play.click();
  assert.deepEqual((await seen).filter((id) => expected.includes(id)), expected, "poses chosen");
  assert.equal(await time(page), end, "in the end");
  await assertArm(page);
});

await check("a choice by the reader ends the playing", async () => {
  await page.getByLabel("Speed of the playing").selectOption("1");
  await page.getByRole("button", { name: "Play", exact: true }).click();
  await page.getByRole("button", { name: /^next pose/i }).click();
  assert.equal(await page.evaluate(() => window.caliposeReport.playing()), false);
  assert.equal(await page.getByRole("button", { name: "Play", exact: true }).getAttribute("aria-pressed"), "false");
});

await check("toggles change the picture", async () => {
  const boxes = page.locator("#view3d .toggles input");
  const count = await boxes.count();
  assert(count >= 1, "no toggles");
  for (let i = 0; i < count; i++) {
    await changesPicture(page, () => boxes.nth(i).uncheck(), `toggle ${i + 1} off`);
    await boxes.nth(i).check();
  }
  return `${count} toggles`;
});

await check("pointing at a view's mark shows it in the 3-D view", async () => {
  const marks = page.locator(".plot [data-view]");
  if ((await marks.count()) === 0) return "no marks of views in this page";
  const known = await page.evaluate(() => {
    const { ids } = JSON.parse(document.getElementById("scene-data").textContent).views;
    const has = new Set(ids.map(String));
    return [...document.querySelectorAll(".plot [data-view]")].map(({ dataset }) => dataset.view).find((id) => has.has(id));
  });
  await changesPicture(page, () => page.locator(`.plot [data-view="${known}"]`).first().dispatchEvent("pointerover"), "pointing");
});

await check("tables sort by a column, both ways and back, and copy as they stand", async () => {
  const table = page.locator("table.sortable:has(tr[data-pose])").first();
  const numbers = (column) =>
    table.locator(`tbody tr td:nth-child(${column})`).evaluateAll((cells) => cells.map((cell) => Number(cell.dataset.value ?? cell.textContent)));
  const written = await table.locator("tbody tr").evaluateAll((rows) => rows.map((row) => row.dataset.pose));
  const now = () => table.locator("tbody tr").evaluateAll((rows) => rows.map((row) => row.dataset.pose));
  const columns = await table.locator("thead th").count();
  // The last column of plain numbers that are not in order already.
  let column = columns;
  while (column > 1 && (await numbers(column)).some((value, i, all) => Number.isNaN(value) || (i === 0 && isSorted(all)))) column--;
  assert(column > 1, "no column to sort by");
  const header = table.locator(`thead th:nth-child(${column})`);
  await header.getByRole("button").click();
  assert.equal(await header.getAttribute("aria-sort"), "ascending");
  assert(isSorted(await numbers(column)), `ascending: ${await numbers(column)}`);
  await header.getByRole("button").click();
  assert.equal(await header.getAttribute("aria-sort"), "descending");
  assert(isSorted((await numbers(column)).reverse()), `descending: ${await numbers(column)}`);
  const order = await now();

  const copy = () =>
    table.evaluate(async (node) => {
      const tools = (node.closest(".scroll") ?? node).previousElementSibling;
      tools.querySelector("button").click();
      const outcome = tools.querySelector(".outcome");
      for (let frame = 0; frame < 300 && !outcome.textContent; frame++) await new Promise(requestAnimationFrame);
      if (outcome.textContent !== "Copied") throw new Error(`"Copy" says: "${outcome.textContent}"`);
      outcome.textContent = "";
    });
  await copy();
  const text = await page.evaluate(() => navigator.clipboard.readText());
  const lines = text.trimEnd().split("\n").map((line) => line.split("\t"));
  assert.equal(lines.length, order.length + 1, "lines copied");
  assert(lines.every((line) => line.length === columns), "columns copied");
  // Without the clipboard's interface, as some browsers have it for files.
  await page.evaluate(() => {
    window.clipboardKept = navigator.clipboard;
    Object.defineProperty(navigator, "clipboard", { value: undefined, configurable: true });
    return window.clipboardKept.writeText("");
  });
  await copy();
  assert.equal(await page.evaluate(() => window.clipboardKept.readText()), text, "copied the old way");

  await header.getByRole("button").click();
  assert.deepEqual(await now(), written, "as written");
});

await check("nothing is complained of, nothing is asked of the network", async () => assert.deepEqual(page.complaints, []));
await close(page);

function isSorted(values) {
  return values.every((value, i) => i === 0 || values[i - 1] <= value);
}

// Motion

await check("a reader who prefers reduced motion sees the pose at once", async () => {
  const still = await openView({ reducedMotion: "reduce" });
  const shown = await still.evaluate((id) => {
    document.querySelector(`tr[data-pose="${id}"] .choose`).click();
    return window.caliposeReport.configuration();
  }, at(1));
  assert.deepEqual(shown, await still.evaluate(() => window.caliposeReport.poses[1].joints));
  await close(still);
});

await check("the arm moves to the pose for other readers, and arrives at it exactly", async () => {
  const moving = await openView({ reducedMotion: "no-preference" });
  const [from, to] = await moving.evaluate(() => window.caliposeReport.poses.slice(0, 2).map((pose) => pose.joints));
  const started = await moving.evaluate((id) => {
    document.querySelector(`tr[data-pose="${id}"] .choose`).click();
    return window.caliposeReport.configuration();
  }, at(1));
  assert.deepEqual(started, from, "at the click");
  await settle(moving);
  assert.deepEqual(await moving.evaluate(() => window.caliposeReport.configuration()), to, "in the end");
  assert.deepEqual(moving.complaints, []);
  await close(moving);
});

// Colours, paper, a phone, no JavaScript, no WebGL

for (const colorScheme of ["light", "dark"]) {
  await check(`axe finds nothing in the ${colorScheme} scheme`, async () => {
    const one = await openView({ colorScheme });
    if (colorScheme === "dark") await shoot(one, "dark");
    const wide = await assertAccessible(one, "wide");
    await one.setViewportSize(PHONE);
    await assertAccessible(one, "phone");
    await close(one);
    return wide;
  });
}

await check("the 3-D view follows a change of the colour scheme", async () => {
  const one = await openView({ colorScheme: "light" });
  await changesPicture(one, async () => {
    await one.emulateMedia({ colorScheme: "dark" });
    // Browsers tell of the change with the next frame.
    await one.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  }, "dark");
  await close(one);
});

await check("in print there are all plots and all panels, and no controls", async () => {
  const one = await openView();
  await one.emulateMedia({ media: "print" });
  await one.evaluate(() => dispatchEvent(new Event("beforeprint")));
  const colours = await one.locator("#view3d .print-picture").evaluate((copy) => {
    const { data } = copy.getContext("2d").getImageData(0, 0, copy.width, copy.height);
    return new Set(new Uint32Array(data.buffer)).size;
  });
  assert(colours > 100, `the printed picture of the 3-D view has ${colours} colours`);
  await assertAllVisible(one, [".print-picture", ".timeline .wide svg", ".plot svg", "[data-pose-panel]", "table"]);
  const controls = ["#view3d [role=application]", "#view3d button", "#view3d select", "#view3d input", ".track", ".readout", ".table-tools", ".choose"];
  for (const part of controls) {
    assert.equal(await one.locator(`${part}:visible`).count(), 0, part);
  }
  await one.evaluate(() => dispatchEvent(new Event("afterprint")));
  await print(one, "print");
  await close(one);
});

await check("a phone's window, 360 px wide, shows everything; wide tables scroll in their own regions", async () => {
  const one = await openView({ viewport: PHONE, hasTouch: true, isMobile: true });
  await shoot(one, "phone");
  await assertNothingCutOff(one);
  await assertAllVisible(one, [".timeline .narrow svg", ".readout dd"]);
  assert.equal(await one.locator(".timeline .wide svg:visible").count(), 0, "the wide drawing");
  const { colours } = await picture(one);
  assert(colours > 100, `${colours} colours`);
  await close(one);
});

await check("a finger drags the tour's cursor", async () => {
  const one = await openView({ viewport: PHONE, hasTouch: true, isMobile: true });
  await one.locator(".track").scrollIntoViewIfNeeded();
  const box = await one.locator(".track").boundingBox();
  const y = box.y + Math.min(box.height / 2, 200);
  const screen = await one.context().newCDPSession(one);
  const touch = (type, ...touchPoints) => screen.send("Input.dispatchTouchEvent", { type, touchPoints });
  await changesPicture(one, async () => {
    await touch("touchStart", { x: box.x + 0.3 * box.width, y });
    for (const share of [0.4, 0.5, 0.6, 0.7]) await touch("touchMove", { x: box.x + share * box.width, y });
    await touch("touchEnd");
  }, "dragging");
  const share = await one.evaluate(() => window.caliposeReport.time() / window.caliposeReport.timeline.end_s);
  assert(Math.abs(share - 0.7) < 0.02, `at ${share} of the tour`);
  await assertArm(one);
  await close(one);
});

await check("fingers choose a pose, turn the view and zoom it", async () => {
  const one = await openView({ viewport: PHONE, hasTouch: true, isMobile: true });
  const spot = await cameraInView(one);
  await one.touchscreen.tap(spot.x, spot.y);
  await assertChosen(one, String(spot.id), "tap");
  const box = await one.locator("#view3d [role=application]").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const screen = await one.context().newCDPSession(one);
  const touch = (type, ...touchPoints) => screen.send("Input.dispatchTouchEvent", { type, touchPoints });
  await changesPicture(one, async () => {
    await touch("touchStart", { x, y });
    for (const dx of [20, 40, 60]) await touch("touchMove", { x: x + dx, y });
    await touch("touchEnd");
  }, "one finger");
  const size = () => one.evaluate(() => {
    const spots = window.caliposeReport.poses.map(({ id }) => window.caliposeReport.project(id));
    return Math.max(...spots.map((spot) => spot.x)) - Math.min(...spots.map((spot) => spot.x));
  });
  const before = await size();
  const pair = (away) => [{ x: x - away, y, id: 0 }, { x: x + away, y, id: 1 }];
  await touch("touchStart", ...pair(30));
  for (const away of [35, 40, 45]) await touch("touchMove", ...pair(away));
  await touch("touchEnd");
  const factor = (await size()) / before;
  assert(factor > 1.3 && factor < 1.9, `fingers 1.5 times as far apart give a picture ${factor} times as large`);
  await close(one);
  return `fingers 1.5 times as far apart: ${factor.toFixed(2)} times as large`;
});

await check("without JavaScript there are the tables, the plots and all panels", async () => {
  const one = await open(browser, address, { javaScriptEnabled: false });
  await shoot(one, "without-javascript");
  await assertAllVisible(one, ["table.sortable", ".timeline .wide svg", ".plot svg", "[data-pose-panel]"]);
  for (const part of ["#view3d", ".choose", ".track"]) assert.equal(await one.locator(`${part}:visible`).count(), 0, part);
  assert.deepEqual(one.complaints, []);
  await close(one);
});

await browser.close();

await check("without WebGL the page says so, and the rest works", async () => {
  const plain = await launch("--disable-3d-apis");
  try {
    const one = await open(plain, address);
    await one.locator("#view3d .refusal").waitFor({ timeout: 10_000 });
    assert.match(await one.locator("#view3d .refusal").textContent(), /WebGL/);
    await one.getByRole("button", { name: /^next pose/i }).click();
    const shown = await one.locator("[data-pose-panel]:visible").evaluateAll((panels) => panels.map((panel) => panel.dataset.posePanel));
    assert.deepEqual([...new Set(shown)], [at(1)]);
    assert.deepEqual(one.complaints.filter((told) => told.startsWith("error") || told.startsWith("request")), []);
  } finally {
    await plain.close();
  }
});

console.log(failures ? `${failures} claims do not hold` : "all claims hold");
process.exitCode = failures ? 1 : 0;
