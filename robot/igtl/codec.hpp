// Bytes of a connection to messages and back. Reads protocol versions 1 to 3 (header versions 1 and 2, with
// extended header and metadata, which are skipped); writes header version 1, which every client reads.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robot/igtl/message.hpp"

namespace biopsy::igtl {

inline constexpr std::size_t kHeader_bytes = 58;
inline constexpr std::size_t kName_bytes = 20;  // of a device or an error

// Throws std::length_error where a name has more than 20 bytes or a text more than 65 535: programming
// errors.
std::vector<std::uint8_t> encode(const Message& message, std::chrono::system_clock::time_point time);

// What a connection may send.
struct Limits {
  std::size_t body_bytes = 70'000;        // the longest STRING and room for its metadata
  std::size_t image_bytes = 134'217'728;  // 512 x 512 x 256 voxels of 2 bytes
};

// The place where the next message begins is lost: the connection cannot be used any more.
struct FramingLost {
  std::string why;
};

class Decoder {
 public:
  explicit Decoder(const Limits& limits = {}) : limits_(limits) {}

  void feed(std::span<const std::uint8_t> bytes);
  // The next whole message; a body with a wrong CRC or content is Unusable. Throws FramingLost for a header
  // version that is not known and for a body above the limit.
  std::optional<Message> next();
  std::size_t waiting_bytes() const { return waiting_.size(); }  // of a message that is not whole yet

 private:
  Limits limits_;
  std::vector<std::uint8_t> waiting_;
  // Of the body's bytes that have come: a large body is not gone through at once when its last byte is there.
  std::uint64_t crc_ = 0;
  std::size_t crc_bytes_ = 0;
};

}  // namespace biopsy::igtl
