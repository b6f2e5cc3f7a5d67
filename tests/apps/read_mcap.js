// Reads a recording with MCAP's own reader (npm: @mcap/core, with fzstd to decompress), both found by NODE_PATH.
const fs = require("fs");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { decompress } = require("fzstd");

const data = fs.readFileSync(process.argv[2]);
const decompressHandlers = { zstd: (packed) => decompress(packed) };
const readable = {
  size: async () => BigInt(data.length),
  read: async (at, n) => new Uint8Array(data.subarray(Number(at), Number(at + n))),
};

(async () => {
  // Front to back, every checksum; then by the index, as a program that seeks does.
  const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  stream.append(data);
  let streamed = 0, ended = false;
  const attachments = {};
  for (let record; (record = stream.nextRecord()); ) {
    if (record.type === "Message") ++streamed;
    if (record.type === "Attachment") attachments[record.name] = record.data.length;
    if (record.type === "Footer") ended = true;
  }
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const topics = {};
  let lastCycle = 0n;
  for await (const message of reader.readMessages({ topics: [...reader.channelsById.values()].map(({ topic }) => topic).filter((topic) => topic.endsWith("/report")) })) {
    const view = new DataView(message.data.buffer, message.data.byteOffset);
    lastCycle = view.getBigUint64(4, true);
  }
  for (const [id, count] of reader.statistics.channelMessageCounts) topics[reader.channelsById.get(id).topic] = Number(count);
  console.log(JSON.stringify({ library: reader.header.library, ended, streamed, topics, attachments, lastCycle: Number(lastCycle) }));
})();
