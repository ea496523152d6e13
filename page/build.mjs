// Bundles the page into src/mckibben/page/assets, which ships with the Python package: `make page`.
// The digest in the banner is that of all sources; tests/test_page_bundle.py computes it anew.
import { createHash } from "node:crypto";
import { copyFileSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const out = join(here, "..", "src", "mckibben", "page", "assets");
const used = ["three", "uplot"];

function sources() {
  const listed = ["src", "static"].flatMap((folder) =>
    readdirSync(join(here, folder)).map((name) => `${folder}/${name}`));
  return [...listed, "build.mjs", "package.json", "package-lock.json"].sort();
}

function digest() {
  const hash = createHash("sha256");
  for (const name of sources()) {
    const content = readFileSync(join(here, name));
    hash.update(`${name}\0${content.length}\0`).update(content);
  }
  return hash.digest("hex");
}

const about = Object.fromEntries(used.map((name) => {
  const { version, license } = JSON.parse(readFileSync(join(here, "node_modules", name, "package.json"), "utf8"));
  return [name, { version, license }];
}));
const named = used.map((name) => `${name} ${about[name].version} (${about[name].license})`).join(", ");
const banner = `/*! mckibben, BSD-3-Clause. With ${named}: see NOTICE.txt. Sources sha256 ${digest()} */`;

mkdirSync(out, { recursive: true });
await build({
  absWorkingDir: here,
  entryPoints: { page: "src/main.js" },
  outdir: out,
  bundle: true,
  minify: true,
  format: "iife",
  target: ["es2022"],
  charset: "utf8",
  legalComments: "none",
  banner: { js: banner, css: banner },
  logLevel: "warning",
});
for (const name of readdirSync(join(here, "static"))) copyFileSync(join(here, "static", name), join(out, name));
// The accessibility checker of the tests stays here; it does not ship.
copyFileSync(join(here, "node_modules", "axe-core", "axe.min.js"), join(here, "axe.min.js"));
const notices = used.map((name) => {
  const text = readFileSync(join(here, "node_modules", name, "LICENSE"), "utf8").trim();
  return `${name} ${about[name].version}\n${"-".repeat(40)}\n${text}\n`;
});
writeFileSync(join(out, "NOTICE.txt"),
  `page.js and page.css contain these libraries, each under its own licence:\n\n${notices.join("\n")}`);
