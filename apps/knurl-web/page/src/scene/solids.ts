// Boxes and round solids, solid or hollow, and shapes made of an asset.
import {
  BoxGeometry,
  BufferGeometry,
  CapsuleGeometry,
  CylinderGeometry,
  EdgesGeometry,
  Group,
  LineSegments,
  Mesh,
  OctahedronGeometry,
  SphereGeometry,
  TorusGeometry,
  Vector3,
} from "three";
import { type Drawing, type Paint, type Surroundings, direction, lines, quaternion, real, replace, vector, zTo } from "./drawing.ts";
import type { Params } from "../protocol.ts";

/** One geometry that is placed; hollows show their edges, and their walls thinner. */
function solid(paint: Paint, form: (params: Params, around: Surroundings) => BufferGeometry, place: (root: Group, params: Params) => void, edge = 30): Drawing {
  const root = new Group();
  const face = new Mesh(new BufferGeometry(), paint.face);
  const rim = new LineSegments(new BufferGeometry(), paint.line);
  root.add(face, rim);
  return {
    root,
    update(params, around) {
      const geometry = form(params, around);
      replace(face, geometry);
      replace(rim, new EdgesGeometry(geometry, edge));
      const hollow = params.side === "inside";
      paint.face.userData.opacity = hollow ? 0.1 : 0.45;
      place(root, params);
    },
  };
}
const least = 2e-4; // m: thinner things are drawn as thick as this

export const box = (paint: Paint): Drawing =>
  solid(
    paint,
    (params) => {
      const half = vector(params, "half_size", [0.05, 0.05, 0.05]);
      return new BoxGeometry(Math.max(least, 2 * half.x), Math.max(least, 2 * half.y), Math.max(least, 2 * half.z));
    },
    (root, params) => {
      root.position.copy(vector(params, "center"));
      root.quaternion.copy(quaternion(params, "orientation"));
    },
    1,
  );

/** Three great circles of a sphere, for the eye. */
function circles(radius: number): number[] {
  const out: number[] = [];
  const n = 48;
  for (let k = 0; k < n; k++) {
    const [a, b] = [(2 * Math.PI * k) / n, (2 * Math.PI * (k + 1)) / n];
    const [c, s, d, t] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b)].map((x) => x * radius);
    out.push(c, s, 0, d, t, 0, c, 0, s, d, 0, t, 0, c, s, 0, d, t);
  }
  return out;
}

export function sphere(paint: Paint): Drawing {
  const root = new Group();
  const face = new Mesh(new SphereGeometry(1, 32, 20), paint.face);
  const rim = lines(circles(1), paint.line);
  root.add(face, rim);
  return {
    root,
    update(params) {
      const hollow = params.side === "inside";
      paint.face.userData.opacity = hollow ? 0.1 : 0.45;
      root.position.copy(vector(params, "center"));
      root.scale.setScalar(Math.max(least, real(params, "radius", 0.01)));
    },
  };
}

const along = (root: Group, params: Params): void => {
  root.position.copy(vector(params, "center"));
  root.quaternion.copy(zTo(direction(params, "axis")));
};
export const capsule = (paint: Paint): Drawing =>
  solid(
    paint,
    (params) => new CapsuleGeometry(Math.max(least, real(params, "radius", 0.01)), 2 * real(params, "half_length", 0.02), 8, 20).rotateX(Math.PI / 2),
    along,
  );
export const cylinder = (paint: Paint): Drawing =>
  solid(
    paint,
    (params, around) => {
      const half = real(params, "half_length", 0.02);
      const radius = Math.max(least, real(params, "radius", 0.01));
      return new CylinderGeometry(radius, radius, Number.isFinite(half) ? Math.max(least, 2 * half) : 4 * around.radius, 32, 1, !Number.isFinite(half)).rotateX(Math.PI / 2);
    },
    along,
  );
export const torus = (paint: Paint): Drawing =>
  solid(paint, (params) => new TorusGeometry(real(params, "radius", 0.02), Math.max(least, real(params, "tube", 0.005)), 16, 48), along, 80);

export function shape(paint: Paint): Drawing {
  const root = new Group();
  const marker = new Mesh(new OctahedronGeometry(1), paint.face);
  root.add(marker);
  const face = new Mesh(new BufferGeometry(), paint.face);
  face.name = "asset";
  let number = 0;
  let smooth = false;
  let there = false;
  const look = (around: Surroundings) => {
    if (there) return;
    const geometry = around.asset(number, smooth);
    if (!geometry) return;
    there = true;
    face.geometry = geometry;
    root.remove(marker);
    root.add(face);
    paint.solid(!smooth);
  };
  return {
    root,
    update(params, around) {
      const asked = real(params, "asset");
      const shading = params.shading === "smooth";
      if (asked !== number || shading !== smooth) {
        there = false;
        root.remove(face);
        root.add(marker);
      }
      number = asked;
      smooth = shading;
      marker.scale.setScalar(0.03 * around.radius);
      root.position.copy(vector(params, "position"));
      root.quaternion.copy(quaternion(params, "orientation"));
      look(around);
    },
    tick: look,
  };
}

/** A surface that moves by itself between two updates goes on from where the last one put it. */
export function moved(params: Params, seconds: number): Vector3 | null {
  const v = vector(params, "velocity");
  return v.lengthSq() > 0 ? v.multiplyScalar(seconds) : null;
}
