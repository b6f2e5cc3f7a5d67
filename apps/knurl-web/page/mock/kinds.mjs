// The table of fields as the server sends it, from docs/reference/representations.md (which the code's own tables print).
import { readFileSync } from "node:fs";

function number(text) {
  const plain = text.trim();
  return plain === "infinity" ? "inf" : plain === "π/2" ? Math.PI / 2 : Number(plain);
}

function field([key, unit, range, fallback, meaning]) {
  const name = key.replaceAll("`", "");
  const plain = (text) => text.replaceAll("`", "").trim();
  if (range.includes("`"))
    return { name, type: "choice", unit: "", meaning, minimum: 0, maximum: 0, default: plain(fallback), choices: [...range.matchAll(/`(\w+)`/g)].map((m) => m[1]) };
  const numbers = (text) => text.trim().split(/\s+/).map(Number);
  if (range.startsWith("w x y z")) return { name, type: "quaternion", unit, meaning, minimum: -1e9, maximum: 1e9, default: numbers(fallback), count: 4 };
  const bound = /±\s*(\S+)/.exec(range);
  const span = /(\S+) … ([^,\s]+)/.exec(range);
  const minimum = bound ? -number(bound[1]) : span ? number(span[1]) : -1e9;
  const maximum = bound ? number(bound[1]) : span ? number(span[2]) : 1e9;
  if (/points/.test(range)) return { name, type: "points", unit, meaning, minimum, maximum, default: fallback.split(";").map(numbers), count: 8 };
  if (/entries/.test(range) || name === "jacobian") {
    const count = /6 x 6|6 × 6|36/.test(range + fallback + meaning) ? 6 : 3;
    return { name, type: "matrix", unit, meaning, minimum, maximum, default: Array(count * count).fill(0), count };
  }
  if (/components|length/.test(range)) return { name, type: "vector", unit, meaning, minimum, maximum, default: numbers(fallback), count: 3 };
  const integer = name === "asset" || name.endsWith(".seed");
  const more = { ...(range.includes("infinity") && { infinity: true }), ...(range.includes("automatic") && { automatic: true }) };
  return { name, type: integer ? "integer" : "real", unit, meaning, minimum, maximum, ...more, default: plain(fallback) === "automatic" ? "automatic" : plain(fallback) === "infinity" ? "inf" : Number(plain(fallback)) };
}

function rows(text) {
  return text
    .split("\n")
    .filter((line) => line.startsWith("| `"))
    .map((line) => field(line.split("|").slice(1, -1).map((cell) => cell.trim())));
}

/** In the order of their numbers. */
export function readKinds(path) {
  const sections = readFileSync(path, "utf8").split(/^## /m).slice(1);
  let common = [];
  const kinds = [];
  for (const section of sections) {
    const name = section.split("\n")[0].trim();
    if (name === "Every surface") common = rows(section);
    else if (/^A surface|\nA surface/.test(section)) kinds.push({ name, surface: true, fields: [...rows(section), ...common] });
    else if (/\nAn effect/.test(section)) kinds.push({ name, surface: false, fields: rows(section) });
  }
  for (const kind of kinds) {
    if (kind.name === "taylor6") for (const f of kind.fields) if (f.name === "jacobian") Object.assign(f, { count: 6, default: Array(36).fill(0) });
  }
  return kinds;
}
