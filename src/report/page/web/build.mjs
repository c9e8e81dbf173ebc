// Bundles src/main.js with what it uses of three.js into dist/report.js: `npm ci && node build.mjs`.
// The same sources and lock file give the same bytes; `.ci/report_page` holds the committed bundle to that.
import { readFile } from "node:fs/promises";
import { build } from "esbuild";

const licence = await readFile(new URL("node_modules/three/LICENSE", import.meta.url), "utf8");

await build({
  absWorkingDir: import.meta.dirname,
  entryPoints: ["src/main.js"],
  outfile: "dist/report.js",
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2020",
  charset: "ascii",
  // The page carries the bundle, so three.js's licence travels inside.
  banner: { js: `/*! This script contains three.js, https://threejs.org\n\n${licence.trim()}\n*/` },
  legalComments: "inline",
  logLevel: "info",
});
