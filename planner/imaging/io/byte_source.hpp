// Bytes of a file in order, plain or compressed (gzip, zlib), with the promise that nothing is invented: what
// is missing or damaged throws ConfigError naming the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>

namespace biopsy::imaging {

class ByteSource {
 public:
  enum class Packing : std::uint8_t { Plain, Gzip, Zlib };

  // Starts `offset` bytes into the file as it lies on the disk. Refuses a file that cannot be opened, and
  // Gzip where the bytes are not gzip.
  ByteSource(const std::filesystem::path& file, Packing packing, std::uint64_t offset = 0);

  void read(std::span<std::byte> bytes);                 // all of them, or ConfigError "truncated"
  std::size_t read_at_most(std::span<std::byte> bytes);  // fewer only where the data end
  void skip(std::uint64_t count);

  // The most bytes that can still come: what is left of a plain file, 1032 times that of a compressed one
  // (the best deflate can do). A header that promises more is lying, and nothing need be allocated to know
  // it.
  void refuse_if_shorter_than(std::uint64_t count) const;

  // Reads to the end, so that a checksum behind the data is verified; returns how many bytes were left, at
  // most `limit`.
  std::uint64_t rest(std::uint64_t limit = 65536);

 private:
  std::size_t read_some(std::byte* bytes, std::size_t count);

  std::size_t inflate_some(std::byte* bytes, std::size_t count);

  struct Closer {
    void operator()(void* file) const;
  };
  struct Inflater;  // zlib's stream and its input
  struct InflaterDeleter {
    void operator()(Inflater* inflater) const;
  };
  std::filesystem::path path_;
  Packing packing_;
  std::ifstream plain_;
  std::unique_ptr<void, Closer> gzip_;  // zlib's gzFile
  std::unique_ptr<Inflater, InflaterDeleter> zlib_;
  std::uint64_t most_left_ = 0;
};

// True when the file begins with the two bytes of gzip.
bool begins_like_gzip(const std::filesystem::path& file);

}  // namespace biopsy::imaging
