// compare.mjs LOG.mcap LOG.csv RUN.csv: reads the file with @mcap/core, every CRC checked, and compares each message
// with the row of the CSV that it is of. Prints what differs; exit code 1 where something does.
import { readFileSync } from 'node:fs';
import { McapIndexedReader, McapStreamReader } from '@mcap/core';

const [file, log, run] = process.argv.slice(2);
const bytes = readFileSync(file);
let failed = 0;
const fail = (text) => {
  if (++failed < 20) console.log(text);
};

// RFC 4180.
function rows(text) {
  const all = [[]];
  let at = 0;
  while (at < text.length) {
    let cell = '';
    if (text[at] === '"') {
      for (at++; ; at++) {
        if (text[at] === '"' && text[at + 1] !== '"') break;
        if (text[at] === '"') at++;
        cell += text[at];
      }
      at++;
    } else while (at < text.length && !',\r\n'.includes(text[at])) cell += text[at++];
    all.at(-1).push(cell);
    if (text[at] === ',') { at++; continue; }
    if (text[at] === '\r') at++;
    if (text[at] === '\n') { at++; if (at < text.length) all.push([]); }
  }
  const names = all.shift();
  return all.map((cells) => Object.fromEntries(names.map((name, i) => [name, cells[i]])));
}

// The stream, in the order of the file.
const reader = new McapStreamReader({ validateCrcs: true });
reader.append(new Uint8Array(bytes));
const streamed = [];
for (let record; (record = reader.nextRecord()); ) if (record.type === 'Message') streamed.push(record);
if (!reader.done()) fail('the stream does not end');

// By summary and index, in the order of time.
const indexed = await McapIndexedReader.Initialize({
  readable: { size: async () => BigInt(bytes.length), read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))) },
});
const channels = indexed.channelsById, schemas = indexed.schemasById;
const messages = new Map();
let before = 0n, count = 0;
for await (const message of indexed.readMessages()) {
  count++;
  if (message.logTime < before) fail('not in the order of time');
  before = message.logTime;
  const channel = channels.get(message.channelId);
  const schema = schemas.get(channel.schemaId);
  if (channel.messageEncoding !== 'json' || schema.encoding !== 'jsonschema') fail(`${channel.topic}: not described JSON`);
  const described = JSON.parse(new TextDecoder().decode(schema.data));
  const value = JSON.parse(new TextDecoder().decode(message.data));
  for (const name of Object.keys(value)) if (!described.properties[name]) fail(`${channel.topic}: ${name} is not in its schema`);
  for (const name of Object.keys(value.values ?? {}))
    if (!described.properties.values.properties[name]) fail(`${channel.topic}: values.${name} is not in its schema`);
  const key = channel.topic === '/run' ? `run ${message.sequence}` : `log ${value.record}`;
  if (messages.has(key)) fail(`twice: ${key}`);
  messages.set(key, { value, time: message.logTime, topic: channel.topic });
}
if (count !== streamed.length || BigInt(count) !== indexed.statistics.messageCount) fail(`counts: ${count}, ${streamed.length}, ${indexed.statistics.messageCount}`);

let compared = 0;
for (const row of rows(readFileSync(log, 'utf8'))) {
  const message = messages.get(`log ${row.record}`);
  if (!message) { fail(`record ${row.record} is missing`); continue; }
  const { value } = message;
  for (const name of ['record', 'utc_ns', 'mono_us', 'source', 'kind', 'body', 'previous', 'hash'])
    if (String(value[name]) !== row[name]) fail(`record ${row.record}: ${name} is ${value[name]}, not ${row[name]}`);
  if (String(message.time) !== row.utc_ns) fail(`record ${row.record}: at ${message.time}`);
  if (message.topic !== `/log/${row.kind.replaceAll(' ', '_')}`) fail(`record ${row.record}: topic ${message.topic}`);
  compared++;
}
if (run) {
  const table = rows(readFileSync(run, 'utf8'));
  table.forEach((row, i) => {
    const message = messages.get(`run ${i}`);
    if (!message) return fail(`row ${i} of the run is missing`);
    for (const [name, cell] of Object.entries(row)) {
      const value = message.value[name];
      if (typeof value === 'number' ? value !== Number(cell) : value !== cell) fail(`row ${i}: ${name} is ${value}, not ${cell}`);
    }
    compared++;
  });
}
if (compared !== count) fail(`${count} messages, ${compared} rows`);
console.log(`${count} messages on ${channels.size} topics compared`);
process.exit(failed ? 1 : 0);
