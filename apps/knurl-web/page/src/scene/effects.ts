// Effects: springs, magnets, constraints, fields as arrows on a grid, and what acts wherever the hand is.
import { type BufferAttribute, BufferGeometry, Group, LineSegments, Mesh, OctahedronGeometry, SphereGeometry, Vector3 } from "three";
import { type Drawing, type Paint, type Surroundings, across, arrowLines, direction, lines, pointsGeometry, real, replace, up, vector } from "./drawing.ts";
import { Patch } from "./planes.ts";
import { type Params, num } from "../protocol.ts";

/** A coil from (0, 0, 0) to (0, 0, 1). */
function coil(turns: number, radius: number): number[] {
  const out: number[] = [];
  const n = turns * 10;
  const at = (k: number) => {
    const share = k / n;
    const width = radius * Math.min(1, 8 * share, 8 * (1 - share));
    return [width * Math.cos((2 * Math.PI * k) / 10), width * Math.sin((2 * Math.PI * k) / 10), share];
  };
  for (let k = 0; k < n; k++) out.push(...at(k), ...at(k + 1));
  return out;
}

export function spring(paint: Paint): Drawing {
  const root = new Group();
  const anchor = new Mesh(new SphereGeometry(1, 16, 12), paint.face);
  paint.face.userData.opacity = 0.9;
  const wire = lines(coil(9, 1), paint.line);
  wire.frustumCulled = false;
  root.add(anchor, wire);
  const end = new Vector3();
  const d = new Vector3();
  const follow = (around: Surroundings) => {
    d.subVectors(around.hand, end);
    const length = d.length();
    wire.visible = length > 1e-5;
    wire.position.copy(end);
    if (wire.visible) wire.quaternion.setFromUnitVectors(up, d.divideScalar(length));
    const width = 0.03 * around.radius;
    wire.scale.set(width, width, Math.max(1e-6, length));
  };
  return {
    root,
    update(params, around) {
      end.copy(vector(params, "anchor"));
      anchor.position.copy(end);
      anchor.scale.setScalar(0.03 * around.radius);
      follow(around);
    },
    tick: follow,
  };
}

export function magnet(paint: Paint): Drawing {
  const root = new Group();
  const core = new Mesh(new SphereGeometry(1, 24, 16), paint.face);
  const reach = lines(rings(), paint.thin);
  const pull = lines([0, 0, 0, 0, 0, 1], paint.line);
  pull.frustumCulled = false;
  root.add(core, reach, pull);
  const centre = new Vector3();
  let outer = 0;
  const follow = (around: Surroundings) => {
    const d = new Vector3().subVectors(around.hand, centre);
    const length = d.length();
    pull.visible = length > 1e-6 && length < outer;
    if (!pull.visible) return;
    pull.quaternion.setFromUnitVectors(up, d.divideScalar(length));
    pull.scale.set(1, 1, length);
    pull.position.copy(centre);
  };
  return {
    root,
    update(params, around) {
      centre.copy(vector(params, "position"));
      const radius = real(params, "radius");
      outer = radius + real(params, "max_distance", 0.02);
      core.position.copy(centre);
      core.scale.setScalar(Math.max(radius, 0.02 * around.radius));
      reach.position.copy(centre);
      reach.scale.setScalar(outer);
      follow(around);
    },
    tick: follow,
  };
}
function rings(): number[] {
  const out: number[] = [];
  for (let k = 0; k < 60; k += 2) {
    const [a, b] = [(2 * Math.PI * k) / 60, (2 * Math.PI * (k + 1)) / 60];
    const [c, s, d, t] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b)];
    out.push(c, s, 0, d, t, 0, c, 0, s, d, 0, t, 0, c, s, 0, d, t);
  }
  return out;
}

export function constraint(paint: Paint): Drawing {
  const root = new Group();
  const mark = new Mesh(new OctahedronGeometry(1), paint.face);
  paint.face.userData.opacity = 0.35;
  const patch = new Patch(paint);
  const line = lines([0, 0, -1, 0, 0, 1], paint.line);
  const link = lines([0, 0, 0, 0, 0, 1], paint.line);
  line.frustumCulled = link.frustumCulled = false;
  root.add(mark, patch.root, line, link);
  const origin = new Vector3();
  const u = new Vector3();
  let form = "point";
  const follow = (around: Surroundings) => {
    const d = new Vector3().subVectors(around.hand, origin);
    const along = d.dot(u);
    const foot = form === "point" ? origin.clone() : form === "line" ? origin.clone().addScaledVector(u, along) : around.hand.clone().addScaledVector(u, -along);
    const off = new Vector3().subVectors(around.hand, foot);
    const length = off.length();
    link.visible = length > 1e-6;
    link.position.copy(foot);
    if (link.visible) link.quaternion.setFromUnitVectors(up, off.divideScalar(length));
    link.scale.set(1, 1, Math.max(1e-6, length));
    mark.position.copy(foot);
    if (form === "plane") patch.follow(around);
  };
  return {
    root,
    update(params, around) {
      form = String(params.shape ?? "point");
      origin.copy(vector(params, "origin"));
      u.copy(direction(params, "direction"));
      mark.scale.setScalar(0.025 * around.radius);
      patch.root.visible = form === "plane";
      line.visible = form === "line";
      line.position.copy(origin);
      line.quaternion.setFromUnitVectors(up, u);
      line.scale.set(1, 1, 2 * around.radius);
      if (form === "plane") patch.place(u, origin.dot(u));
      follow(around);
    },
    tick: follow,
  };
}

/** Arrows of a force on a grid of `count`^3 places within `reach` of a centre; as long as the cells where the force is `most`. */
function arrows(centre: Vector3, reach: number, count: number, most: number, force: (p: Vector3) => Vector3): BufferGeometry {
  const out: number[] = [];
  const step = count > 1 ? (2 * reach) / (count - 1) : 0;
  for (let i = 0; i < count; i++)
    for (let j = 0; j < count; j++)
      for (let k = 0; k < count; k++) {
        const d = new Vector3(i * step - reach, j * step - reach, k * step - reach);
        if (count === 1) d.set(0, 0, 0);
        if (d.length() > reach * 1.01) continue;
        const p = d.add(centre);
        const f = force(p);
        const size = f.length();
        if (size < 1e-6 * most) continue;
        // Weak forces stay visible.
        arrowLines(out, p, f.multiplyScalar((0.85 * (step || reach) * Math.min(1, Math.sqrt(size / most))) / size));
      }
  return pointsGeometry(out);
}

/** Smooth from 1 at 0.8 to 0 at 1. */
function fade(x: number): number {
  const s = Math.min(1, Math.max(0, (1 - x) / 0.2));
  return s * s * (3 - 2 * s);
}

export function taylor(paint: Paint): Drawing {
  const root = new Group();
  const field = new LineSegments(new BufferGeometry(), paint.line);
  const rim = lines(rings(), paint.thin);
  root.add(field, rim);
  return {
    root,
    update(params, around) {
      const origin = vector(params, "origin");
      const f0 = vector(params, "force");
      const flat = (params.jacobian as number[] | undefined)?.flat().map((x) => num(x)) ?? [];
      const size = flat.length === 36 ? 6 : 3;
      const radius = real(params, "radius", 0.05);
      const reach = Math.min(radius, 1.2 * around.radius);
      const hold = params.edge === "hold";
      const force = (p: Vector3) => {
        const d = new Vector3().subVectors(p, origin);
        const r = d.length();
        const j = (row: number) => (flat[row * size] ?? 0) * d.x + (flat[row * size + 1] ?? 0) * d.y + (flat[row * size + 2] ?? 0) * d.z;
        const f = new Vector3(f0.x + j(0), f0.y + j(1), f0.z + j(2));
        return hold ? f : f.multiplyScalar(fade(r / radius) || (r < radius ? 0.02 : 0));
      };
      let most = 1e-9;
      for (let k = 0; k < 27; k++) {
        const d = new Vector3((k % 3) - 1, (Math.floor(k / 3) % 3) - 1, Math.floor(k / 9) - 1).multiplyScalar(0.45 * reach);
        most = Math.max(most, force(d.add(origin)).length());
      }
      replace(field, arrows(origin, reach, 6, most, force));
      rim.position.copy(origin);
      rim.scale.setScalar(reach);
    },
  };
}

/** The same force everywhere. */
function everywhere(paint: Paint, force: (params: Params) => Vector3): Drawing {
  const root = new Group();
  const field = new LineSegments(new BufferGeometry(), paint.line);
  root.add(field);
  return {
    root,
    update(params, around) {
      const f = force(params);
      replace(field, arrows(around.centre, around.radius, 4, around.peakForce, () => f.clone()));
    },
  };
}
export const constantForce = (paint: Paint): Drawing => everywhere(paint, (params) => vector(params, "force"));
export const gravity = (paint: Paint): Drawing =>
  everywhere(paint, (params) => vector(params, "acceleration", [0, 0, -9.81]).multiplyScalar(real(params, "mass")));

/** A haze of points around the hand, and what it takes from the motion. */
export function viscosity(paint: Paint): Drawing {
  const root = new Group();
  const haze = lines(drops(), paint.line);
  const drag = lines(new Float32Array(18), paint.line); // one arrow
  drag.frustumCulled = false;
  root.add(haze, drag);
  let damping = 0;
  const place = (around: Surroundings) => {
    haze.position.copy(around.hand);
    haze.scale.setScalar(0.3 * around.radius);
    const out: number[] = [];
    arrowLines(out, around.hand, around.velocity.clone().multiplyScalar((-damping * around.radius) / around.peakForce));
    const position = drag.geometry.getAttribute("position") as BufferAttribute;
    drag.visible = out.length > 0;
    position.array.set(out);
    position.needsUpdate = true;
  };
  return {
    root,
    update(params, around) {
      damping = real(params, "damping");
      paint.line.userData.opacity = 0.25 + 0.5 * Math.min(1, damping / 10);
      place(around);
    },
    tick: place,
  };
}
function drops(): number[] {
  const out: number[] = [];
  for (let k = 0; k < 120; k++) {
    // Evenly over the ball (golden angle).
    const z = 1 - (2 * (k + 0.5)) / 120;
    const a = k * 2.39996;
    const r = Math.cbrt(((k * 37) % 120) / 120) ;
    const w = Math.sqrt(1 - z * z);
    const p = [w * Math.cos(a) * r, w * Math.sin(a) * r, z * r];
    out.push(...p, p[0] + 0.03, p[1], p[2]);
  }
  return out;
}

/** A wave along its direction, at the hand. */
export function vibration(paint: Paint): Drawing {
  const root = new Group();
  const points: number[] = [];
  for (let k = 0; k < 64; k++) {
    const at = (q: number) => [0.12 * Math.sin((q / 64) * 8 * Math.PI) * (1 - Math.abs((2 * q) / 64 - 1)), 0, q / 32 - 1];
    points.push(...at(k), ...at(k + 1));
  }
  const wave = lines(points, paint.line);
  wave.frustumCulled = false;
  root.add(wave);
  const u = new Vector3();
  let amplitude = 0;
  const place = (around: Surroundings) => {
    const size = 0.4 * around.radius * Math.min(1, Math.sqrt(amplitude / around.peakForce) + 0.2);
    wave.position.copy(around.hand);
    wave.scale.set(size * (1 + 0.3 * Math.sin(around.time * 20)), size, size);
  };
  return {
    root,
    update(params, around) {
      u.copy(direction(params, "direction"));
      const [a, b] = across(u);
      wave.quaternion.setFromRotationMatrix(wave.matrix.makeBasis(a, b, u));
      amplitude = real(params, "amplitude");
      wave.visible = amplitude > 0;
      place(around);
    },
    tick: place,
  };
}
