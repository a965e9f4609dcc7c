// An MCAP file (https://mcap.dev/spec), version 0: uncompressed chunks with CRC and message index, and a
// summary with schemas, channels, statistics and chunk index. There is no C++ library of it in Debian.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace biopsy::recorder {

class McapWriter {
 public:
  // `library`: what wrote it.
  explicit McapWriter(const std::string& library);

  // A topic of JSON messages, described by a JSON Schema. Returns its number.
  std::uint16_t add_channel(const std::string& topic, const std::string& schema_name,
                            const std::string& schema);
  // `time_ns`: since 1970, UTC.
  void add_message(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                   std::string_view json);
  // The file's bytes since the last call, up to and with the last message: what was added before is a chunk
  // of its own, which readers find in a file that ends there.
  std::string take();
  // The rest of the file, or the whole where nothing was taken; nothing can be added afterwards.
  std::string finish();

 private:
  struct IndexEntry {
    std::uint64_t time_ns, offset;
  };
  struct ChunkIndex {
    std::uint64_t first_ns, last_ns, start, length, index_length, size;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
  };
  void end_chunk();
  std::uint64_t end() const { return taken_ + file_.size(); }  // of the file so far

  std::uint64_t taken_ = 0;                                 // bytes that are not in file_ any more,
  std::uint32_t taken_crc_ = 0;                             // and their CRC
  std::string file_, definitions_, chunk_;                  // definitions: schemas and channels, as records
  std::map<std::uint16_t, std::vector<IndexEntry>> index_;  // of the present chunk
  std::vector<ChunkIndex> chunks_;
  std::map<std::uint16_t, std::uint64_t> counts_;
  std::uint64_t first_ns_ = 0, last_ns_ = 0;  // of the present chunk
  std::uint16_t channels_ = 0;
};

}  // namespace biopsy::recorder
