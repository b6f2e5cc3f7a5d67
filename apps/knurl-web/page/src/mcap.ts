// An MCAP file of knurl record, read whole: the reports, column by column.
import { McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";
import { CdrLayout } from "./cdr.ts";
import { History } from "./history.ts";

/** Of a report, beside what History has. */
export interface Recorded {
  history: History;
  /** w x y z, x y z, x y z of each report: orientation, contact point, torque, scene force; then faults, buttons, flags. */
  more: Float32Array;
  metadata: Map<string, string>;
  /** What was in the scenes, in order: texts of knurl.live.v1, at the time of `history`. Older files have none. */
  scenes: { t: number; text: string }[];
  /** Meshes of the scenes, as /asset gives them, by "CLAIM/ASSET". */
  meshes: Map<string, ArrayBuffer>;
  /** Seconds between two reports. */
  period: number;
  /** Lines that a person should see: what was cut off. */
  notes: string[];
}
export const moreColumns = 16;
const piece = 1 << 20;
const mostReports = 20_000_000;

/** "/right/report"; "/knurl/report" up to November 2026. */
const reportTopic = /^\/\w+\/report$/;

function keepMesh(meshes: Map<string, ArrayBuffer>, data: Uint8Array): void {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  if (data.byteLength < 16) throw new Error("a mesh that is shorter than its head");
  meshes.set(`${view.getBigUint64(0, true)}/${view.getUint32(8, true)}`, data.slice(16).buffer);
}

/** Throws Error with one line where it is no recording of ours. */
export async function readRecording(bytes: Uint8Array, between?: (share: number) => Promise<void>): Promise<Recorded> {
  const magic = [0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a];
  if (bytes.length < 8 || magic.some((byte, k) => bytes[k] !== byte)) throw new Error("no MCAP file; open one that knurl record made");
  const reader = new McapStreamReader({
    decompressHandlers: { zstd: (buffer, size) => decompress(buffer, new Uint8Array(Number(size))) },
    validateCrcs: false,
  });
  const metadata = new Map<string, string>();
  const schemas = new Map<number, string>();
  const notes: string[] = [];
  const scenes: { ns: number; text: string }[] = [];
  const meshes = new Map<string, ArrayBuffer>();
  const offset = (): number => Number(metadata.get("realtime_offset_ns") ?? 0);
  let channel = -1;
  let sceneChannel = -1;
  let meshChannel = -1;
  let layout: CdrLayout | null = null;
  let read: ((view: DataView) => number)[] = [];
  let readMore: ((view: DataView) => number)[] = [];
  let readNs = (_view: DataView): number => 0;
  let deadlineNs = readNs;
  let writeNs = readNs;
  let first = 0;
  let count = 0;
  const blocks: { t: Float64Array; rows: Float32Array }[] = [];
  const width = 13 + moreColumns;
  let block = { t: new Float64Array(4096), rows: new Float32Array(4096 * width) };
  let used = 0;

  const take = (data: Uint8Array): void => {
    if (!layout) return;
    if (data.byteLength !== layout.size + 4) throw new Error("a message has the wrong length: the file was changed");
    const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    const ns = readNs(view);
    if (count === 0) first = ns;
    if (used === 4096) {
      blocks.push(block);
      block = { t: new Float64Array(4096), rows: new Float32Array(4096 * width) };
      used = 0;
    }
    block.t[used] = (ns - first) * 1e-9;
    const at = used * width;
    for (let k = 0; k < 9; k++) block.rows[at + k] = read[k](view);
    block.rows[at + 9] = (ns - deadlineNs(view)) * 1e-3;
    block.rows[at + 10] = (writeNs(view) - deadlineNs(view)) * 1e-3;
    const sx = read[9](view);
    const sy = read[10](view);
    const sz = read[11](view);
    block.rows[at + 11] = Math.hypot(sx, sy, sz);
    block.rows[at + 12] = read[12](view);
    for (let k = 0; k < moreColumns; k++) block.rows[at + 13 + k] = readMore[k](view);
    used++;
    if (++count > mostReports) throw new Error(`more than ${mostReports} reports; cut it with knurl replay`);
  };

  let broken = "";
  for (let at = 0; at < bytes.length && broken === ""; at += piece) {
    reader.append(bytes.subarray(at, Math.min(at + piece, bytes.length)));
    try {
      for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
        if (record.type === "Metadata" && record.name === "knurl") for (const [key, value] of record.metadata) metadata.set(key, value);
        else if (record.type === "Schema") schemas.set(record.id, new TextDecoder().decode(record.data));
        else if (record.type === "Channel" && record.topic === "/knurl/scene") sceneChannel = record.id;
        else if (record.type === "Channel" && record.topic === "/knurl/mesh") meshChannel = record.id;
        else if (record.type === "Channel" && channel < 0 && reportTopic.test(record.topic)) {
          channel = record.id;
          layout = new CdrLayout(schemas.get(record.schemaId) ?? "");
          const of = (name: string) => ["x", "y", "z"].map((axis) => layout!.reader(`${name}.${axis}`));
          read = [...of("position"), ...of("velocity"), ...of("sent_force"), ...of("scene_force"), layout.reader("state")];
          readMore = [
            ...["w", "x", "y", "z"].map((axis) => layout!.reader(`orientation.${axis}`)),
            ...of("contact_point"), ...of("sent_torque"), ...of("scene_force"),
            layout.reader("faults"), layout.reader("buttons"), layout.reader("flags"),
          ];
          readNs = layout.reader("read_ns");
          deadlineNs = layout.reader("deadline_ns");
          writeNs = layout.reader("write_ns");
        } else if (record.type === "Message" && record.channelId === channel) take(record.data);
        else if (record.type === "Message" && record.channelId === sceneChannel) scenes.push({ ns: Number(record.logTime) - offset(), text: new TextDecoder().decode(record.data) });
        else if (record.type === "Message" && record.channelId === meshChannel) keepMesh(meshes, record.data);
      }
    } catch (error) {
      broken = error instanceof Error ? error.message.split("\n")[0] : String(error);
    }
    await between?.(Math.min(1, (at + piece) / bytes.length));
  }
  if (channel < 0) throw new Error(broken || "an MCAP file, but none that knurl record made (it has no channel /DEVICE/report)");
  if (count === 0) throw new Error(broken || (reader.done() ? "a recording without a report" : "cut off before the first reports were complete"));
  if (broken) notes.push(`used up to a damaged place: ${broken}`);
  else if (!reader.done()) notes.push("the file was cut off; what is complete is shown");
  blocks.push(block);

  const history = new History(count);
  const more = new Float32Array(count * moreColumns);
  for (let k = 0; k < count; k++) {
    const from = blocks[k >> 12];
    const row = k & 4095;
    history.t[k] = from.t[row];
    const at = row * width;
    let c = 0;
    for (const column of Object.values(history.columns)) column[k] = from.rows[at + c++];
    more.set(from.rows.subarray(at + 13, at + 13 + moreColumns), k * moreColumns);
  }
  history.count = count;
  const rate = Number(metadata.get("rate")) || (count > 1 ? (count - 1) / (history.last || 1) : 1000);
  return { history, more, metadata, scenes: scenes.map(({ ns, text }) => ({ t: (ns - first) * 1e-9, text })), meshes, period: 1 / rate, notes };
}
