#include "robot/igtl/codec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "robot/igtl/crc64.hpp"

namespace biopsy::igtl {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kType_bytes = 12, kExtendedHeader_bytes = 12, kImageHeader_bytes = 72;

template <class... Parts>
struct Overloaded : Parts... {
  using Parts::operator()...;
};
template <class... Parts>
Overloaded(Parts...) -> Overloaded<Parts...>;

// Big-endian integers and fixed fields, in order. The caller has checked that there are enough bytes.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : bytes_(bytes) {}
  std::uint64_t integer(std::size_t count) {
    std::uint64_t value = 0;
    for (const std::uint8_t byte : raw(count)) value = value << 8U | byte;
    return value;
  }
  float real() { return std::bit_cast<float>(static_cast<std::uint32_t>(integer(4))); }
  // Up to the first NUL; what cannot be printed becomes '?'.
  std::string name(std::size_t count) {
    std::string text;
    for (const std::uint8_t byte : raw(count)) {
      if (byte == 0) break;
      text += byte >= 0x20 && byte < 0x7F ? static_cast<char>(byte) : '?';
    }
    return text;
  }
  Bytes raw(std::size_t count) {
    const Bytes part = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return part;
  }
  Bytes rest() const { return bytes_; }

 private:
  Bytes bytes_;
};

class ByteAppender {
 public:
  ByteAppender& integer(std::uint64_t value, std::size_t count) {
    while (count-- > 0) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * count)));
    return *this;
  }
  ByteAppender& real(float value) { return integer(std::bit_cast<std::uint32_t>(value), 4); }
  ByteAppender& name(std::string_view text, std::size_t count) {
    if (text.size() > count) throw std::length_error("a name of OpenIGTLink is too long");
    raw(text);
    bytes.resize(bytes.size() + count - text.size());
    return *this;
  }
  ByteAppender& raw(std::string_view text) {
    bytes.insert(bytes.end(), text.begin(), text.end());
    return *this;
  }
  std::vector<std::uint8_t> bytes;
};

struct Header {
  std::uint16_t version;
  std::string type, device;
  std::uint64_t body_bytes, crc;
};

Header header_of(Bytes bytes) {
  ByteReader reader(bytes);
  Header header;
  header.version = static_cast<std::uint16_t>(reader.integer(2));
  header.type = reader.name(kType_bytes);
  header.device = reader.name(kName_bytes);
  reader.integer(8);  // time stamp of another machine's clock: decides nothing
  header.body_bytes = reader.integer(8);
  header.crc = reader.integer(8);
  return header;
}

using Body = decltype(Message::body);

Unusable unusable(const std::string& type, std::string why) {
  return {type, std::move(why)};
}

// What of a body belongs to its type: from header version 2 on there is an extended header before it and
// metadata behind it.
std::optional<Bytes> content_of(const Header& header, Bytes body) {
  if (header.version == 1 || body.empty()) return body;
  if (body.size() < kExtendedHeader_bytes) return std::nullopt;
  ByteReader reader(body);
  const std::size_t extended = reader.integer(2), metadata_header = reader.integer(2);
  const std::size_t metadata = reader.integer(4);
  if (extended < kExtendedHeader_bytes || extended + metadata_header + metadata > body.size())
    return std::nullopt;
  return body.subspan(extended, body.size() - extended - metadata_header - metadata);
}

Body text_of(Bytes content) {
  if (content.size() < 4) return unusable("STRING", "shorter than its header");
  ByteReader reader(content);
  const auto encoding = static_cast<std::uint16_t>(reader.integer(2));
  if (reader.integer(2) != reader.rest().size())
    return unusable("STRING", "its length is not that of the body");
  return Text{std::string(reader.rest().begin(), reader.rest().end()), encoding};
}

Body transform_of(Bytes content) {
  Transform transform;
  if (content.size() != 4 * transform.columns.size())
    return unusable("TRANSFORM", fmt::format("{} bytes instead of 48", content.size()));
  ByteReader reader(content);
  for (float& value : transform.columns) value = reader.real();
  return transform;
}

Body status_of(Bytes content) {
  constexpr std::size_t kBefore = 2 + 8 + kName_bytes;
  if (content.size() < kBefore) return unusable("STATUS", "shorter than its header");
  ByteReader reader(content);
  Status status;
  status.code = static_cast<StatusCode>(reader.integer(2));
  reader.integer(8);
  status.error_name = reader.name(kName_bytes);
  status.message = reader.name(reader.rest().size());
  return status;
}

bool is_scalar(std::uint64_t code) {
  return (code >= 2 && code <= 7) || code == 10 || code == 11;
}

Body image_of(Bytes content) {
  if (content.size() < kImageHeader_bytes) return unusable("IMAGE", "shorter than its header");
  ByteReader reader(content);
  if (reader.integer(2) > 2) return unusable("IMAGE", "a version of the image header that is not known");
  const std::uint64_t components = reader.integer(1), scalar = reader.integer(1), endian = reader.integer(1),
                      frame = reader.integer(1);
  if (components != 1) return unusable("IMAGE", "more than one component: send a grey-value image");
  if (!is_scalar(scalar))
    return unusable("IMAGE",
                    "a scalar type that is neither an integer of 8, 16 or 32 bits nor a real number");
  if (endian != 1 && endian != 2) return unusable("IMAGE", "an endianness that is not known");
  if (frame != 1 && frame != 2) return unusable("IMAGE", "a frame that is neither RAS nor LPS");
  Image image;
  image.scalar = static_cast<Image::Scalar>(scalar);
  image.ras = frame == 1;
  std::uint64_t voxels = 1;
  for (std::uint16_t& size : image.size) {
    size = static_cast<std::uint16_t>(reader.integer(2));
    voxels *= size;
  }
  for (float& value : image.axes) value = reader.real();
  for (float& value : image.centre) value = reader.real();
  bool finite = true, whole = true;
  for (const float value : image.axes) finite = finite && std::isfinite(value);
  for (const float value : image.centre) finite = finite && std::isfinite(value);
  for (int axis = 0; axis < 3; ++axis) whole = reader.integer(2) == 0 && whole;
  for (const std::uint16_t size : image.size) whole = reader.integer(2) == size && whole;
  if (!finite) return unusable("IMAGE", "its place is not a number");
  if (!whole) return unusable("IMAGE", "a part of a volume: send whole volumes");
  const std::size_t bytes = bytes_of(image.scalar);
  if (voxels == 0 || voxels * bytes != reader.rest().size())
    return unusable("IMAGE", "not as many voxels as its size says");
  image.voxels.assign(reader.rest().begin(), reader.rest().end());
  if (endian == 1)
    for (auto voxel = image.voxels.begin(); voxel != image.voxels.end(); voxel += static_cast<long>(bytes))
      std::reverse(voxel, voxel + static_cast<long>(bytes));
  return image;
}

Body body_of(const Header& header, Bytes body, std::uint64_t crc) {
  if (crc != header.crc) return unusable(header.type, "its CRC is wrong");
  const std::optional<Bytes> content = content_of(header, body);
  if (!content) return unusable(header.type, "its extended header does not fit its body");
  if (header.type == "STRING") return text_of(*content);
  if (header.type == "TRANSFORM") return transform_of(*content);
  if (header.type == "STATUS") return status_of(*content);
  if (header.type == "IMAGE") return image_of(*content);
  if (header.type.starts_with("GET_TRANS")) return Query::Transform;
  if (header.type == "GET_STATUS") return Query::Status;
  return unusable(header.type, "this robot does not use it");
}

void append(ByteAppender& to, const Image& image) {
  to.integer(1, 2).integer(1, 1).integer(static_cast<std::uint8_t>(image.scalar), 1).integer(2, 1);
  to.integer(image.ras ? 1 : 2, 1);
  for (const std::uint16_t size : image.size) to.integer(size, 2);
  for (const float value : image.axes) to.real(value);
  for (const float value : image.centre) to.real(value);
  to.integer(0, 6);
  for (const std::uint16_t size : image.size) to.integer(size, 2);
  to.bytes.insert(to.bytes.end(), image.voxels.begin(), image.voxels.end());
}

// The name of the type; the body is appended.
std::string type_and_body(const Message& message, ByteAppender& body) {
  return std::visit(Overloaded{[&](const Text& text) -> std::string {
                                 if (text.text.size() > 0xFFFF)
                                   throw std::length_error("a text of OpenIGTLink is too long");
                                 body.integer(text.encoding, 2).integer(text.text.size(), 2).raw(text.text);
                                 return "STRING";
                               },
                               [&](const Transform& transform) -> std::string {
                                 for (const float value : transform.columns) body.real(value);
                                 return "TRANSFORM";
                               },
                               [&](const Status& status) -> std::string {
                                 body.integer(static_cast<std::uint16_t>(status.code), 2).integer(0, 8);
                                 body.name(status.error_name, kName_bytes).raw(status.message).integer(0, 1);
                                 return "STATUS";
                               },
                               [&](const Image& image) -> std::string {
                                 append(body, image);
                                 return "IMAGE";
                               },
                               [](Query query) -> std::string {
                                 return query == Query::Transform ? "GET_TRANS" : "GET_STATUS";
                               },
                               [](const Unusable& other) -> std::string { return other.type; }},
                    message.body);
}

}  // namespace

std::vector<std::uint8_t> encode(const Message& message, std::chrono::system_clock::time_point time) {
  ByteAppender body, all;
  const std::string type = type_and_body(message, body);
  const auto since = time.time_since_epoch();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(since);
  const auto nanoseconds = std::chrono::duration_cast<std::chrono::nanoseconds>(since - seconds);
  all.integer(1, 2).name(type, kType_bytes).name(message.device, kName_bytes);
  all.integer(static_cast<std::uint64_t>(seconds.count()), 4);
  all.integer((static_cast<std::uint64_t>(nanoseconds.count()) << 32U) / 1'000'000'000U, 4);
  all.integer(body.bytes.size(), 8).integer(crc64(body.bytes), 8);
  all.bytes.insert(all.bytes.end(), body.bytes.begin(), body.bytes.end());
  return std::move(all.bytes);
}

void Decoder::feed(std::span<const std::uint8_t> bytes) {
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
}

std::optional<Message> Decoder::next() {
  if (waiting_.size() < kHeader_bytes) return std::nullopt;
  const Header header = header_of(Bytes(waiting_).first(kHeader_bytes));
  if (header.version < 1 || header.version > 3)
    throw FramingLost{fmt::format("header version {}: this is not OpenIGTLink", header.version)};
  const std::size_t most = header.type == "IMAGE" ? limits_.image_bytes : limits_.body_bytes;
  if (header.body_bytes > most)
    throw FramingLost{fmt::format("{} of {} bytes; {} are allowed", header.type, header.body_bytes, most)};
  const Bytes come = Bytes(waiting_).subspan(
      kHeader_bytes, std::min<std::size_t>(waiting_.size() - kHeader_bytes, header.body_bytes));
  crc_ = crc64(come.subspan(crc_bytes_), crc_);
  crc_bytes_ = come.size();
  if (come.size() < header.body_bytes) return std::nullopt;
  Message message{header.device, body_of(header, come, crc_)};
  crc_ = 0, crc_bytes_ = 0;
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<long>(kHeader_bytes + header.body_bytes));
  return message;
}

}  // namespace biopsy::igtl
