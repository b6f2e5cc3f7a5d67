// What a drawer of a kind of representation gives and gets. Everything is drawn in the world of its claim: the group of the claim
// carries it to the device's frame.
import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  Object3D,
  Quaternion,
  Vector3,
} from "three";
import { type Params, num, vec } from "../protocol.ts";

/** What a drawer may know besides the parameters. */
export interface Surroundings {
  /** The hand's tip and its velocity in the claim's world. */
  hand: Vector3;
  velocity: Vector3;
  /** Radius and middle of the workspace in the claim's world (m). */
  radius: number;
  centre: Vector3;
  /** The strongest force of the device (N). */
  peakForce: number;
  /** Seconds that the page runs, for what oscillates. */
  time: number;
  /** The mesh of an asset; null while it is not there. */
  asset(number: number, smooth: boolean): BufferGeometry | null;
}

export interface Drawing {
  root: Object3D;
  /** After each change of the parameters. */
  update(params: Params, around: Surroundings): void;
  /** Each frame; for what follows the hand. */
  tick?(around: Surroundings): void;
}

/** The materials of one drawing, which its mood changes together. */
export class Paint {
  readonly face: MeshLambertMaterial;
  readonly line: LineBasicMaterial;
  /** Of what only says how far something reaches. */
  readonly thin: LineBasicMaterial;
  constructor(
    colour: number,
    opacity: number,
    private readonly shift = 0,
  ) {
    this.face = new MeshLambertMaterial({ color: colour, transparent: true, opacity, side: DoubleSide, forceSinglePass: true, depthWrite: opacity > 0.8 });
    this.line = new LineBasicMaterial({ color: colour, transparent: true, opacity: Math.min(1, opacity + 0.35) });
    this.thin = new LineBasicMaterial({ color: colour, transparent: true, opacity: 0.3 });
    this.thin.userData.opacity = 0.3;
    this.face.userData.opacity = opacity;
    this.line.userData.opacity = this.line.opacity;
  }
  set(colour: number, share: number): void {
    for (const material of [this.face, this.line, this.thin]) {
      // Things of one claim differ a little, so that they can be told apart where they overlap.
      material.color.setHex(colour).offsetHSL(this.shift * 0.05, 0, this.shift * 0.1);
      material.opacity = (material.userData.opacity as number) * share;
    }
  }
  solid(flat: boolean): void {
    this.face.flatShading = flat;
    this.face.userData.opacity = 0.92;
    this.face.depthWrite = true;
    this.face.needsUpdate = true;
  }
}

export const up = new Vector3(0, 0, 1);

export function vector(params: Params, name: string, fallback: [number, number, number] = [0, 0, 0]): Vector3 {
  return new Vector3(...vec(params[name], fallback));
}
export function real(params: Params, name: string, fallback = 0): number {
  return num(params[name], fallback);
}
export function direction(params: Params, name: string, fallback: [number, number, number] = [0, 0, 1]): Vector3 {
  const v = vector(params, name, fallback);
  return v.lengthSq() > 1e-18 ? v.normalize() : new Vector3(...fallback);
}
export function quaternion(params: Params, name: string): Quaternion {
  const q = params[name];
  if (!Array.isArray(q) || q.length !== 4) return new Quaternion();
  const [w, x, y, z] = (q as number[]).map((part) => num(part));
  const turned = new Quaternion(x, y, z, w);
  return turned.lengthSq() > 1e-12 ? turned.normalize() : new Quaternion();
}
/** Turns z into n. */
export function zTo(n: Vector3): Quaternion {
  return new Quaternion().setFromUnitVectors(up, n);
}
/** Two directions across n. */
export function across(n: Vector3): [Vector3, Vector3] {
  const u = Math.abs(n.z) < 0.9 ? new Vector3(0, 0, 1) : new Vector3(1, 0, 0);
  u.crossVectors(u, n).normalize();
  return [u, new Vector3().crossVectors(n, u)];
}
export function lines(points: number[] | Float32Array, material: LineBasicMaterial): LineSegments {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points instanceof Float32Array ? points : new Float32Array(points), 3));
  return new LineSegments(geometry, material);
}
export function replace(object: Mesh | LineSegments, geometry: BufferGeometry): void {
  object.geometry.dispose();
  object.geometry = geometry;
}
export function pointsGeometry(points: number[]): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
  return geometry;
}

/** Appends an arrow of lines. */
export function arrowLines(out: number[], from: Vector3, along: Vector3): void {
  const length = along.length();
  if (!(length > 1e-9)) return;
  const to = from.clone().add(along);
  const [u] = across(along.clone().normalize());
  const back = along.clone().multiplyScalar(-0.28);
  const side = u.multiplyScalar(length * 0.12);
  const a = to.clone().add(back).add(side);
  const b = to.clone().add(back).sub(side);
  for (const [p, q] of [[from, to], [to, a], [to, b]] as const) out.push(p.x, p.y, p.z, q.x, q.y, q.z);
}

/** Frees what an object holds on the graphics card; assets are shared and stay. */
export function dispose(root: Object3D): void {
  root.traverse((object) => {
    const mesh = object as Mesh;
    if (mesh.geometry && !mesh.geometry.userData.shared) mesh.geometry.dispose();
    const material = mesh.material;
    if (material && !Array.isArray(material)) material.dispose();
  });
}
