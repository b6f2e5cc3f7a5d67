// So many pages on one knurl-web: how old a frame is when it comes, and how much of a CPU knurl-web takes.
//     node tests/web/bench_pages.mjs URL-WITH-TOKEN PID-OF-KNURL-WEB PAGES SECONDS
// Both on this host: a frame's time is CLOCK_MONOTONIC, as ours is. It needs the packages that scripts/page fetches.
import { readFileSync } from "node:fs";
import { get } from "node:http";
import { createRequire } from "node:module";
import { cpus } from "node:os";
import { resolve } from "node:path";
import { page } from "./browser.mjs";

const { WebSocket } = createRequire(resolve(page, "package.json"))("ws");
const [url, pid, pages, seconds] = process.argv.slice(2);
if (!seconds) {
  console.error("bench_pages.mjs: give URL, PID, PAGES and SECONDS");
  process.exit(2);
}
const base = new URL(url);
const cookie = await new Promise((done) => get(url, (answer) => done((answer.headers["set-cookie"] ?? [""])[0].split(";")[0])));
const cpu = () => {
  const words = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ")[1].split(" ");
  return (Number(words[11]) + Number(words[12])) / 100;
};
const ages = [];
for (let k = 0; k < Number(pages); k++) {
  const socket = new WebSocket(`ws://${base.host}/live`, "knurl.live.v1", { headers: { Cookie: cookie, Origin: base.origin } });
  socket.on("error", (error) => console.error(error.message));
  socket.on("message", (data, binary) => {
    if (binary) return;
    const text = data.toString();
    if (text.startsWith('{"op":"frame"')) ages.push(Number(process.hrtime.bigint()) / 1e6 - JSON.parse(text).t * 1e3);
  });
}
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
await wait(2000);
ages.length = 0;
const before = cpu();
const began = process.hrtime.bigint();
await wait(Number(seconds) * 1000);
const took = Number(process.hrtime.bigint() - began) / 1e9;
ages.sort((a, b) => a - b);
const load = readFileSync("/proc/loadavg", "utf8").split(" ")[0];
console.log(`${cpus().length} x ${cpus()[0].model}, load ${load}, ${pages} pages, n = ${ages.length}`);
console.log(`  ${(ages.length / took / Number(pages)).toFixed(1)} frames a second and page`);
console.log(`  age of a frame: p50 ${ages[ages.length >> 1]?.toFixed(2)} ms, p99 ${ages[Math.floor(ages.length * 0.99)]?.toFixed(2)} ms`);
console.log(`  knurl-web takes ${(((cpu() - before) / took) * 100).toFixed(1)} % of a CPU`);
process.exit(0);
