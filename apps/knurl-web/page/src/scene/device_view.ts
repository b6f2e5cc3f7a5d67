// One device: workspace, arm, hand, probes, contact, arrows, trail, and the claims with what they have added. In the device's frame.
import {
  BufferAttribute,
  BufferGeometry,
  ConeGeometry,
  CylinderGeometry,
  DynamicDrawUsage,
  Group,
  Line,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  Object3D,
  Quaternion,
  SphereGeometry,
  TorusGeometry,
  Vector3,
} from "three";
import { type Device, type SeenItem, itemKey, mood } from "../model.ts";
import { type Claim, type DeviceFrame } from "../protocol.ts";
import { heat, palette } from "../theme.ts";
import { Batch } from "./batch.ts";
import { Paint, type Drawing, type Surroundings, dispose, lines } from "./drawing.ts";
import { draw } from "./drawers.ts";
import { moved } from "./solids.ts";

const heats = new Float32Array(Array.from({ length: 256 }, (_, k) => heat(k / 255)).flat());
const trailPoints = 800;
const trailSeconds = 4;

interface Drawn {
  item: SeenItem;
  drawing: Drawing;
  paint: Paint;
  version: number;
  look: string;
  /** performance.now() of the last change. */
  changed: number;
}
/** ms for which a thing has to stand still to be drawn together with others, and fewer than so many are not worth it. */
const calm = 700;
const fewest = 12;
interface ClaimGroup {
  root: Group;
  probes: Mesh[];
  claim: Claim;
}

export type Assets = (device: number, claim: number, number: number, smooth: boolean) => BufferGeometry | null;

export class DeviceView {
  readonly root = new Group();
  readonly hand: Mesh;
  private readonly ring: Mesh;
  private readonly contact: Mesh;
  private readonly proxy: LineSegments;
  private readonly force = new Arrow();
  private readonly sceneForce = new Arrow();
  private readonly torque = new Group();
  private readonly pull: LineSegments;
  private readonly arm = new Group();
  private readonly armLine: Line;
  private readonly workspace: LineSegments;
  private readonly floor: LineSegments;
  readonly trail: Line;
  private readonly axes: LineSegments;
  private readonly claims = new Map<number, ClaimGroup>();
  private readonly drawn = new Map<string, Drawn>();
  private seen = -1;
  private readonly batch = new Batch();
  private batched = "";
  private nextBatch = 0;
  private place = new Vector3();
  target: Vector3 | null = null;
  private trailCount = -1;
  private trailCursor = -1;

  constructor(
    readonly device: Device,
    private readonly assets: Assets,
  ) {
    const { i, radius, centre } = device.info;
    const named = <T extends Object3D>(object: T, name: string): T => {
      object.name = `${name}:${i}`;
      return object;
    };
    named(this.root, "device");
    this.root.add(this.batch.root);
    this.hand = named(new Mesh(new SphereGeometry(0.028 * radius, 24, 16), new MeshLambertMaterial()), "hand");
    this.ring = named(new Mesh(new TorusGeometry(0.05 * radius, 0.004 * radius, 8, 32), new MeshLambertMaterial()), "orientation");
    this.contact = named(new Mesh(new SphereGeometry(0.02 * radius, 16, 12), new MeshLambertMaterial()), "contact");
    this.proxy = named(lines([0, 0, 0, 0, 0, 1], new LineBasicMaterial()), "proxy");
    this.pull = named(lines([0, 0, 0, 0, 0, 1], new LineBasicMaterial()), "pull");
    this.workspace = named(lines(globe(), new LineBasicMaterial({ transparent: true, opacity: 0.7 })), "workspace");
    this.workspace.position.set(...centre);
    this.workspace.scale.setScalar(radius);
    this.floor = named(lines(floorGrid(), new LineBasicMaterial({ transparent: true, opacity: 0.6 })), "floor");
    this.floor.position.set(centre[0], centre[1], centre[2] - radius);
    this.floor.scale.setScalar(radius);
    named(this.force.root, "force");
    named(this.sceneForce.root, "scene_force");
    named(this.arm, "arm");
    this.armLine = new Line(new BufferGeometry(), new LineBasicMaterial());
    this.arm.add(this.armLine);
    named(this.torque, "torque").add(
      new Mesh(new TorusGeometry(1, 0.04, 8, 32, 4.8), new MeshLambertMaterial()),
      new Mesh(new ConeGeometry(0.14, 0.3, 12), new MeshLambertMaterial()),
    );
    this.torque.children[1].position.set(Math.cos(4.8), Math.sin(4.8), 0);
    this.torque.children[1].rotation.z = 4.8;
    const trail = new BufferGeometry();
    trail.setAttribute("position", new BufferAttribute(new Float32Array(3 * trailPoints), 3).setUsage(DynamicDrawUsage));
    trail.setAttribute("color", new BufferAttribute(new Float32Array(3 * trailPoints), 3).setUsage(DynamicDrawUsage));
    this.trail = named(new Line(trail, new LineBasicMaterial({ vertexColors: true })), "trail");
    this.axes = named(new LineSegments(triad(), new LineBasicMaterial({ vertexColors: true })), "frame");
    this.axes.scale.setScalar(0.2 * radius);
    this.root.add(this.axes);
    for (const object of [this.trail, this.proxy, this.pull, this.armLine]) object.frustumCulled = false;
    this.root.add(this.workspace, this.floor, this.arm, this.trail, this.proxy, this.pull, this.contact, this.force.root, this.sceneForce.root, this.torque, this.ring, this.hand);
    this.colour();
  }

  colour(): void {
    const p = palette();
    (this.hand.material as MeshLambertMaterial).color.setHex(p.hand);
    (this.ring.material as MeshLambertMaterial).color.setHex(p.arm);
    (this.contact.material as MeshLambertMaterial).color.setHex(p.contact);
    (this.proxy.material as LineBasicMaterial).color.setHex(p.contact);
    (this.pull.material as LineBasicMaterial).color.setHex(p.mine);
    (this.workspace.material as LineBasicMaterial).color.setHex(p.workspace);
    (this.floor.material as LineBasicMaterial).color.setHex(p.grid);
    (this.armLine.material as LineBasicMaterial).color.setHex(p.arm);
    this.force.paint(p.force);
    this.sceneForce.paint(p.workspace);
    for (const child of this.torque.children) ((child as Mesh).material as MeshLambertMaterial).color.setHex(p.torque);
    for (const drawn of this.drawn.values()) drawn.look = "";
  }

  private surroundings(claim: Claim, frame: DeviceFrame | null, time: number): Surroundings {
    const { scale, device_centre: dc, world_centre: wc, force_scale: fs } = claim.frame;
    const world = (p: ArrayLike<number>) => new Vector3((p[0] - dc[0]) * scale + wc[0], (p[1] - dc[1]) * scale + wc[1], (p[2] - dc[2]) * scale + wc[2]);
    const info = this.device.info;
    return {
      hand: world(frame?.p ?? info.centre),
      velocity: frame ? new Vector3(...frame.v).multiplyScalar(scale) : new Vector3(),
      centre: world(info.centre),
      radius: info.radius * scale,
      peakForce: (info.peak_force || 8) * (fs || 1),
      time,
      asset: (number, smooth) => this.assets(info.i, claim.claim, number, smooth),
    };
  }

  private groupOf(claim: Claim): ClaimGroup {
    let group = this.claims.get(claim.claim);
    if (!group) {
      group = { root: new Group(), probes: [], claim };
      group.root.name = `claim:${claim.claim}`;
      this.claims.set(claim.claim, group);
      this.root.add(group.root);
    }
    group.claim = claim;
    // A point of the world w lies at (w - world_centre) / scale + device_centre.
    const { scale, device_centre: dc, world_centre: wc } = claim.frame;
    group.root.scale.setScalar(1 / scale);
    // Its own frame, where that is another than the device's.
    const own = scale !== 1 || dc.some((x, k) => x !== wc[k]);
    let axes = group.root.getObjectByName(`frame:${claim.claim}:claim`);
    if (own && !axes) {
      axes = new LineSegments(triad(), new LineBasicMaterial({ vertexColors: true }));
      axes.name = `frame:${claim.claim}:claim`;
      group.root.add(axes);
    }
    if (axes) {
      axes.visible = own;
      axes.scale.setScalar(0.14 * this.device.info.radius * scale);
    }
    group.root.position.set(dc[0] - wc[0] / scale, dc[1] - wc[1] / scale, dc[2] - wc[2] / scale);
    return group;
  }

  private reconcile(): void {
    for (const [key, drawn] of this.drawn) {
      const item = this.device.items.get(key);
      if (item && item.kind === drawn.item.kind && item.generation === drawn.item.generation) {
        drawn.item = item;
        continue;
      }
      drawn.drawing.root.removeFromParent();
      dispose(drawn.drawing.root);
      this.drawn.delete(key);
    }
    for (const [number, group] of this.claims)
      if (!this.device.claims.has(number)) {
        dispose(group.root);
        group.root.removeFromParent();
        this.claims.delete(number);
      }
    for (const claim of this.device.claims.values()) {
      const group = this.groupOf(claim);
      for (const probe of group.probes) {
        dispose(probe);
        probe.removeFromParent();
      }
      group.probes = claim.probes.map(([number, , radius]) => {
        const size = Math.max(radius / claim.frame.scale, 0.012 * this.device.info.radius);
        const probe = new Mesh(new SphereGeometry(size, 16, 12), new MeshLambertMaterial({ transparent: true, opacity: 0.5, color: palette().contact }));
        probe.name = `probe:${claim.claim}:${number}`;
        this.root.add(probe);
        return probe;
      });
    }
    for (const [key, item] of this.device.items) {
      if (this.drawn.has(key)) continue;
      const claim = this.device.claims.get(item.claim);
      if (!claim) continue; // it comes with its claim
      const surface = !["spring", "constant_force", "taylor", "taylor6", "viscosity", "gravity", "magnet", "constraint", "vibration"].includes(item.kind);
      const paint = new Paint(0xffffff, surface ? 0.45 : 0.5, 2 * ((item.slot * 0.618) % 1) - 1);
      if (["plane", "half_plane"].includes(item.kind)) paint.face.userData.opacity = 0.16;
      const drawing = draw(item.kind, paint);
      drawing.root.name = `item:${item.claim}:${item.slot}`;
      drawing.root.userData.item = key;
      this.groupOf(claim).root.add(drawing.root);
      this.drawn.set(key, { item, drawing, paint, version: -1, look: "", changed: performance.now() });
    }
  }

  /** `frame`: what is shown; of a recording, that at the cursor. */
  update(frame: DeviceFrame | null, until: number, time: number, chosen: boolean, silent: (claim: Claim) => boolean): void {
    const gone = this.device.version !== this.seen;
    if (gone) {
      this.reconcile();
      this.seen = this.device.version;
    }
    (this.workspace.material as LineBasicMaterial).opacity = chosen ? 0.8 : 0.35;
    const colours = palette();
    const info = this.device.info;
    const around = new Map<number, Surroundings>();
    for (const claim of this.device.claims.values()) around.set(claim.claim, this.surroundings(claim, frame, time));
    const now = performance.now();
    let looks = false;
    let moves = false;
    for (const drawn of this.drawn.values()) {
      const { item, drawing, paint } = drawn;
      const where = around.get(item.claim);
      const claim = this.device.claims.get(item.claim);
      if (!where || !claim) continue;
      if (drawn.version !== item.version) {
        drawing.update(item.params, where);
        drawn.version = item.version;
        drawn.look = "";
        drawn.changed = now;
        moves = true;
      } else drawing.tick?.(where);
      if (item.params.velocity && Number.isFinite(item.since)) {
        const by = moved(item.params, (now - item.since) / 1000);
        if (by) {
          drawing.update(item.params, where);
          drawing.root.position.add(by);
          drawn.changed = now;
          moves = true;
        }
      }
      const now_ = mood(item, silent(claim));
      const look = `${now_} ${claim.mine} ${drawing.root.children.length}`;
      if (look === drawn.look) continue;
      drawn.look = look;
      looks = true;
      const colour = claim.mine ? colours.mine : colours.claims[claim.row % colours.claims.length];
      paint.set(now_ === "asleep" ? colours.asleep : colour, now_ === "faded" ? 0.25 : now_ === "asleep" ? 0.5 : now_ === "touched" ? 1.7 : 1);
      drawing.root.userData.mood = now_;
    }
    if (looks) this.batch.colour();
    this.gather(now, moves || gone);
    for (const object of [this.hand, this.ring, this.force.root, this.sceneForce.root, this.arm]) object.visible = frame !== null;
    this.contact.visible = this.proxy.visible = this.torque.visible = this.pull.visible = false;
    this.updateTrail(until);
    if (!frame) return;
    this.place.set(...frame.p);
    this.hand.position.copy(this.place);
    this.ring.position.copy(this.place);
    this.ring.quaternion.copy(turned(frame));
    this.ring.visible = info.senses_orientation;
    for (const group of this.claims.values())
      group.claim.probes.forEach(([, offset], k) =>
        group.probes[k].position
          .set(...offset)
          .divideScalar(group.claim.frame.scale)
          .applyQuaternion(turned(frame))
          .add(this.place),
      );
    const touching = frame.flags.includes("touching");
    if (touching) {
      this.contact.visible = true;
      this.contact.position.set(...frame.contact);
      join(this.proxy, this.place, this.contact.position);
    }
    // The strongest force is as long as the workspace is wide.
    const length = (2 * info.radius) / (info.peak_force || 8);
    this.force.point(this.place, frame.force, length, 0.012 * info.radius);
    this.sceneForce.point(this.place, frame.scene_force, length, 0.006 * info.radius);
    // Where the supervisor takes nothing away both are one.
    if (Math.hypot(...frame.scene_force.map((f, k) => f - frame.force[k])) < 0.02 * (info.peak_force || 8)) this.sceneForce.root.visible = false;
    const torque = Math.hypot(...frame.torque);
    this.torque.visible = torque > 1e-3;
    if (this.torque.visible) {
      this.torque.position.copy(this.place);
      this.torque.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...frame.torque).divideScalar(torque));
      this.torque.scale.setScalar(info.radius * 0.25 * Math.min(1, 0.3 + torque / (info.peak_torque || 0.2)));
    }
    this.updateArm(frame);
    if (this.target) join(this.pull, this.place, this.target);
  }

  /** What has stood still for a while is drawn together. */
  private gather(now: number, changed: boolean): void {
    if (!changed && now < this.nextBatch) return;
    this.nextBatch = now + calm;
    const still = [...this.drawn].filter(([, drawn]) => !drawn.drawing.tick && drawn.item.kind !== "shape" && now - drawn.changed > calm);
    const wanted = still.length < fewest ? [] : still;
    const key = wanted.map(([name, drawn]) => `${name}:${drawn.item.generation}:${drawn.version}`).join();
    if (key === this.batched) return;
    this.batched = key;
    this.batch.take(wanted.map(([, drawn]) => drawn.drawing.root), this.root);
  }

  private updateArm(frame: DeviceFrame): void {
    const points = frame.arm ?? [];
    this.arm.visible = points.length > 1;
    if (!this.arm.visible) return;
    const geometry = this.armLine.geometry;
    const there = geometry.getAttribute("position") as BufferAttribute | undefined;
    if (!there || there.count !== points.length) {
      this.armLine.geometry.dispose();
      this.armLine.geometry = new BufferGeometry();
      this.armLine.geometry.setAttribute("position", new BufferAttribute(new Float32Array(points.length * 3), 3));
      for (const joint of this.arm.children.slice(1)) {
        dispose(joint);
        joint.removeFromParent();
      }
      for (let k = 0; k < points.length; k++) {
        this.arm.add(new Mesh(new SphereGeometry(0.022 * this.device.info.radius, 12, 8), new MeshLambertMaterial({ color: palette().arm })));
        if (k > 0) {
          const link = new Mesh(new ConeGeometry(0.022 * this.device.info.radius, 1, 10).translate(0, 0.5, 0), new MeshLambertMaterial({ color: palette().arm, transparent: true, opacity: 0.55 }));
          link.userData.link = k;
          this.arm.add(link);
        }
      }
    }
    const attribute = this.armLine.geometry.getAttribute("position") as BufferAttribute;
    points.forEach((point, k) => attribute.setXYZ(k, ...point));
    attribute.needsUpdate = true;
    let k = 0;
    for (const child of this.arm.children.slice(1)) {
      const link = child.userData.link as number | undefined;
      if (link === undefined) child.position.set(...points[k++]);
      else {
        const from = new Vector3(...points[link - 1]);
        const along = new Vector3(...points[link]).sub(from);
        const length = along.length();
        child.visible = length > 1e-6;
        child.position.copy(from);
        child.scale.set(1, Math.max(length, 1e-6), 1);
        if (child.visible) child.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), along.divideScalar(length));
      }
    }
  }

  private updateTrail(until: number): void {
    const history = this.device.history;
    if (history.count === this.trailCount && until === this.trailCursor) return;
    this.trailCount = history.count;
    this.trailCursor = until;
    const from = history.find(until - trailSeconds);
    const to = Math.min(history.held, history.find(until + 1e-6));
    const stride = Math.max(1, Math.ceil((to - from) / trailPoints));
    const position = this.trail.geometry.getAttribute("position") as BufferAttribute;
    const colour = this.trail.geometry.getAttribute("color") as BufferAttribute;
    const c = history.columns;
    const peak = this.device.info.peak_force || 8;
    let n = 0;
    // Places stand still as time goes on.
    const first = from + ((stride - ((history.count - history.held + from) % stride)) % stride);
    for (let k = first; k < to && n < trailPoints; k += stride) {
      const place = history.place(k);
      position.setXYZ(n, c.px[place], c.py[place], c.pz[place]);
      const at = 3 * Math.min(255, Math.round((255 * Math.sqrt(c.fx[place] ** 2 + c.fy[place] ** 2 + c.fz[place] ** 2)) / peak));
      colour.setXYZ(n, heats[at], heats[at + 1], heats[at + 2]);
      n++;
    }
    position.needsUpdate = colour.needsUpdate = true;
    this.trail.geometry.setDrawRange(0, n);
  }

  /** How many representations are drawn. */
  get count(): number {
    return this.drawn.size;
  }
  drawnItem(key: string): Drawn | undefined {
    return this.drawn.get(key);
  }
  key(item: SeenItem): string {
    return itemKey(item.claim, item.slot);
  }
  dispose(): void {
    this.root.removeFromParent();
    dispose(this.root);
  }
}

function turned(frame: DeviceFrame): Quaternion {
  return new Quaternion(frame.q[1], frame.q[2], frame.q[3], frame.q[0]).normalize();
}
function join(line: LineSegments, from: Vector3, to: Vector3): void {
  const d = new Vector3().subVectors(to, from);
  const length = d.length();
  line.visible = length > 1e-6;
  if (!line.visible) return;
  line.position.copy(from);
  line.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), d.divideScalar(length));
  line.scale.set(1, 1, length);
}
/** A shaft and a head along a force. */
class Arrow {
  readonly root = new Group();
  private readonly material = new MeshLambertMaterial();
  private readonly shaft = new Mesh(new CylinderGeometry(1, 1, 1, 10).translate(0, 0.5, 0).rotateX(Math.PI / 2), this.material);
  private readonly head = new Mesh(new ConeGeometry(2.6, 1, 14).translate(0, -0.5, 0).rotateX(Math.PI / 2), this.material);
  constructor() {
    this.root.add(this.shaft, this.head);
  }
  paint(colour: number): void {
    this.material.color.setHex(colour);
  }
  point(at: Vector3, force: ArrayLike<number>, scale: number, width: number): void {
    const f = new Vector3(force[0], force[1], force[2]);
    const size = f.length();
    this.root.visible = size > 5e-3;
    if (!this.root.visible) return;
    const length = size * scale;
    const head = Math.min(0.6 * length, 7 * width);
    this.root.position.copy(at);
    this.root.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), f.divideScalar(size));
    this.shaft.scale.set(width, width, Math.max(1e-9, length - head));
    this.head.position.z = length;
    this.head.scale.set(width, width, head);
  }
}

/** Axes in their colours: x red, y green, z blue. */
function triad(): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array([0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1]), 3));
  geometry.setAttribute("color", new BufferAttribute(new Float32Array([1, 0.3, 0.25, 1, 0.3, 0.25, 0.3, 0.75, 0.35, 0.3, 0.75, 0.35, 0.3, 0.55, 1, 0.3, 0.55, 1]), 3));
  return geometry;
}

/** Three circles and two parallels of a ball. */
function globe(): number[] {
  const out: number[] = [];
  const n = 72;
  for (let k = 0; k < n; k++) {
    const [a, b] = [(2 * Math.PI * k) / n, (2 * Math.PI * (k + 1)) / n];
    const [c, s, d, t] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b)];
    out.push(c, s, 0, d, t, 0, c, 0, s, d, 0, t, 0, c, s, 0, d, t);
  }
  return out;
}
function floorGrid(): number[] {
  const out: number[] = [];
  for (let k = -5; k <= 5; k++) out.push(k / 5, -1, 0, k / 5, 1, 0, -1, k / 5, 0, 1, k / 5, 0);
  return out;
}
