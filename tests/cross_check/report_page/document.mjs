// Opens pages of other documents than plans in Chromium, and holds them to what every page must be: node document.mjs PAGE.html…
import assert from "node:assert/strict";
import { basename, dirname, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { PHONE, assertAccessible, assertAllVisible, assertNothingCutOff, check, close, failures, launch, open, print, shoot } from "./browser.mjs";

const browser = await launch();
for (const file of process.argv.slice(2)) {
  const address = pathToFileURL(resolve(file)).href;
  // The page of a study or a design is called report.html, in a folder with a name.
  const name = basename(file) === "report.html" ? basename(dirname(resolve(file))) : basename(file, ".html");
  const parts = ["h1", ".verdict", ".next", "table", ".plot svg"];

  for (const colorScheme of ["light", "dark"]) {
    await check(`${name}: axe finds nothing in the ${colorScheme} scheme, nothing is complained of or asked of the network`, async () => {
      const page = await open(browser, address, { colorScheme });
      await shoot(page, `${name}-${colorScheme}`);
      const wide = await assertAccessible(page, "wide");
      await page.setViewportSize(PHONE);
      await assertAccessible(page, "phone");
      assert.deepEqual(page.complaints, []);
      await close(page);
      return wide;
    });
  }

  await check(`${name}: a phone's window, 360 px wide, shows everything`, async () => {
    const page = await open(browser, address, { viewport: PHONE, hasTouch: true, isMobile: true });
    await shoot(page, `${name}-phone`);
    await assertNothingCutOff(page);
    await assertAllVisible(page, parts);
    await close(page);
  });

  await check(`${name}: in print there is everything, and no controls`, async () => {
    const page = await open(browser, address);
    await page.emulateMedia({ media: "print" });
    await assertAllVisible(page, parts);
    assert.equal(await page.locator(".table-tools:visible").count(), 0, "tools of tables");
    await print(page, name);
    await close(page);
  });

  await check(`${name}: tables sort, and copy as they stand`, async () => {
    const page = await open(browser, address);
    const table = page.locator("table.sortable").first();
    const header = table.locator("thead th").last();
    await header.getByRole("button").click();
    assert.equal(await header.getAttribute("aria-sort"), "ascending");
    await page.getByRole("button", { name: /^copy/i }).first().click();
    await page.locator(".outcome", { hasText: "Copied" }).first().waitFor({ timeout: 5000 });
    const rows = await table.locator("tr").count();
    const copied = await page.evaluate(() => navigator.clipboard.readText());
    assert.equal(copied.trimEnd().split("\n").length, rows, "lines copied");
    assert.deepEqual(page.complaints, []);
    await close(page);
  });

  await check(`${name}: without JavaScript there is everything`, async () => {
    const page = await open(browser, address, { javaScriptEnabled: false });
    await assertAllVisible(page, parts);
    await close(page);
  });
}
await browser.close();

console.log(failures ? `${failures} claims do not hold` : "all claims hold");
process.exitCode = failures ? 1 : 0;
