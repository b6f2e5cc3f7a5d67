// The same as client.py by Foxglove's own client and readers (npm: @foxglove/ws-protocol, ws, @foxglove/rosmsg,
// @foxglove/rosmsg2-serialization), found by NODE_PATH. Ends with 77 where they are not there.
let FoxgloveClient, WebSocket, parse, MessageReader;
try {
  ({ FoxgloveClient } = require("@foxglove/ws-protocol"));
  ({ WebSocket } = require("ws"));
  ({ parse } = require("@foxglove/rosmsg"));
  ({ MessageReader } = require("@foxglove/rosmsg2-serialization"));
} catch (error) {
  console.error(`Foxglove's client is not there: ${error.message.split("\n")[0]}`);
  process.exit(77);
}

const [host, port, subprotocol, enough, path] = process.argv.slice(2);
const socket = new WebSocket(`ws://${host}:${port}${path ?? "/"}`, [subprotocol]);
const client = new FoxgloveClient({ ws: socket });
const fail = (what) => { console.error(what); process.exit(1); };
const plain = (value) => {
  if (typeof value === "bigint") return Number(value);
  if (ArrayBuffer.isView(value)) return Array.from(value, plain);
  if (Array.isArray(value)) return value.map(plain);
  if (value === null || typeof value !== "object") return value;
  return Object.fromEntries(Object.entries(value).map(([key, inner]) => [key === "nsec" ? "nanosec" : key, plain(inner)]));
};

let info;
const statuses = [], channels = new Map(), topics = new Map(), messages = {};
client.on("error", (error) => fail(String(error)));
client.on("close", () => fail("closed"));
client.on("serverInfo", (event) => { info = event; });
client.on("status", (event) => statuses.push(event));
client.on("advertise", (advertised) => {
  for (const channel of advertised) {
    channels.set(channel.id, channel);
    const reader = channel.encoding === "json" ? undefined : new MessageReader(parse(channel.schema, { ros2: true }));
    const decode = (data) => reader ? reader.readMessage(data) : JSON.parse(new TextDecoder().decode(data));
    messages[channel.topic] = [];
    topics.set(client.subscribe(channel.id), { topic: channel.topic, decode });
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const { topic, decode } = topics.get(subscriptionId);
  messages[topic].push([String(timestamp), plain(decode(data))]);
  const slow = /(scene|parameters|diagnostics)$/;
  if (channels.size < 10) return;
  if (Object.entries(messages).some(([name, seen]) => seen.length < (slow.test(name) ? 1 : Number(enough)))) return;
  const schemas = Object.fromEntries([...channels.values()].map((channel) => [channel.topic, channel.schemaName]));
  process.stdout.write(JSON.stringify({ subprotocol: socket.protocol, info, statuses, messages, schemas }), () => process.exit(0));
});
