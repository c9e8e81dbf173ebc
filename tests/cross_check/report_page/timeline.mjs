// Holds the page's own reckoning of where the joints are to the golden tours in time, as Rust's is held: node timeline.mjs
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { check, failures } from "./browser.mjs";
import { Timeline } from "../../../src/report/page/web/src/timeline.js";

const golden = JSON.parse(await readFile(new URL("../../golden/timeline.json", import.meta.url), "utf8"));

await check("the page's joint values at a time are the golden ones", () => {
  let [worst, times] = [0, 0];
  for (const { timeline, at } of golden) {
    const own = new Timeline(timeline);
    for (const { time_s, joints } of at) {
      const found = own.configurationAt(time_s);
      assert.equal(found.length, joints.length);
      found.forEach((value, j) => (worst = Math.max(worst, Math.abs(value - joints[j]))));
      times += 1;
    }
  }
  assert(worst < 1e-9, `largest difference ${worst}`);
  return `largest difference ${worst.toExponential(1)} at ${times} times of ${golden.length} tours`;
});

await check("margins between two samples are on the line, the links those of the nearer sample", () => {
  const [{ timeline: data }] = golden;
  const measured = { ...data, measured_s: [1, 2, 4], clearance: { measured_m: [0.1, 0.3, 0.2], nearest: [0, 1, 0], pairs: [["a", "b"], ["a", "c"]] } };
  const own = new Timeline(measured);
  for (const [time, value, links] of [[0, 0.1, "a b"], [1.25, 0.15, "a b"], [1.75, 0.25, "a c"], [3, 0.25, "a b"], [9, 0.2, "a b"]]) {
    const found = own.marginAt(own.clearance, time);
    assert(Math.abs(found.value - value) < 1e-12, `${time}: ${found.value}`);
    assert.equal(found.links.join(" "), links, String(time));
  }
});

process.exitCode = failures ? 1 : 0;
