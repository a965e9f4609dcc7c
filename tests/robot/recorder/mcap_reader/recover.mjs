// recover.mjs FILE [LENGTH ...]: what @mcap/core finds in the first LENGTH bytes of a file, or in all of it, as in one whose
// writer was killed. Prints a line of JSON for each: messages, topics, time of the last message, and the numbers `n` of
// messages {"n": N} where they are not 0, 1, 2 ...
import { readFileSync } from 'node:fs';
import { McapStreamReader } from '@mcap/core';

const [file, ...lengths] = process.argv.slice(2);
const bytes = new Uint8Array(readFileSync(file));
for (const length of lengths.length ? lengths.map(Number) : [bytes.length]) {
  const reader = new McapStreamReader({ validateCrcs: true });
  reader.append(bytes.slice(0, length));
  const topics = new Map(), schemas = new Map(), counts = {}, disorder = [];
  let messages = 0, last = 0n;
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === 'Schema') schemas.set(record.id, JSON.parse(new TextDecoder().decode(record.data)));
    if (record.type === 'Channel') topics.set(record.id, record);
    if (record.type !== 'Message') continue;
    const channel = topics.get(record.channelId), value = JSON.parse(new TextDecoder().decode(record.data));
    for (const name of Object.keys(value)) if (!schemas.get(channel.schemaId).properties[name]) disorder.push(`${channel.topic}.${name}`);
    if ('n' in value && value.n !== messages) disorder.push(value.n);
    counts[channel.topic] = (counts[channel.topic] ?? 0) + 1;
    if (record.logTime > last) last = record.logTime;
    messages++;
  }
  console.log(JSON.stringify({ messages, counts, last: String(last), disorder, whole: reader.done() }));
}
