// The 3D view: camera, light, picking, and the mouse as a hand.
import {
  AmbientLight,
  Box3,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  type Mesh,
  type Object3D,
  PerspectiveCamera,
  Plane,
  Quaternion,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { type Device, type Model, type SeenItem, frameFromHistory } from "../model.ts";
import { type Claim, type DeviceFrame, decodeAsset } from "../protocol.ts";
import { onTheme, palette } from "../theme.ts";
import { batchedLayer } from "./batch.ts";
import { DeviceView } from "./device_view.ts";

const heavy = 20_000; // triangles; above it a box stands for a mesh when the mouse looks for it

export interface ViewEvents {
  pull(device: Device, target: [number, number, number] | null): void;
  /** An item of this page was dragged by `by` metres in its claim's world. */
  drag(device: Device, item: SeenItem, by: [number, number, number]): void;
  say(level: string, text: string): void;
}

/** A processor draws, not a graphics card: smooth edges would cost it most of its frames. */
function drawnInSoftware(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  const extension = context?.getExtension("WEBGL_debug_renderer_info");
  const by = context && extension ? String(context.getParameter(extension.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|softpipe/i.test(by);
}

export class View {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(40, 1, 1e-4, 100);
  private renderer: WebGLRenderer | null = null;
  private readonly controls: OrbitControls;
  private readonly views = new Map<Device, DeviceView>();
  private readonly light = new DirectionalLight(0xffffff, 2.2);
  private readonly assets = new Map<string, BufferGeometry | "asked" | "none">();
  private readonly ray = new Raycaster();
  private follow = false;
  private fitted: Device | null = null;
  private pointer: { x: number; y: number } | null = null;
  private lookedAt = 0;
  private grip: { device: Device; plane: Plane; item: SeenItem | null; from: Vector3; sent: Vector3 } | null = null;
  private readonly gizmo: CanvasRenderingContext2D | null;
  hovered = "";
  private by: string | null = null;
  /** Of the canvas; asking for it in each frame would lay the page out in each. */
  private height = 1;
  private turnedTo = new Quaternion(0, 0, 0, 0);

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly model: Model,
    private readonly parts: { tip: HTMLElement; scale: HTMLElement; gizmo: HTMLCanvasElement },
    private readonly events: ViewEvents,
  ) {
    this.scene.name = "knurl";
    this.ray.layers.enable(batchedLayer);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(0.4, 0, 0.12); // where the user sits
    try {
      const soft = drawnInSoftware();
      this.renderer = new WebGLRenderer({ canvas, antialias: !soft });
      this.renderer.setPixelRatio(soft ? 1 : Math.min(2, window.devicePixelRatio));
    } catch {
      events.say("error", "This browser gives no WebGL, so nothing is drawn in 3D; charts, panel and playground work.");
    }
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.zoomSpeed = 0.8;
    this.light.position.set(0.6, -0.4, 1);
    this.scene.add(new AmbientLight(0xffffff, 1.6), this.light);
    this.gizmo = parts.gizmo.getContext("2d");
    onTheme(() => this.colour());
    this.colour();
    this.listen();
  }

  private colour(): void {
    this.scene.background = new Color(palette().background);
    for (const view of this.views.values()) view.colour();
    this.turnedTo.set(0, 0, 0, 0);
  }

  // ---- assets

  /** The mesh of an asset; asks for it once, and again when `model` says that the scene changed. */
  private asset(device: number, claim: number, number: number, smooth: boolean): BufferGeometry | null {
    if (number === 0) return null;
    const url = `./asset/${device}/${claim}/${number}`;
    const key = url + (smooth ? "#smooth" : "");
    const there = this.assets.get(key);
    if (there && typeof there !== "string") return there;
    if (there === undefined) {
      this.assets.set(key, "asked");
      void this.load(device < 0 ? `${claim}/${number}` : null, url, key, smooth);
    }
    return null;
  }
  /** Null: it is not known yet. */
  private async bytesOf(recorded: string | null, url: string): Promise<ArrayBuffer | null> {
    if (recorded !== null) return this.model.recordedMeshes.get(recorded) ?? null;
    const answer = await fetch(url);
    if (answer.status === 404) return null;
    if (!answer.ok) throw new Error(`${answer.status} ${answer.statusText}`);
    return answer.arrayBuffer();
  }
  private async load(recorded: string | null, url: string, key: string, smooth: boolean): Promise<void> {
    try {
      const bytes = await this.bytesOf(recorded, url);
      if (bytes === null) {
        window.setTimeout(() => this.assets.delete(key), 1000);
        return;
      }
      const { positions, indices } = decodeAsset(bytes);
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(positions, 3));
      geometry.setIndex(new BufferAttribute(indices, 1));
      geometry.userData.shared = true;
      geometry.computeBoundingSphere();
      geometry.computeBoundingBox();
      if (smooth) geometry.computeVertexNormals();
      this.assets.set(key, geometry);
    } catch (error) {
      this.assets.set(key, "none");
      this.events.say("error", `The mesh ${url.slice(2)} cannot be drawn: ${error instanceof Error ? error.message : String(error)}`);
    }
  }
  /** Another servo has other assets under the same numbers. */
  forgetAssets(): void {
    for (const entry of this.assets.values()) if (typeof entry !== "string") entry.dispose();
    this.assets.clear();
  }

  // ---- each frame

  private layout(): void {
    const shown = this.model.shown();
    for (const [device, view] of this.views)
      if (!shown.includes(device)) {
        view.dispose();
        this.views.delete(device);
      }
    let y = 0;
    shown.forEach((device, k) => {
      let view = this.views.get(device);
      if (!view) {
        view = new DeviceView(device, (...of) => this.asset(...of));
        this.views.set(device, view);
        this.scene.add(view.root);
      }
      // Side by side, each in its own frame.
      if (k > 0) y += 1.3 * (device.info.radius + shown[k - 1].info.radius);
      view.root.position.set(0, y, 0);
    });
    const current = this.model.current();
    if (current && current !== this.fitted) {
      this.fitted = current;
      this.fit();
    }
  }

  frameOf(device: Device): DeviceFrame | null {
    if (device === this.model.recording) return (device.history.held && device.frame) || frameFromHistory(device, device.history.find(this.model.cursor));
    return device.frame;
  }

  draw(time: number): void {
    this.layout();
    for (const [device, view] of this.views) {
      const silent = new Map<number, boolean>();
      for (const client of device.status?.clients ?? []) silent.set(client.row, client.silent || client.shed);
      const isSilent = (claim: Claim) => silent.get(claim.row) ?? false;
      view.update(this.frameOf(device), device === this.model.recording ? this.model.cursor : device.history.last, time, device === this.model.current(), isSilent);
    }
    if (this.follow) this.centreOnHand();
    this.controls.update();
    this.light.position.copy(this.camera.position).add(new Vector3(0, -0.2, 0.4));
    this.renderer?.render(this.scene, this.camera);
    this.drawScale();
    this.drawGizmo();
    if (this.pointer && time - this.lookedAt > 0.12 && !this.grip) {
      this.lookedAt = time;
      this.hover(this.pointer.x, this.pointer.y);
    }
  }

  resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.height = height;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.renderer?.setSize(width, height, false);
  }

  private viewOf(device: Device | undefined): DeviceView | undefined {
    return device && this.views.get(device);
  }
  private middle(device: Device): Vector3 {
    const view = this.viewOf(device);
    return new Vector3(...device.info.centre).add(view?.root.position ?? new Vector3());
  }

  /** The whole workspace, from where the user sits. */
  fit(): void {
    const device = this.model.current();
    if (!device) return;
    const middle = this.middle(device);
    const distance = (1.45 * device.info.radius) / Math.tan((this.camera.fov * Math.PI) / 360) / Math.min(1, this.camera.aspect);
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).add(new Vector3(0.9, 0.16, 0.4).normalize().multiplyScalar(distance));
    this.camera.near = distance / 300;
    this.camera.far = distance * 60;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }
  /** Along an axis: from the user's side, from the right, from above. */
  look(from: "x" | "y" | "z"): void {
    const distance = this.camera.position.distanceTo(this.controls.target);
    const along = { x: new Vector3(1, 0, 0), y: new Vector3(0, 1, 0), z: new Vector3(0.001, 0, 1) }[from];
    this.camera.position.copy(this.controls.target).addScaledVector(along, distance);
    this.controls.update();
  }
  toggleFollow(): boolean {
    this.follow = !this.follow;
    return this.follow;
  }
  private centreOnHand(): void {
    const device = this.model.current();
    const view = this.viewOf(device);
    if (!device || !view || !this.frameOf(device)) return;
    const by = view.hand.getWorldPosition(new Vector3()).sub(this.controls.target).multiplyScalar(0.15);
    this.controls.target.add(by);
    this.camera.position.add(by);
  }

  private drawScale(): void {
    const device = this.model.current();
    if (!device) return;
    const distance = this.camera.position.distanceTo(this.controls.target);
    const perPixel = (2 * distance * Math.tan((this.camera.fov * Math.PI) / 360)) / this.height;
    const wanted = 110 * perPixel;
    const power = 10 ** Math.floor(Math.log10(wanted));
    const length = [5, 2, 1].map((k) => k * power).find((x) => x <= wanted) ?? power;
    const text = length >= 1 ? `${length} m` : length >= 1e-3 ? `${+(length * 1e3).toPrecision(2)} mm` : `${+(length * 1e6).toPrecision(2)} µm`;
    const width = `${Math.round(length / perPixel)}px`;
    if (this.parts.scale.textContent !== text) this.parts.scale.textContent = text;
    if (this.parts.scale.style.width !== width) this.parts.scale.style.width = width;
  }
  private drawGizmo(): void {
    const g = this.gizmo;
    if (!g || this.turnedTo.equals(this.camera.quaternion)) return;
    this.turnedTo.copy(this.camera.quaternion);
    const size = 132;
    if (this.parts.gizmo.width !== size) this.parts.gizmo.width = this.parts.gizmo.height = size;
    g.clearRect(0, 0, size, size);
    const axes: [string, Vector3, string][] = [
      ["x", new Vector3(1, 0, 0), palette().axes[0]],
      ["y", new Vector3(0, 1, 0), palette().axes[1]],
      ["z", new Vector3(0, 0, 1), palette().axes[2]],
    ];
    const turn = this.camera.quaternion.clone().invert();
    const drawn = axes.map(([name, v, colour]) => ({ name, v: v.applyQuaternion(turn), colour })).sort((a, b) => a.v.z - b.v.z);
    g.font = "bold 20px system-ui, sans-serif";
    g.textAlign = "center";
    g.textBaseline = "middle";
    g.lineWidth = 4;
    for (const { name, v, colour } of drawn) {
      g.strokeStyle = g.fillStyle = colour;
      g.globalAlpha = v.z < -0.2 ? 0.5 : 1;
      g.beginPath();
      g.moveTo(size / 2, size / 2);
      g.lineTo(size / 2 + 42 * v.x, size / 2 - 42 * v.y);
      g.stroke();
      g.fillText(name, size / 2 + 55 * v.x, size / 2 - 55 * v.y);
    }
    g.globalAlpha = 1;
  }

  // ---- picking

  private at(x: number, y: number): void {
    const box = this.canvas.getBoundingClientRect();
    this.ray.setFromCamera(new Vector2(((x - box.left) / box.width) * 2 - 1, 1 - ((y - box.top) / box.height) * 2), this.camera);
  }
  /** The item below a place of the window. */
  private itemAt(x: number, y: number): { device: Device; item: SeenItem } | null {
    this.at(x, y);
    this.ray.params.Line.threshold = 0.008 * this.camera.position.distanceTo(this.controls.target);
    const found: { distance: number; device: Device; item: SeenItem }[] = [];
    for (const [device, view] of this.views)
      for (const [key, item] of device.items) {
        const root = view.drawnItem(key)?.drawing.root;
        if (!root) continue;
        const distance = this.hit(root);
        if (distance !== null) found.push({ distance, device, item });
      }
    found.sort((a, b) => a.distance - b.distance);
    return found[0] ?? null;
  }
  private hit(root: Object3D): number | null {
    let best: number | null = null;
    root.traverseVisible((object) => {
      const geometry = (object as Mesh).geometry as BufferGeometry | undefined;
      if (!geometry?.getAttribute("position")) return;
      if ((geometry.index?.count ?? 0) > 3 * heavy) {
        const box = (geometry.boundingBox ?? new Box3()).clone().applyMatrix4(object.matrixWorld);
        const at = this.ray.ray.intersectBox(box, new Vector3());
        if (at) best = Math.min(best ?? Infinity, at.distanceTo(this.camera.position));
        return;
      }
      const hits = this.ray.intersectObject(object, false);
      if (hits.length) best = Math.min(best ?? Infinity, hits[0].distance);
    });
    return best;
  }

  private hover(x: number, y: number): void {
    const tip = this.parts.tip;
    const grabbed = this.handAt(x, y);
    const found = grabbed ? null : this.itemAt(x, y);
    this.canvas.style.cursor = grabbed?.info.pull && this.model.can("control") ? "grab" : found ? "pointer" : "";
    this.hovered = found ? this.describe(found.device, found.item) : grabbed ? this.describeHand(grabbed) : "";
    tip.hidden = this.hovered === "";
    if (tip.hidden) return;
    tip.textContent = this.hovered;
    const box = this.canvas.getBoundingClientRect();
    tip.style.left = `${Math.min(box.width - tip.offsetWidth - 8, x - box.left + 14)}px`;
    tip.style.top = `${Math.max(4, Math.min(box.height - tip.offsetHeight - 8, y - box.top + 14))}px`;
  }
  private describeHand(device: Device): string {
    const frame = this.frameOf(device);
    if (!frame) return "";
    const may = device.info.pull && this.model.can("control") ? "\ndrag to pull it" : "";
    return `hand of ${device.info.name}: ${frame.p.map((x) => (1e3 * x).toFixed(1)).join(", ")} mm${may}`;
  }
  describe(device: Device, item: SeenItem): string {
    const claim = device.claims.get(item.claim);
    const who = claim ? (claim.mine ? "this page" : `${claim.name || "unnamed"} (pid ${claim.pid})`) : "nobody";
    const lines = [`${item.kind.replaceAll("_", " ")}, slot ${item.slot}, of ${who}`];
    const k = item.params.stiffness;
    if (k !== undefined) lines.push(`stiffness ${k} N/m` + (item.params.damping ? `, damping ${item.params.damping} N s/m` : ""));
    if (item.probe) lines.push(`acts on probe ${item.probe}`);
    const felt = item.felt;
    if (felt) {
      const flags = felt[2];
      const force = Math.hypot(felt[3], felt[4], felt[5]);
      const says = [
        flags & 1 ? `touched, ${force.toFixed(2)} N` : force > 0.005 ? `${force.toFixed(2)} N` : "",
        flags & 2 ? "clamped to what the device allows" : "",
        flags & 4 ? "contradicts others" : "",
        flags & 8 ? "fading" : "",
        flags & 16 ? "its application is silent" : "",
        flags & 32 ? "asleep: out of reach" : "",
      ].filter(Boolean);
      if (says.length) lines.push(says.join(", "));
    }
    return lines.join("\n");
  }

  /** The device whose hand is at a place of the window. */
  private handAt(x: number, y: number): Device | null {
    const box = this.canvas.getBoundingClientRect();
    for (const [device, view] of this.views) {
      if (!view.hand.visible) continue;
      const p = view.hand.getWorldPosition(new Vector3()).project(this.camera);
      if (p.z > 1) continue;
      const px = box.left + ((p.x + 1) / 2) * box.width;
      const py = box.top + ((1 - p.y) / 2) * box.height;
      if (Math.hypot(px - x, py - y) < 18) return device;
    }
    return null;
  }
  /** Where the hand is in the window, for tests and for keys. */
  handOnScreen(device: Device): { x: number; y: number } | null {
    const view = this.views.get(device);
    if (!view) return null;
    const box = this.canvas.getBoundingClientRect();
    const p = view.hand.getWorldPosition(new Vector3()).project(this.camera);
    return { x: box.left + ((p.x + 1) / 2) * box.width, y: box.top + ((1 - p.y) / 2) * box.height };
  }

  // ---- mouse

  private listen(): void {
    const canvas = this.canvas;
    canvas.addEventListener(
      "pointerdown",
      (event) => {
        if (event.button !== 0) return;
        const device = this.handAt(event.clientX, event.clientY);
        const normal = this.camera.getWorldDirection(new Vector3());
        if (device?.info.pull && this.model.can("control") && device !== this.model.recording) {
          const from = this.views.get(device)!.hand.getWorldPosition(new Vector3());
          this.grip = { device, plane: new Plane().setFromNormalAndCoplanarPoint(normal, from), item: null, from, sent: from.clone() };
        } else if (event.altKey && this.model.can("render")) {
          const found = this.itemAt(event.clientX, event.clientY);
          if (!found || !found.device.claims.get(found.item.claim)?.mine) return;
          const root = this.views.get(found.device)!.drawnItem(`${found.item.claim}:${found.item.slot}`)!.drawing.root;
          const through = root.getWorldPosition(new Vector3());
          const plane = new Plane().setFromNormalAndCoplanarPoint(normal, through);
          const from = this.ray.ray.intersectPlane(plane, new Vector3());
          if (!from) return;
          this.grip = { device: found.device, plane, item: found.item, from, sent: from.clone() };
        } else return;
        this.controls.enabled = false;
        canvas.setPointerCapture(event.pointerId);
        canvas.style.cursor = "grabbing";
        this.parts.tip.hidden = true;
        event.stopImmediatePropagation();
      },
      { capture: true },
    );
    canvas.addEventListener("pointermove", (event) => {
      this.pointer = event.pointerType === "mouse" ? { x: event.clientX, y: event.clientY } : null;
      if (!this.grip) return;
      this.at(event.clientX, event.clientY);
      const target = this.ray.ray.intersectPlane(this.grip.plane, new Vector3());
      if (!target) return;
      const view = this.views.get(this.grip.device);
      if (!view) return;
      if (this.grip.item) {
        const scale = this.grip.device.claims.get(this.grip.item.claim)?.frame.scale ?? 1;
        const by = target.clone().sub(this.grip.sent).multiplyScalar(scale);
        this.grip.sent.copy(target);
        this.events.drag(this.grip.device, this.grip.item, by.toArray());
        return;
      }
      const local = target.clone().sub(view.root.position);
      view.target = local;
      this.events.pull(this.grip.device, local.toArray());
    });
    const end = () => {
      if (!this.grip) return;
      const { device, item } = this.grip;
      this.grip = null;
      this.controls.enabled = true;
      canvas.style.cursor = "";
      const view = this.views.get(device);
      if (view) view.target = null;
      if (!item) this.events.pull(device, null);
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("lostpointercapture", end);
    canvas.addEventListener("pointerleave", () => {
      this.pointer = null;
      this.parts.tip.hidden = true;
      this.hovered = "";
    });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  /** What is drawn, as a picture. */
  picture(): Promise<Blob | null> {
    this.renderer?.render(this.scene, this.camera);
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }
  /** Of the software or hardware that draws. */
  get info(): { triangles: number; calls: number; by: string } {
    if (this.by === null) {
      // Asked once: the answer waits for all that is being drawn.
      const context = this.renderer?.getContext();
      const extension = context?.getExtension("WEBGL_debug_renderer_info");
      this.by = context && extension ? String(context.getParameter(extension.UNMASKED_RENDERER_WEBGL)) : "";
    }
    return {
      triangles: this.renderer?.info.render.triangles ?? 0,
      calls: this.renderer?.info.render.calls ?? 0,
      by: this.by,
    };
  }
}
