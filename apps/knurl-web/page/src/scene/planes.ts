// Planes as patches at the hand, half-planes and polygons as what they are, caps as the curved patch that they describe.
import { BufferAttribute, BufferGeometry, Group, LineSegments, Mesh, Quaternion, Vector3 } from "three";
import { type Drawing, type Paint, type Surroundings, across, direction, lines, pointsGeometry, real, replace, vector } from "./drawing.ts";
import { num, vec } from "../protocol.ts";

const cells = 8;

/** A square of `cells` by `cells`, and its grid, 1 by 1, z up. */
function square(): BufferGeometry {
  const geometry = pointsGeometry([-0.5, -0.5, 0, 0.5, -0.5, 0, 0.5, 0.5, 0, -0.5, 0.5, 0]);
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  geometry.computeVertexNormals();
  return geometry;
}
function grid(): number[] {
  const out: number[] = [];
  for (let k = 0; k <= cells; k++) {
    const at = k / cells - 0.5;
    out.push(at, -0.5, 0, at, 0.5, 0, -0.5, at, 0, 0.5, at, 0);
  }
  out.push(0, 0, 0, 0, 0, 0.14, 0, 0, 0.14, 0.025, 0, 0.1, 0, 0, 0.14, -0.025, 0, 0.1);
  return out;
}

/** A patch of a plane that goes along with the hand; its grid stands still in the world. */
export class Patch {
  readonly root = new Group();
  private normal = new Vector3(0, 0, 1);
  private offset = 0;
  private u = new Vector3(1, 0, 0);
  private v = new Vector3(0, 1, 0);
  constructor(paint: Paint) {
    this.root.add(new Mesh(square(), paint.face), lines(grid(), paint.line));
  }
  place(normal: Vector3, offset: number): void {
    this.normal.copy(normal);
    this.offset = offset;
    [this.u, this.v] = across(normal);
    this.root.quaternion.setFromRotationMatrix(this.root.matrix.makeBasis(this.u, this.v, this.normal));
  }
  follow(around: Surroundings): void {
    const size = 0.9 * around.radius;
    const step = size / cells;
    const snap = (x: number) => Math.round(x / step) * step;
    this.root.scale.setScalar(size);
    this.root.position
      .set(0, 0, 0)
      .addScaledVector(this.u, snap(around.hand.dot(this.u)))
      .addScaledVector(this.v, snap(around.hand.dot(this.v)))
      .addScaledVector(this.normal, this.offset);
  }
}

export function plane(paint: Paint): Drawing {
  const patch = new Patch(paint);
  return {
    root: patch.root,
    update(params, around) {
      // A length other than 1 divides the offset too.
      const n = vector(params, "normal", [0, 0, 1]);
      const length = n.length() || 1;
      patch.place(n.divideScalar(length), real(params, "offset") / length);
      patch.follow(around);
    },
    tick: (around) => patch.follow(around),
  };
}

export function halfPlane(paint: Paint): Drawing {
  const root = new Group();
  const face = new Mesh(square(), paint.face);
  const frame = lines(grid(), paint.line);
  const rim = lines([0.5, -0.5, 0, 0.5, 0.5, 0], paint.line);
  root.add(face, frame, rim);
  let n = new Vector3(0, 0, 1);
  let e = new Vector3(1, 0, 0);
  let along = new Vector3(0, 1, 0);
  let offset = 0;
  let edge = 0;
  const follow = (around: Surroundings) => {
    const size = 0.9 * around.radius;
    root.scale.setScalar(size);
    // The patch ends where the face does.
    const at = Math.min(edge - size / 2, around.hand.dot(e));
    root.position.set(0, 0, 0).addScaledVector(n, offset).addScaledVector(e, at).addScaledVector(along, around.hand.dot(along));
  };
  return {
    root,
    update(params, around) {
      n = vector(params, "normal", [0, 0, 1]);
      const length = n.length() || 1;
      n.divideScalar(length);
      offset = real(params, "offset") / length;
      const out = vector(params, "edge", [1, 0, 0]);
      const outLength = out.length() || 1;
      out.divideScalar(outLength);
      // In the face: e . x <= (edge_offset - (out . n) offset) / |out across n|
      const tilt = out.dot(n);
      e = out.clone().addScaledVector(n, -tilt);
      const left = e.length() || 1;
      e.divideScalar(left);
      edge = (real(params, "edge_offset") / outLength - tilt * offset) / left;
      along = new Vector3().crossVectors(n, e);
      root.quaternion.setFromRotationMatrix(root.matrix.makeBasis(e, along, n));
      follow(around);
    },
    tick: follow,
  };
}

export function polygon(paint: Paint): Drawing {
  const root = new Group();
  const face = new Mesh(new BufferGeometry(), paint.face);
  const outline = lines([], paint.line);
  root.add(face, outline);
  return {
    root,
    update(params) {
      const corners = (Array.isArray(params.vertices) ? (params.vertices as number[][]) : []).map((corner) => vec(corner));
      const geometry = pointsGeometry(corners.flat());
      const faces: number[] = [];
      for (let k = 2; k < corners.length; k++) faces.push(0, k - 1, k);
      geometry.setIndex(faces);
      geometry.computeVertexNormals();
      replace(face, geometry);
      replace(outline, pointsGeometry(corners.flatMap((corner, k) => [...corner, ...corners[(k + 1) % corners.length]])));
    },
  };
}

/** Height of an osculating arc of curvature c at x, with its tangent beyond the rim. */
export function arc(c: number, x: number, reach: number): number {
  const r = Math.abs(x);
  if (Math.abs(c) < 1e-9) return 0;
  const at = (q: number) => (1 - Math.sqrt(Math.max(0, 1 - c * c * q * q))) / c;
  if (r <= reach) return at(r);
  const slope = (c * reach) / Math.sqrt(Math.max(1e-9, 1 - c * c * reach * reach));
  return at(reach) + slope * (r - reach);
}

export function cap(paint: Paint): Drawing {
  const root = new Group();
  const face = new Mesh(new BufferGeometry(), paint.face);
  const mesh = new LineSegments(new BufferGeometry(), paint.line);
  root.add(face, mesh);
  const n = 20;
  return {
    root,
    update(params, around) {
      const normal = direction(params, "normal");
      const axis = vector(params, "axis");
      const c1 = real(params, "curvature");
      axis.addScaledVector(normal, -axis.dot(normal));
      const two = axis.lengthSq() > 1e-18;
      const c2 = two ? real(params, "curvature2") : c1;
      const u = two ? axis.normalize() : across(normal)[0];
      const v = new Vector3().crossVectors(normal, u);
      root.position.copy(vector(params, "foot"));
      root.quaternion.copy(new Quaternion().setFromRotationMatrix(root.matrix.makeBasis(u, v, normal)));
      const strong = Math.max(Math.abs(c1), Math.abs(c2));
      const rim = Math.min(0.5, num(params.rim, 0.15));
      const reach = strong > 1e-9 ? rim / strong : Infinity;
      const size = Math.min(0.35 * around.radius, Math.max(3 * reach, 0.08 * around.radius));
      const points: number[] = [];
      for (let j = 0; j <= n; j++)
        for (let i = 0; i <= n; i++) {
          const x = (2 * i) / n - 1;
          const y = (2 * j) / n - 1;
          // A disc rather than a square.
          const px = size * x * Math.sqrt(1 - (y * y) / 2);
          const py = size * y * Math.sqrt(1 - (x * x) / 2);
          const height = two ? arc(c1, px, reach) + arc(c2, py, reach) : arc(c1, Math.hypot(px, py), reach);
          points.push(px, py, height);
        }
      const faces: number[] = [];
      const wires: number[] = [];
      const point = (i: number, j: number) => j * (n + 1) + i;
      for (let j = 0; j <= n; j++)
        for (let i = 0; i <= n; i++) {
          if (i < n && j < n) faces.push(point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j), point(i + 1, j + 1), point(i, j + 1));
          if (i < n && j % 5 === 0) wires.push(point(i, j), point(i + 1, j));
          if (j < n && i % 5 === 0) wires.push(point(i, j), point(i, j + 1));
        }
      const geometry = pointsGeometry(points);
      geometry.setIndex(faces);
      geometry.computeVertexNormals();
      replace(face, geometry);
      const wire = new BufferGeometry();
      wire.setAttribute("position", new BufferAttribute(new Float32Array(wires.flatMap((k) => points.slice(3 * k, 3 * k + 3))), 3));
      replace(mesh, wire);
    },
  };
}
