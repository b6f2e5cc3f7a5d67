// Runs the tests of the page of knurl-web: `node tests/web/run.mjs [unit|page]`. Exit status 77: skipped, one line says what is
// missing.
import { spawnSync } from "node:child_process";
import { dirname, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { missing } from "./browser.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const wanted = process.argv.slice(2);
if (wanted.some((name) => !["unit", "page"].includes(name))) {
  console.error(`run.mjs: ${wanted.join(" ")}: tests are unit and page`);
  process.exit(2);
}
const names = wanted.length ? wanted : ["unit", "page"];
const lacks = missing(names.includes("page"));
if (lacks) {
  console.log(`skipped: ${lacks}`);
  process.exit(77);
}
const { status } = spawnSync(process.execPath, ["--test", "--test-reporter=spec", "--test-concurrency=1", ...names.map((name) => resolve(here, `${name}.test.mjs`))], { stdio: "inherit" });
process.exit(status ?? 1);
