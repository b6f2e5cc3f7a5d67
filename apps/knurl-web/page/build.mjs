// Writes the bundle into the folder that it is given: index.html, app.js, app.css, LICENSES.txt. The same sources and packages
// give the same bytes: no time, path or random name goes in.
import { build } from "esbuild";
import { cpSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const page = dirname(fileURLToPath(import.meta.url));
const out = resolve(process.argv[2] ?? join(page, "../bundle"));
mkdirSync(out, { recursive: true });

const result = await build({
  absWorkingDir: page,
  entryPoints: { app: "src/main.ts" },
  outdir: out,
  bundle: true,
  minify: true,
  format: "iife",
  target: ["es2022"],
  charset: "utf8",
  legalComments: "none",
  metafile: true,
  logLevel: "warning",
});
await build({
  absWorkingDir: page,
  entryPoints: { app: "style.css" },
  outdir: out,
  bundle: true,
  minify: true,
  charset: "utf8",
  legalComments: "none",
  logLevel: "warning",
});
cpSync(join(page, "index.html"), join(out, "index.html"));

// The licences of exactly what was bundled.
const packages = new Set(["uplot"]);
for (const [name, entry] of Object.entries(result.metafile.outputs["../bundle/app.js"]?.inputs ??
  Object.values(result.metafile.outputs)[0].inputs)) {
  if (entry.bytesInOutput === 0) continue;
  const found = /(?:^|\/)node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(name);
  if (found) packages.add(found[1]);
}
// Texts of packages whose archive has none: from the repository of the package, at the tag of its version.
const elsewhere = JSON.parse(readFileSync(join(page, "licences.json"), "utf8"));
let text = "app.js and app.css hold code of these packages from the npm registry. Knurl's own is under the Boost Software License 1.0.\n";
for (const name of [...packages].sort()) {
  const folder = join(page, "node_modules", name);
  const about = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  let licence = elsewhere[name];
  for (const file of ["LICENSE", "LICENSE.md", "LICENSE.txt", "LICENCE"]) {
    try {
      licence = readFileSync(join(folder, file), "utf8");
      break;
    } catch {
      // the next one
    }
  }
  if (!licence) throw new Error(`${name}: its package has no licence text; put it into licences.json`);
  text += `\n${"=".repeat(80)}\n${name} ${about.version} (${about.license})\n${"=".repeat(80)}\n\n${licence.trim()}\n`;
}
writeFileSync(join(out, "LICENSES.txt"), text);
