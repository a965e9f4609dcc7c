// paths.mjs LAYOUT.json FILE.mcap: whether each message path of a viewer's layout leads somewhere in the file, as read by
// @mcap/core: its topic is there, its schema describes every step, and some message has a value. And that the layout is whole:
// each panel that it arranges is described, and none besides. Prints what is missing; exit code 1 where something is.
import { readFileSync } from 'node:fs';
import { McapIndexedReader } from '@mcap/core';

const [layoutFile, file] = process.argv.slice(2);
const layout = JSON.parse(readFileSync(layoutFile, 'utf8')), bytes = readFileSync(file);
let failed = 0;
const fail = (text) => { failed++; console.log(text); };

const arranged = [];
const walk = (node) => {
  if (typeof node === 'string') return arranged.push(node);
  if (!['row', 'column'].includes(node.direction)) fail(`a split without a direction: ${JSON.stringify(node)}`);
  walk(node.first), walk(node.second);
};
walk(layout.layout);
if (arranged.sort().join() !== Object.keys(layout.configById).sort().join()) fail(`panels arranged: ${arranged}; described: ${Object.keys(layout.configById)}`);

const paths = Object.values(layout.configById).flatMap((panel) => [...(panel.paths ?? []).map((path) => path.value), ...(panel.topicPath ? [panel.topicPath] : [])]);
if (paths.length < 5) fail('hardly any paths');

const reader = await McapIndexedReader.Initialize({
  readable: { size: async () => BigInt(bytes.length), read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))) },
});
const schemas = new Map(), seen = new Map(paths.map((path) => [path, 0]));
for (const channel of reader.channelsById.values())
  schemas.set(channel.topic, JSON.parse(new TextDecoder().decode(reader.schemasById.get(channel.schemaId).data)));
const split = (path) => { const [topic, ...fields] = path.split('.'); return { topic, fields }; };
for (const path of paths) {
  const { topic, fields } = split(path);
  if (!schemas.has(topic)) { fail(`${path}: no such topic; there are ${[...schemas.keys()].sort().join(' ')}`); continue; }
  let schema = schemas.get(topic);
  for (const field of fields) if (!(schema = schema?.properties?.[field])) { fail(`${path}: ${field} is not in the schema`); break; }
}
for await (const message of reader.readMessages()) {
  const { topic } = reader.channelsById.get(message.channelId), value = JSON.parse(new TextDecoder().decode(message.data));
  for (const path of paths) {
    const { topic: wanted, fields } = split(path);
    if (wanted === topic && fields.reduce((at, field) => at?.[field], value) !== undefined) seen.set(path, seen.get(path) + 1);
  }
}
for (const [path, count] of seen) if (count === 0) fail(`${path}: no message has it`);
console.log(`${paths.length} paths, ${[...seen.values()].reduce((a, b) => a + b, 0)} values`);
process.exit(failed ? 1 : 0);
