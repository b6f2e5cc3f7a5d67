// The page in a browser. At $KNURL_WEB_URL (the URL with its token that knurl-web prints, of a simulated device, role control; see
// README.md), else at the stand-in. What only the stand-in can make happen is skipped at a real one.
//
// $KNURL_WEB_SHOTS: a folder for pictures.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdirSync, readFileSync, statSync } from "node:fs";
import { dirname, resolve } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { launch, mock, open } from "./browser.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const real = process.env.KNURL_WEB_URL ?? "";
const shots = process.env.KNURL_WEB_SHOTS ?? "";
const onlyMock = { skip: real ? "only the stand-in can do that" : false };
if (shots) mkdirSync(shots, { recursive: true });

let browser;
let server;
let url;
before(async () => {
  browser = await launch();
  if (!real) server = await mock();
  url = real || server.url;
});
after(async () => {
  await browser?.close();
  await server?.stop();
});
const make = async (query) => {
  const answer = await fetch(`http://127.0.0.1:${server.server.address().port}/mock?${query}`, { method: "POST" });
  assert.ok(answer.ok, await answer.clone().text());
  return answer.json();
};
const shot = async (tab, name) => shots && (await tab.screenshot({ path: resolve(shots, `${name}.png`) }));
/** A page that runs, and in the end has said nothing wrong and asked nobody else. */
async function with_page(run, options) {
  const tab = await open(browser, url, options);
  try {
    await tab.waitForFunction(() => window.knurl.counters.frames > 3 && window.knurl.model.current()?.frame);
    await run(tab);
    assert.deepEqual(tab.wrong, []);
    assert.deepEqual(tab.outside, [], "the page asked another host");
  } finally {
    await tab.context().close();
  }
}
const sceneHas = (tab, name) => tab.waitForFunction((n) => window.knurl.scene.getObjectByName(n) !== undefined, name);
const mine = (tab) =>
  tab.evaluate(() => {
    const device = window.knurl.model.current();
    const claim = device.mine();
    return claim ? window.knurl.model.itemsOf(device, claim.claim).map((item) => ({ claim: item.claim, slot: item.slot, kind: item.kind, params: item.params })) : [];
  });
/** One line that the person sees. */
const says = (tab, what) => tab.waitForFunction((source) => [...document.querySelectorAll(".toast")].some((toast) => new RegExp(source).test(toast.textContent)), what.source);
const until = async (tab, what, probe) => {
  for (let k = 0; k < 200; k++) {
    const found = await probe();
    if (found) return found;
    await tab.waitForTimeout(50);
  }
  return assert.fail(`${what}: not within 10 s`);
};

test("opens: the device, its hand, its workspace; reports come", () =>
  with_page(async (tab) => {
    for (const name of ["device", "hand", "workspace", "trail", "force", "arm"]) await sceneHas(tab, `${name}:0`);
    await tab.waitForFunction(() => window.knurl.model.current().history.held > 500);
    // Within a frame, after the page has drawn: no message comes between.
    const { i, place, shown } = await tab.evaluate(
      () =>
        new Promise((done) =>
          requestAnimationFrame(() => {
            const device = window.knurl.model.current();
            done({ i: device.info.i, place: device.frame.p, shown: window.knurl.scene.getObjectByName("hand:0").position.toArray() });
          }),
        ),
    );
    assert.equal(i, 0);
    assert.deepEqual(shown, place);
    assert.equal(await tab.locator("#banner").isHidden(), true);
    assert.match(await tab.locator("#servo").textContent(), /pid \d+/);
    await tab.waitForFunction(() => window.knurl.counters.ageP50 > 0);
    const { ageP50, ageP99, ageWithin, rate } = await tab.evaluate(() => window.knurl.counters);
    console.log(`# a report is ${ageP50.toFixed(1)} ms old when it has been drawn (99 %: ${ageP99.toFixed(1)}), to within ${ageWithin.toFixed(1)} ms, at ${rate.toFixed(0)} frames/s`);
    assert.ok(ageP50 > 0 && ageP99 >= ageP50 && ageWithin > 0);
  }));

test("a plane appears when a client adds one, and moves when it is moved", { skip: real && !process.env.KNURL_WEB_CLIENT ? "KNURL_WEB_CLIENT is not set" : false }, () =>
  with_page(async (tab) => {
    if (!real) {
      const item = await make("do=plane");
      await sceneHas(tab, `item:${item.claim}:${item.slot}`);
      const z = () => tab.evaluate((n) => window.knurl.scene.getObjectByName(n).position.z, `item:${item.claim}:${item.slot}`);
      assert.equal(await z(), 0);
      await make("do=move&offset=0.01");
      await until(tab, "the plane has moved", async () => Math.abs((await z()) - 0.01) < 1e-9);
      await shot(tab, "plane");
      await make("do=clear");
      await tab.waitForFunction((n) => window.knurl.scene.getObjectByName(n) === undefined, `item:${item.claim}:${item.slot}`);
      return;
    }
    const count = () => tab.evaluate(() => [...window.knurl.model.current().items.values()].filter((item) => item.kind === "plane").length);
    const before = await count();
    const client = spawn(process.env.KNURL_WEB_CLIENT, { shell: true, detached: true, stdio: "ignore" });
    try {
      await until(tab, "its plane is there", async () => (await count()) > before);
      const key = await tab.evaluate(() => [...window.knurl.model.current().items.values()].find((item) => item.kind === "plane"));
      await sceneHas(tab, `item:${key.claim}:${key.slot}`);
      await shot(tab, "plane");
    } finally {
      process.kill(-client.pid);
    }
    await until(tab, "its plane is gone", async () => (await count()) <= before);
  }));

test("playground: a preset, a slider that moves it, what is refused, removed", () =>
  with_page(async (tab) => {
    await tab.click("[aria-controls=tab-playground]");
    await tab.click("[data-preset=Floor]");
    const [floor] = await until(tab, "the floor is there", async () => ((await mine(tab)).length ? mine(tab) : null));
    assert.equal(floor.kind, "plane");
    await sceneHas(tab, `item:${floor.claim}:${floor.slot}`);
    const slider = tab.locator("[data-field=offset] input[type=range]");
    await slider.focus();
    const was = floor.params.offset;
    for (let k = 0; k < 40; k++) await tab.keyboard.press("ArrowRight");
    await until(tab, "the server has the slider's offset", async () => (await mine(tab))[0].params.offset > was + 1e-3);
    await until(tab, "it is drawn where the server has it", () =>
      tab.evaluate(
        ({ claim, slot }) =>
          new Promise((done) =>
            requestAnimationFrame(() => {
              const { offset } = window.knurl.model.current().items.get(`${claim}:${slot}`).params;
              done(Math.abs(window.knurl.scene.getObjectByName(`item:${claim}:${slot}`).position.z - offset) < 1e-6);
            }),
          ),
        { claim: floor.claim, slot: floor.slot },
      ),
    );
    await shot(tab, "playground");
    // A value out of range: one line, and the old one stays.
    const number = tab.locator("[data-field=stiffness] input[type=number]");
    await number.fill("-5");
    await number.press("Enter");
    await tab.waitForSelector(".toast.error");
    assert.match(await tab.locator(".toast.error").first().textContent(), /stiffness.*-5/);
    assert.ok((await mine(tab))[0].params.stiffness > 0);
    // Every kind of the table can be added, and is drawn.
    const kinds = await tab.evaluate(() => [...window.knurl.model.kinds.keys()]);
    assert.ok(kinds.length >= 19, kinds.join());
    for (const kind of kinds) {
      await tab.selectOption("#kind", kind);
      await tab.click("#add");
      const item = await until(tab, `${kind} is there`, async () => (await mine(tab)).find((entry) => entry.kind === kind && entry.slot !== floor.slot));
      await sceneHas(tab, `item:${item.claim}:${item.slot}`);
    }
    await shot(tab, "every_kind");
    await tab.click("#to-toml");
    const toml = await tab.inputValue("#exported");
    for (const kind of kinds) assert.ok(toml.includes(`[[${kind}]]`), kind);
    await shot(tab, "export");
    if (process.env.KNURL) {
      // What was exported is a scene for the programs.
      const { mkdtempSync, rmSync, writeFileSync } = await import("node:fs");
      const folder = mkdtempSync("/tmp/knurl-web-");
      writeFileSync(`${folder}/scene.toml`, toml);
      writeFileSync(`${folder}/motion.csv`, "t,x,y,z\n0,0,0,0.05\n1,0,0,-0.01\n");
      const { spawnSync } = await import("node:child_process");
      const eval_ = spawnSync(process.env.KNURL, ["eval", "--scene", `${folder}/scene.toml`, "--motion", `${folder}/motion.csv`, "--out", `${folder}/out.csv`], { encoding: "utf8" });
      assert.equal(eval_.status, 0, eval_.stderr);
      assert.ok(readFileSync(`${folder}/out.csv`, "utf8").split("\n").length > 900);
      rmSync(folder, { recursive: true });
    }
    if (shots) {
      const { writeFileSync } = await import("node:fs");
      await tab.keyboard.press("Escape");
      for (const [button, name] of [["#to-toml", "scene.toml"], ["#to-cpp", "scene.cpp"], ["#to-python", "scene.py"]]) {
        await tab.click(button);
        writeFileSync(resolve(shots, name), await tab.inputValue("#exported"));
        await tab.click("#export-dialog [data-close]");
      }
      await tab.click("#to-toml");
    }
    await tab.keyboard.press("Escape");
    await tab.click("#clear");
    await until(tab, "all is removed", async () => (await mine(tab)).length === 0);
    await tab.waitForFunction(({ claim, slot }) => window.knurl.scene.getObjectByName(`item:${claim}:${slot}`) === undefined, floor);
  }));

test("a mesh is dropped, sent and drawn; a file that is none is one line", () =>
  with_page(async (tab) => {
    await tab.click("[aria-controls=tab-playground]");
    const facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 40 0 0\nvertex 0 40 0\nendloop\nendfacet\n";
    const back = "facet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 40 0\nvertex 40 0 0\nendloop\nendfacet\n";
    await tab.setInputFiles("#mesh-file", { name: "plate.stl", mimeType: "model/stl", buffer: Buffer.from(`solid plate\n${facet}${back}endsolid plate\n`) });
    const shape = await until(tab, "the shape is there", async () => (await mine(tab)).find((item) => item.kind === "shape"));
    await tab.waitForFunction(({ claim, slot }) => window.knurl.scene.getObjectByName(`item:${claim}:${slot}`)?.getObjectByName("asset"), shape);
    await shot(tab, "mesh");
    await tab.setInputFiles("#mesh-file", { name: "broken.stl", mimeType: "model/stl", buffer: Buffer.from("solid x") });
    await tab.waitForSelector(".toast.error");
    assert.match(await tab.locator(".toast.error").first().textContent(), /^broken\.stl: /);
    // The same by a drop.
    const before = (await mine(tab)).length;
    await tab.evaluate((text) => {
      const data = new DataTransfer();
      data.items.add(new File([text], "dropped.stl"));
      window.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
    }, `solid plate\n${facet}${back}endsolid plate\n`);
    await until(tab, "the dropped one is there", async () => (await mine(tab)).length === before + 1);
    await tab.setInputFiles("#mesh-file", { name: "letter.docx", mimeType: "x/y", buffer: Buffer.from("x") });
    await says(tab, /letter\.docx: neither STL, OBJ nor PLY/);
    await tab.click("#clear");
  }));

test("the mouse is a hand", () =>
  with_page(async (tab) => {
    if (!(await tab.evaluate(() => window.knurl.model.current().info.pull))) return;
    const at = await tab.evaluate(() => window.knurl.view.handOnScreen(window.knurl.model.current()));
    await tab.mouse.move(at.x, at.y);
    // The hand goes on meanwhile.
    const now = await tab.evaluate(() => window.knurl.view.handOnScreen(window.knurl.model.current()));
    await tab.mouse.move(now.x, now.y);
    await tab.mouse.down();
    await tab.mouse.move(now.x + 60, now.y - 90, { steps: 8 });
    const target = await until(tab, "the pull has a target", () => tab.evaluate(() => window.knurl.scene.getObjectByName("pull:0").visible && window.knurl.view && window.knurl.scene.getObjectByName("hand:0").position.toArray()));
    assert.equal(target.length, 3);
    // It is drawn to where the mouse is.
    await until(tab, "the hand has followed", () =>
      tab.evaluate(({ x, y }) => {
        const on = window.knurl.view.handOnScreen(window.knurl.model.current());
        return Math.hypot(on.x - x, on.y - y) < 45;
      }, { x: now.x + 60, y: now.y - 90 }),
    );
    await shot(tab, "pull");
    await tab.mouse.up();
    await tab.waitForFunction(() => !window.knurl.scene.getObjectByName("pull:0").visible);
  }));

test("a fault: its cause and remedy, and the way out", onlyMock, () =>
  with_page(async (tab) => {
    await make("do=fault&names=slew,overload");
    await tab.waitForSelector("[data-fault=slew]");
    assert.match(await tab.locator("[data-fault=slew]").textContent(), /2000 N\/s.*Lower the stiffness/s);
    assert.equal(await tab.locator("[data-fault]").count(), 2);
    assert.equal(await tab.locator("#state").textContent(), "fault");
    await shot(tab, "fault");
    await tab.click("#arm");
    await says(tab, /reset it first/);
    await tab.click("#reset");
    await tab.waitForFunction(() => document.querySelector("#faults").hidden);
    await tab.click("#arm");
    await tab.waitForFunction(() => document.querySelector("#state").textContent === "active");
  }));

test("a hand that buzzes: how much, at which frequency, and why", onlyMock, () =>
  with_page(async (tab) => {
    await make("do=plane");
    await make("do=buzz");
    await tab.waitForFunction(() => /mm at 8[345] Hz/.test(document.querySelector("#buzz").textContent), null, { timeout: 20000 });
    assert.match(await tab.locator("#advice-over").textContent(), /^The hand buzzes: 0\.1[12] mm at 84 Hz\./);
    await shot(tab, "buzz");
    await make("do=calm");
    await make("do=clear");
    await tab.waitForFunction(() => document.querySelector("#advice-over").hidden, null, { timeout: 20000 });
  }));

test("silent clients' things are pale, sleeping ones grey, and the pointer says whose they are", onlyMock, () =>
  with_page(async (tab) => {
    await make("do=plane");
    const far = await make("do=plane");
    assert.ok(far.slot >= 0);
    await make("do=silent");
    await tab.waitForFunction((n) => window.knurl.scene.getObjectByName(n)?.userData.mood === "faded", `item:${far.claim}:${far.slot}`);
    await make("do=silent&on=0");
    await tab.waitForFunction((n) => ["there", "touched"].includes(window.knurl.scene.getObjectByName(n)?.userData.mood), `item:${far.claim}:${far.slot}`);
    const says = await tab.evaluate(() => {
      const device = window.knurl.model.current();
      return window.knurl.view.describe(device, [...device.items.values()][0]);
    });
    assert.match(says, /^plane, slot \d+, of floor \(pid \d+\)\nstiffness 800 N\/m/);
    await make("do=clear");
  }));

test("the pointer finds what is drawn alone, and what is drawn together with others", onlyMock, () =>
  with_page(async (tab) => {
    for (const [what, drawn] of [["do=show", "alone"], ["do=hundred&n=60", "together"]]) {
      await make("do=clear");
      await tab.waitForFunction(() => window.knurl.model.current().items.size === 0);
      await make(what);
      // A ball, looked at from above, so that nothing is in front of its middle but what is above it.
      const item = await until(tab, "a ball is there", () => tab.evaluate(() => [...window.knurl.model.current().items.values()].find((entry) => entry.kind === "sphere")));
      await sceneHas(tab, `item:${item.claim}:${item.slot}`);
      if (drawn === "together") await tab.waitForFunction((n) => window.knurl.scene.getObjectByName(n).children[0].layers.mask === 2, `item:${item.claim}:${item.slot}`);
      const box = await tab.locator("#scene").boundingBox();
      const place = () =>
        tab.evaluate(({ n }) => {
          const { scene, view } = window.knurl;
          const p = scene.getObjectByName(n).getWorldPosition(view.camera.position.clone()).project(view.camera);
          return { x: (p.x + 1) / 2, y: (1 - p.y) / 2 };
        }, { n: `item:${item.claim}:${item.slot}` });
      const { x, y } = await place();
      await tab.mouse.move(box.x + x * box.width + 1, box.y + y * box.height + 1);
      await tab.mouse.move(box.x + x * box.width, box.y + y * box.height);
      await tab.waitForFunction(() => !document.querySelector("#tip").hidden);
      assert.match(await tab.locator("#tip").textContent(), /slot \d+, of .+ \(pid \d+\)/);
      await shot(tab, `hover_${drawn}`);
    }
    await make("do=clear");
  }));

test("a recording plays, is scrubbed, and closed; a file that is none is one line", () =>
  with_page(async (tab) => {
    await tab.setInputFiles("#open-file", resolve(here, "wall.mcap"));
    await tab.waitForFunction(() => window.knurl.model.recording && !document.querySelector("#recording-bar").hidden);
    assert.match(await tab.locator("#recording-name").textContent(), /wall\.mcap · Knurl .* reports/);
    await sceneHas(tab, "hand:-1");
    await tab.locator("#scrub").focus();
    await tab.evaluate(() => {
      const scrub = document.querySelector("#scrub");
      scrub.value = "5000";
      scrub.dispatchEvent(new Event("input"));
    });
    const { cursor, shown, said } = await tab.evaluate(async () => {
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      const { model, scene } = window.knurl;
      const h = model.recording.history;
      const k = h.find(model.cursor - 1e-9);
      return { cursor: model.cursor, shown: scene.getObjectByName("hand:-1").position.toArray(), said: [h.columns.px[k], h.columns.py[k], h.columns.pz[k]] };
    });
    assert.ok(Math.abs(cursor - 0.8) < 0.01, `${cursor} s`);
    assert.ok(Math.hypot(...shown.map((x, k) => x - said[k])) < 1e-9, `${shown}, ${said}`);
    // Arm, plane and mesh as they were then; none of the two before they were added.
    const things = () =>
      tab.evaluate(async () => {
        await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
        const { model, scene } = window.knurl;
        const names = [];
        scene.getObjectByName("device:-1").traverse((one) => one.name.startsWith("item:") && names.push(one.name));
        return { kinds: [...model.recording.items.values()].map((item) => item.kind).sort(), names, arm: scene.getObjectByName("arm:-1").visible };
      });
    const seek = (value) =>
      tab.evaluate((to) => {
        const scrub = document.querySelector("#scrub");
        scrub.value = String(to);
        scrub.dispatchEvent(new Event("input"));
      }, value);
    let there = await things();
    assert.deepEqual(there.kinds, ["plane", "shape"]);
    assert.ok(there.names.length === 2 && there.arm, JSON.stringify(there));
    await tab.waitForFunction(() => {
      let triangles = 0;
      window.knurl.scene.getObjectByName("device:-1").traverse((one) => one.name === "asset" && (triangles = one.geometry.index?.count ?? 0));
      return triangles === 36;
    });
    await seek(0);
    there = await things();
    assert.ok(there.kinds.length === 0 && there.names.length === 0, JSON.stringify(there));
    await seek(5000);
    assert.deepEqual((await things()).kinds, ["plane", "shape"]);
    await tab.waitForTimeout(300);
    await shot(tab, "recording");
    await tab.keyboard.press("Tab");
    await tab.evaluate(() => document.activeElement.blur());
    await tab.keyboard.press(" ");
    await tab.waitForFunction((was) => window.knurl.model.cursor > was + 0.1, cursor);
    await tab.click("#close-recording");
    await tab.waitForFunction(() => !window.knurl.model.recording && window.knurl.scene.getObjectByName("hand:0"));
    await tab.setInputFiles("#open-file", { name: "none.mcap", mimeType: "x/y", buffer: Buffer.from("not an MCAP file at all") });
    await says(tab, /none\.mcap: no MCAP file/);
  }));

test("a recording into a file goes on when the page is loaded anew, and is stopped there", onlyMock, async () => {
  await with_page(async (tab) => {
    await tab.click("#record");
    await tab.waitForFunction(() => /^Stop/.test(document.querySelector("#record").textContent));
  });
  await with_page(async (tab) => {
    await tab.waitForFunction(() => /^Stop/.test(document.querySelector("#record").textContent));
    assert.match(await tab.locator("#record-path").textContent(), /recordings\/knurl\.mcap/);
    await tab.click("#record");
    await tab.waitForFunction(() => document.querySelector("#record").textContent === "Record");
  });
});

test("the server is killed under the page: it says so, and comes back", onlyMock, () =>
  with_page(async (tab) => {
    await tab.click("[aria-controls=tab-playground]");
    await tab.click("[data-preset=Magnet]");
    await until(tab, "the magnet is there", async () => (await mine(tab)).length === 1);
    await make("do=down&ms=1500");
    await tab.waitForFunction(() => !document.querySelector("#banner").hidden);
    assert.match(await tab.locator("#banner").textContent(), /connection to knurl-web was lost; the next attempt is in .* s/);
    await shot(tab, "lost");
    await tab.waitForFunction(() => document.querySelector("#banner").hidden && window.knurl.counters.reconnects >= 1 && window.knurl.model.current()?.frame, null, { timeout: 20000 });
    // What this page had ended with its socket; it can have it again.
    await tab.click("#restore");
    await until(tab, "the magnet is there again", async () => (await mine(tab))[0]?.kind === "magnet");
    // The servo itself goes and comes.
    await make("do=away");
    await tab.waitForFunction(() => /no servo is running/.test(document.querySelector("#servo").textContent));
    await make("do=away&on=0");
    await tab.waitForFunction(() => /pid \d+/.test(document.querySelector("#servo").textContent) && window.knurl.model.current()?.frame);
    // Its session is gone: a new URL is needed.
    await make("do=forget");
    await tab.waitForFunction(() => document.querySelector("#banner").dataset.state === "gone");
    assert.match(await tab.locator("#banner").textContent(), /Open the URL that knurl-web printed/);
    await make("do=forget&on=0");
  }));

test("bad input: one clear line each, and the page goes on", onlyMock, () =>
  with_page(async (tab) => {
    for (const [text, line] of [
      ["{]", /no JSON/],
      ['{"op":"dance"}', /"dance", which this page does not know/],
      ["[]", /without op/],
    ]) {
      await make(`do=garbage&text=${encodeURIComponent(text)}`);
      await says(tab, line);
    }
    const frames = await tab.evaluate(() => window.knurl.counters.frames);
    await tab.waitForFunction((was) => window.knurl.counters.frames > was + 2 && window.knurl.model.current().frame, frames);
  }));

test("who may only look on is told so", onlyMock, async () => {
  const own = await mock({ role: "observe" });
  const tab = await open(browser, own.url);
  try {
    await tab.waitForFunction(() => window.knurl.model.hello);
    assert.equal(await tab.locator("#arm").isDisabled(), true);
    await tab.click("[aria-controls=tab-playground]");
    assert.equal(await tab.locator("#playground-why").isVisible(), true);
    await assert.rejects(tab.evaluate(() => window.knurl.connection.request("arm", { device: 0 })), /needs the role control/);
  } finally {
    await tab.context().close();
    await own.stop();
  }
});

test("two devices side by side, each with its own charts", onlyMock, async () => {
  const own = await mock({ devices: 2 });
  const tab = await open(browser, own.url);
  try {
    await sceneHas(tab, "hand:1");
    await tab.click("#devices button:nth-child(2)");
    await tab.waitForFunction(() => window.knurl.model.current().info.name === "left");
    await tab.waitForTimeout(300);
    await shot(tab, "two_devices");
    assert.deepEqual(tab.wrong, []);
  } finally {
    await tab.context().close();
    await own.stop();
  }
});

test("keys, themes, a phone's width", () =>
  with_page(
    async (tab) => {
      await tab.keyboard.press("?");
      await tab.waitForSelector("#help-dialog[open]");
      await tab.keyboard.press("Escape");
      await tab.keyboard.press("2");
      assert.equal(await tab.locator("#tab-clients").isVisible(), true);
      await tab.keyboard.press("t");
      assert.equal(await tab.evaluate(() => document.documentElement.dataset.theme), "light");
      await tab.keyboard.press("p");
      assert.equal(await tab.locator("#pause").getAttribute("aria-pressed"), "true");
      await tab.keyboard.press("p");
      // Nothing is wider than the window.
      assert.ok(await tab.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth));
      await tab.waitForTimeout(600);
      await shot(tab, "phone_light");
      await tab.keyboard.press("t");
      await tab.keyboard.press("3");
      if (shots) await tab.screenshot({ path: resolve(shots, "phone_dark.png"), fullPage: true });
    },
    { viewport: { width: 390, height: 844 }, hasTouch: true },
  ));

test("every control has a name", () =>
  with_page(async (tab) => {
    const nameless = await tab.evaluate(() =>
      [...document.querySelectorAll("button, input:not([hidden]), select, textarea")]
        .filter((element) => !(element.textContent.trim() || element.getAttribute("aria-label") || element.title || element.closest("label")))
        .map((element) => element.outerHTML.slice(0, 80)),
    );
    assert.deepEqual(nameless, []);
  }));

test("100 representations and a mesh of 100 000 triangles: all drawn, by so much work", onlyMock, () =>
  with_page(async (tab) => {
    await make("do=mesh&triangles=100000");
    await make("do=hundred&n=99");
    await tab.waitForFunction(() => {
      let count = 0;
      window.knurl.scene.traverse((object) => (count += object.name.startsWith("item:") ? 1 : 0));
      return count === 100 && window.knurl.scene.getObjectByName("asset");
    }, null, { timeout: 30000 });
    // Time of the processor, not of the clock: what else runs on the machine counts less.
    const cdp = await tab.context().newCDPSession(tab);
    await cdp.send("Performance.enable", { timeDomain: "threadTicks" });
    const script = async () => (await cdp.send("Performance.getMetrics")).metrics.find(({ name }) => name === "ScriptDuration").value;
    await tab.evaluate(() => window.knurl.resetCounters());
    const begin = await script();
    await tab.waitForFunction(() => window.knurl.counters.frames > 100, null, { timeout: 120000 });
    const end = await script();
    const counters = await tab.evaluate(() => window.knurl.counters);
    assert.ok(counters.triangles >= 100000, `${counters.triangles} triangles`);
    console.log(`# scripts: ${((1000 * (end - begin)) / counters.frames).toFixed(1)} ms of the processor per frame`);
    console.log(`# own work per frame: median ${counters.workP50.toFixed(1)} ms, at most ${counters.workMax.toFixed(1)} ms; ${counters.rate.toFixed(1)} frames/s by ${counters.renderer}`);
    await shot(tab, "hundred");
    await make("do=clear");
  }));

test("charts as CSV and pictures", () =>
  with_page(async (tab) => {
    await tab.waitForFunction(() => window.knurl.model.current().history.held > 300);
    for (const [button, name, start] of [["#csv", /\.csv$/, "t [s],px [m]"], ["#png", /\.png$/, "\u0089PNG"], ["#shot", /\.png$/, "\u0089PNG"]]) {
      const [file] = await Promise.all([tab.waitForEvent("download"), tab.click(button)]);
      assert.match(file.suggestedFilename(), name);
      const path = await file.path();
      assert.ok(statSync(path).size > 500);
      assert.ok(readFileSync(path, "latin1").startsWith(start));
    }
  }));
