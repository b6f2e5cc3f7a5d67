// knurl.live.v1 (runtime/gateway/README.md): its messages as types, and the binary one decoded.

export type Vec = [number, number, number];
export type Quat = [number, number, number, number]; // w x y z
export type Role = "observe" | "render" | "control";
/** Of a parameter; "inf", "-inf", "automatic" are texts. */
export type Value = number | string | number[] | number[][];
export type Params = Record<string, Value>;

export interface Field {
  name: string;
  type: "real" | "vector" | "choice" | "integer" | "quaternion" | "matrix" | "points";
  unit: string;
  meaning: string;
  minimum: number | string;
  maximum: number | string;
  default: Value;
  choices?: string[];
  count?: number;
  /** Infinity is legal besides the range. */
  infinity?: boolean;
  /** The value "automatic" is legal. */
  automatic?: boolean;
}
export interface Kind {
  name: string;
  surface: boolean;
  fields: Field[];
}
export interface Hello {
  op: "hello";
  version: string;
  role: Role;
  kinds: Kind[];
  simulated: boolean;
  recordings: string;
}
export interface DeviceInfo {
  i: number;
  name: string;
  address: string;
  profile: string;
  serial: string;
  rate: number;
  centre: Vec;
  radius: number;
  peak_force: number;
  peak_torque: number;
  max_stiffness: number | string;
  damping: number;
  lag: number;
  renders_torque: boolean;
  senses_orientation: boolean;
  pull: boolean;
}
export interface Servo {
  op: "servo";
  connected: boolean;
  name: string;
  pid: number;
  trouble: string;
  devices: DeviceInfo[];
}
export interface DeviceFrame {
  i: number;
  cycle: number;
  t: number;
  state: string | number;
  faults: string[];
  p: Vec;
  q: Quat;
  v: Vec;
  w: Vec;
  scene_force: Vec;
  force: Vec;
  torque: Vec;
  contact: Vec;
  buttons: number;
  flags: string[];
  late: number;
  arm: Vec[];
  gap: number;
}
export interface ClaimFrame {
  scale: number;
  device_centre: Vec;
  world_centre: Vec;
  force_scale: number;
}
export interface Claim {
  claim: number;
  row: number;
  pid: number;
  name: string;
  mine: boolean;
  frame: ClaimFrame;
  probes: [number, Vec, number][];
}
export interface Item {
  claim: number;
  slot: number;
  generation: number;
  kind: string;
  params: Params;
  probe: number;
}
export interface SceneMessage {
  op: "scene";
  device: number;
  full: boolean;
  claims: Claim[];
  items: Item[];
  gone: number[][];
}
/** In recordings only: what `frame` has of the arm. */
export interface ArmMessage {
  op: "arm";
  device: number;
  points: Vec[];
}
export type Felt = [number, number, number, number, number, number, number, number, number];
export interface Client {
  row: number;
  pid: number;
  name: string;
  observer: boolean;
  armed: boolean;
  silent: boolean;
  shed: boolean;
  gain: number;
  rate: number;
  age: number | null;
  commits: number;
  refused: number;
  merged: number;
  missed: number;
  representations: Record<string, number>;
  scales: { contacts: number; effects: number; damping: number };
}
export interface DeviceStatus {
  i: number;
  /** Path of the file that is being recorded; null: none. */
  recording?: string | null;
  rate: number;
  late: number;
  overruns: number;
  busy: number;
  step: number;
  parts: Record<string, number>;
  late_median: number;
  late_max: number;
  counters: Record<string, number>;
  clients: Client[];
}
export interface Answer {
  op: "answer";
  id: number;
  ok: boolean;
  error?: string;
  [key: string]: unknown;
}
/** What became of a mesh that was sent. */
export interface AssetMessage {
  op: "asset";
  device: number;
  name: string;
  ok: boolean;
  error?: string;
  asset?: number;
  triangles?: number;
  faces?: number;
  low?: Vec;
  high?: Vec;
  notes?: string[] | string;
}
export type Message =
  | AssetMessage
  | Hello
  | Servo
  | { op: "frame"; t: number; devices: DeviceFrame[] }
  | SceneMessage
  | { op: "felt"; device: number; items: Felt[] }
  | { op: "status"; devices: DeviceStatus[] }
  | Answer
  | { op: "note"; level: "info" | "warning" | "error"; text: string };

/** Flags of `felt`. */
export const felt = { touching: 1, clamped: 2, infeasible: 4, fading: 8, silent: 16, asleep: 32 };

/** States by number, as in a report (runtime/protocol, DeviceState). */
export const states = ["disconnected", "idle", "armed", "ramp up", "active", "ramp down", "fault"];

/** Name of a state that came as a number or with underscores. */
export function stateName(state: string | number): string {
  return typeof state === "number" ? (states[state] ?? `state ${state}`) : state.replaceAll("_", " ");
}

/** Float32 per report in a binary message 1. */
export const columns = 14;
export interface Reports {
  device: number;
  count: number;
  t: number;
  data: Float32Array;
}

/** A binary message; throws Error with one line where it is none of ours. */
export function decodeBinary(bytes: ArrayBuffer): Reports {
  if (bytes.byteLength < 24) throw new Error(`a binary message of ${bytes.byteLength} bytes, shorter than its head`);
  const view = new DataView(bytes);
  const kind = view.getUint32(0, true);
  if (kind !== 1) throw new Error(`a binary message of kind ${kind}, which this page does not know`);
  const count = view.getUint32(8, true);
  if (bytes.byteLength !== 24 + count * columns * 4)
    throw new Error(`a binary message says ${count} reports and has ${bytes.byteLength - 24} bytes for them`);
  return { device: view.getUint32(4, true), count, t: view.getFloat64(16, true), data: new Float32Array(bytes, 24) };
}

/** A parameter as a number: "inf" and "-inf" are infinite, "automatic" is not a number. */
export function num(value: unknown, fallback = 0): number {
  if (typeof value === "number") return value;
  if (value === "inf") return Infinity;
  if (value === "-inf") return -Infinity;
  return fallback;
}
export function vec(value: unknown, fallback: Vec = [0, 0, 0]): Vec {
  return Array.isArray(value) && value.length >= 3 ? [num(value[0]), num(value[1]), num(value[2])] : fallback;
}

/** A mesh as /asset gives it. */
export function decodeAsset(bytes: ArrayBuffer): { positions: Float32Array; indices: Uint32Array } {
  if (bytes.byteLength < 8) throw new Error("a mesh that is shorter than its head");
  const view = new DataView(bytes);
  const vertices = view.getUint32(0, true);
  const triangles = view.getUint32(4, true);
  if (bytes.byteLength !== 8 + 12 * vertices + 12 * triangles)
    throw new Error(`a mesh says ${vertices} vertices and ${triangles} triangles and has ${bytes.byteLength} bytes`);
  const indices = new Uint32Array(bytes, 8 + 12 * vertices, 3 * triangles);
  for (const index of indices) if (index >= vertices) throw new Error(`a mesh names vertex ${index} of ${vertices}`);
  return { positions: new Float32Array(bytes, 8, 3 * vertices), indices };
}
