#include "robot/recorder/mcap_writer.hpp"

#include <zlib.h>

#include <algorithm>
#include <utility>

namespace biopsy::recorder {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunk_bytes = 1'048'576;

enum class Op : std::uint8_t {
  Header = 0x01,
  Footer = 0x02,
  Schema = 0x03,
  Channel = 0x04,
  Message = 0x05,
  Chunk = 0x06,
  MessageIndex = 0x07,
  ChunkIndex = 0x08,
  Statistics = 0x0B,
  SummaryOffset = 0x0E,
  DataEnd = 0x0F,
};

// Little-endian integers, texts with their length before them.
class Content {
 public:
  Content& integer(std::uint64_t value, int bytes) {
    for (int n = 0; n < bytes; ++n) text += static_cast<char>(value >> (8 * n));
    return *this;
  }
  Content& string(std::string_view value) { return integer(value.size(), 4).raw(value); }
  Content& raw(std::string_view value) {
    text += value;
    return *this;
  }
  std::string text;
};

void append(std::string& to, Op op, const Content& content) {
  to += Content().integer(static_cast<std::uint8_t>(op), 1).integer(content.text.size(), 8).text;
  to += content.text;
}

std::uint32_t crc(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

Content map_of(const std::map<std::uint16_t, std::uint64_t>& values) {
  Content entries;
  for (const auto& [key, value] : values) entries.integer(key, 2).integer(value, 8);
  return Content().string(entries.text);
}

}  // namespace

McapWriter::McapWriter(const std::string& library) : file_(kMagic) {
  append(file_, Op::Header, Content().string("").string(library));
}

std::uint16_t McapWriter::add_channel(const std::string& topic, const std::string& schema_name,
                                      const std::string& schema) {
  const std::uint16_t number = ++channels_;
  std::string records;
  append(records, Op::Schema,
         Content().integer(number, 2).string(schema_name).string("jsonschema").string(schema));
  append(records, Op::Channel,
         Content().integer(number, 2).integer(number, 2).string(topic).string("json").integer(0, 4));
  definitions_ += records;
  chunk_ += records;
  counts_[number] = 0;
  return number;
}

void McapWriter::add_message(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                             std::string_view json) {
  first_ns_ = index_.empty() ? time_ns : std::min(first_ns_, time_ns);
  last_ns_ = index_.empty() ? time_ns : std::max(last_ns_, time_ns);
  index_[channel].push_back({time_ns, chunk_.size()});
  append(
      chunk_, Op::Message,
      Content().integer(channel, 2).integer(sequence, 4).integer(time_ns, 8).integer(time_ns, 8).raw(json));
  ++counts_[channel];
  if (chunk_.size() >= kChunk_bytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  ChunkIndex chunk{first_ns_, last_ns_, end(), 0, 0, chunk_.size(), {}};
  append(file_, Op::Chunk,
         Content()
             .integer(index_.empty() ? 0 : first_ns_, 8)
             .integer(index_.empty() ? 0 : last_ns_, 8)
             .integer(chunk_.size(), 8)
             .integer(crc(chunk_), 4)
             .string("")
             .integer(chunk_.size(), 8)
             .raw(chunk_));
  chunk.length = end() - chunk.start;
  const std::uint64_t index_start = end();
  for (auto& [channel, entries] : index_) {
    std::ranges::stable_sort(entries, {}, &IndexEntry::time_ns);
    Content list;
    for (const IndexEntry& entry : entries) list.integer(entry.time_ns, 8).integer(entry.offset, 8);
    chunk.index_offsets[channel] = end();
    append(file_, Op::MessageIndex, Content().integer(channel, 2).string(list.text));
  }
  chunk.index_length = end() - index_start;
  chunks_.push_back(std::move(chunk));
  chunk_.clear();
  index_.clear();
}

std::string McapWriter::take() {
  end_chunk();
  taken_ += file_.size();
  taken_crc_ = crc(file_, taken_crc_);
  return std::exchange(file_, {});
}

std::string McapWriter::finish() {
  end_chunk();
  append(file_, Op::DataEnd, Content().integer(crc(file_, taken_crc_), 4));
  const std::size_t summary = file_.size();
  const std::uint64_t summary_start = end();
  file_ += definitions_;
  const std::uint64_t statistics_start = end();
  std::uint64_t messages = 0, first_ns = 0, last_ns = 0;
  for (const auto& [channel, count] : counts_) messages += count;
  for (const ChunkIndex& chunk : chunks_) {
    first_ns = &chunk == &chunks_.front() ? chunk.first_ns : std::min(first_ns, chunk.first_ns);
    last_ns = std::max(last_ns, chunk.last_ns);
  }
  append(file_, Op::Statistics,
         Content()
             .integer(messages, 8)
             .integer(channels_, 2)
             .integer(channels_, 4)
             .integer(0, 4)
             .integer(0, 4)
             .integer(chunks_.size(), 4)
             .integer(first_ns, 8)
             .integer(last_ns, 8)
             .raw(map_of(counts_).text));
  const std::uint64_t index_start = end();
  for (const ChunkIndex& chunk : chunks_)
    append(file_, Op::ChunkIndex,
           Content()
               .integer(chunk.first_ns, 8)
               .integer(chunk.last_ns, 8)
               .integer(chunk.start, 8)
               .integer(chunk.length, 8)
               .raw(map_of(chunk.index_offsets).text)
               .integer(chunk.index_length, 8)
               .string("")
               .integer(chunk.size, 8)
               .integer(chunk.size, 8));
  const std::uint64_t offsets_start = end();
  const auto group = [&](Op op, std::uint64_t start, std::uint64_t end) {
    if (end == start) return;
    append(file_, Op::SummaryOffset,
           Content().integer(static_cast<std::uint8_t>(op), 1).integer(start, 8).integer(end - start, 8));
  };
  group(Op::Statistics, statistics_start, index_start);
  group(Op::ChunkIndex, index_start, offsets_start);
  // The CRC covers the summary and the footer up to the CRC itself.
  constexpr std::uint64_t kFooter_bytes = 8 + 8 + 4;
  file_ += Content().integer(static_cast<std::uint8_t>(Op::Footer), 1).integer(kFooter_bytes, 8).text;
  file_ += Content().integer(summary_start, 8).integer(offsets_start, 8).text;
  file_ += Content().integer(crc(std::string_view(file_).substr(summary)), 4).text;
  file_ += kMagic;
  return std::move(file_);
}

}  // namespace biopsy::recorder
