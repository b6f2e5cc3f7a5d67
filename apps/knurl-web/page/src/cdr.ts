// CDR, little endian, by a ros2msg schema: reads where each field of a message is, once, and then the fields.

interface Place {
  offset: number;
  type: string;
  count: number;
}
const sizes: Record<string, number> = {
  bool: 1, byte: 1, char: 1, int8: 1, uint8: 1, int16: 2, uint16: 2, int32: 4, uint32: 4, int64: 8, uint64: 8, float32: 4, float64: 8,
};

/** Fields of a fixed size by name ("position.x", "joints"); throws Error where the schema has others before them. */
export class CdrLayout {
  readonly places = new Map<string, Place>();
  readonly size: number;
  constructor(schema: string) {
    const parts = schema.split(/^=+$/m);
    const types = new Map<string, string>();
    for (const part of parts.slice(1)) {
      const head = /^\s*MSG:\s*(\S+)\s*$/m.exec(part);
      if (head) types.set(head[1], part.slice(part.indexOf(head[0]) + head[0].length));
    }
    this.size = this.walk(parts[0], types, "", 0, 0);
  }
  private walk(text: string, types: Map<string, string>, prefix: string, at: number, depth: number): number {
    if (depth > 8) throw new Error("a schema that contains itself");
    for (const raw of text.split("\n")) {
      const line = raw.replace(/#.*/, "").trim();
      if (line === "" || line.includes("=")) continue;
      const match = /^([A-Za-z0-9_/]+)(?:\[(\d+)\])?\s+(\w+)$/.exec(line);
      if (!match) throw new Error(`a schema with the line "${line}", which this page does not read`);
      const [, type, many, name] = match;
      const size = sizes[type];
      if (size) {
        at += (size - (at % size)) % size;
        this.places.set(prefix + name, { offset: at, type, count: many ? Number(many) : 1 });
        at += size * (many ? Number(many) : 1);
        continue;
      }
      const inner = types.get(type) ?? [...types].find(([key]) => key.endsWith("/" + type))?.[1];
      if (inner === undefined || many) throw new Error(`a schema with the type ${type}, which this page does not read`);
      at = this.walk(inner, types, `${prefix}${name}.`, at, depth + 1);
    }
    return at;
  }
  /** Reads one number of a message (with its head of four bytes). */
  reader(name: string, element = 0): (view: DataView) => number {
    const place = this.places.get(name);
    if (!place || element >= place.count) throw new Error(`a report without ${name}`);
    const at = 4 + place.offset + element * sizes[place.type];
    switch (place.type) {
      case "float64":
        return (view) => view.getFloat64(at, true);
      case "float32":
        return (view) => view.getFloat32(at, true);
      case "int64":
        return (view) => Number(view.getBigInt64(at, true));
      case "uint64":
        return (view) => Number(view.getBigUint64(at, true));
      case "uint32":
        return (view) => view.getUint32(at, true);
      case "int32":
        return (view) => view.getInt32(at, true);
      default:
        return (view) => view.getUint8(at);
    }
  }
}
