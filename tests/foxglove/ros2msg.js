// The same as ros2msg.py by Foxglove's own readers (npm: @foxglove/rosmsg, @foxglove/rosmsg2-serialization), found by NODE_PATH; and
// each definition of ROS is that of Humble (@foxglove/rosmsg-msgs-common). Ends with 77 where they are not there.
const fs = require("fs");
let parse, MessageReader, humble;
try {
  ({ parse } = require("@foxglove/rosmsg"));
  ({ MessageReader } = require("@foxglove/rosmsg2-serialization"));
  ({ ros2humble: humble } = require("@foxglove/rosmsg-msgs-common"));
} catch (error) {
  console.error(`Foxglove's readers are not there: ${error.message.split("\n")[0]}`);
  process.exit(77);
}

// As ros2msg.py prints it: ROS's names of a time, numbers for what JSON has not.
const plain = (value) => {
  if (typeof value === "bigint") return Number(value);
  if (ArrayBuffer.isView(value)) return Array.from(value, plain);
  if (Array.isArray(value)) return value.map(plain);
  if (value === null || typeof value !== "object") return value;
  const out = {};
  for (const [key, inner] of Object.entries(value)) out[key === "nsec" ? "nanosec" : key] = plain(inner);
  return out;
};
const members = (definition) => definition.definitions
  .filter((field) => !field.isConstant)
  .map(({ name, type, isArray, arrayLength }) => [name, type.replace("/msg/", "/"), !!isArray, arrayLength ?? null].join(" "));

const out = [];
for (const { name, schema, hex } of JSON.parse(fs.readFileSync(process.argv[2], "utf8"))) {
  const definitions = parse(schema, { ros2: true });
  for (const definition of definitions) {
    const known = (definition.name ?? name).replace("/msg/", "/");
    const official = humble[known] ?? humble[known.replace("/", "/msg/")];
    if (official === undefined) {
      if (!known.startsWith("knurl_msgs/") && known !== "builtin_interfaces/Time" && known !== "builtin_interfaces/Duration")
        throw new Error(`${known}: not a type of ROS`);
    } else if (members(definition).join() !== members(official).join()) {
      throw new Error(`${known}: has ${members(definition)}, ROS has ${members(official)}`);
    }
  }
  out.push(plain(new MessageReader(definitions).readMessage(Buffer.from(hex, "hex"))));
}
console.log(JSON.stringify(out));
