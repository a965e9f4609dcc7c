// The codec against itself and against bytes that were written down from the specification: seeded, no
// sockets.
#include "robot/igtl/codec.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "robot/igtl/crc64.hpp"

namespace biopsy::igtl {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::chrono::system_clock::time_point kTime{};

Image small_image(Image::Scalar scalar) {
  Image image;
  image.scalar = scalar;
  image.size = {3, 2, 2};
  image.axes = {0.5F, 0, 0, 0, 0.5F, 0, 0, 0, 2};
  image.centre = {1, -2, 3};
  for (std::size_t i = 0; i < 12 * bytes_of(scalar); ++i)
    image.voxels.push_back(static_cast<std::uint8_t>(i * 7));
  return image;
}

std::vector<Message> one_of_each() {
  return {{"CMD_0001", Text{"START_UP"}},
          {"", Text{"", 106}},
          {"TGT_1234567890123456", Transform{{1, 2, 3, 4, 5, 6, 7, 8, 9, -1, 1e-30F, 1e30F}}},
          {"CURRENT_STATUS", Status{StatusCode::HardwareFailure, "MOVE_TO_TARGET", "no, 3.1 mm"}},
          {"CURRENT_POSITION", Query::Transform},
          {"x", Query::Status},
          {"scan", small_image(Image::Scalar::Int16)},
          {"scan", small_image(Image::Scalar::UInt32)},
          {"scan", small_image(Image::Scalar::Float32)},
          {"scan", small_image(Image::Scalar::Float64)}};
}

std::vector<Message> all_in(Decoder& decoder) {
  std::vector<Message> found;
  while (auto message = decoder.next()) found.push_back(std::move(*message));
  return found;
}

Bytes with(Bytes bytes, std::size_t place, std::uint8_t value) {
  bytes.at(place) = value;
  return bytes;
}

// A body behind a header that was made by hand.
Bytes framed(std::uint16_t version, const std::string& type, const Bytes& body, std::uint64_t crc) {
  Bytes all = encode({"device", Unusable{type, ""}}, kTime);
  all[1] = static_cast<std::uint8_t>(version);
  for (std::size_t i = 0; i < 8; ++i) all[42 + i] = static_cast<std::uint8_t>(body.size() >> (56 - 8 * i));
  for (std::size_t i = 0; i < 8; ++i) all[50 + i] = static_cast<std::uint8_t>(crc >> (56 - 8 * i));
  all.insert(all.end(), body.begin(), body.end());
  return all;
}

std::string why_unusable(const Bytes& bytes) {
  Decoder decoder;
  decoder.feed(bytes);
  const auto message = decoder.next();
  const auto* unusable = message ? std::get_if<Unusable>(&message->body) : nullptr;
  return unusable ? unusable->why : "usable";
}

TEST(IgtlCrc, IsEcma182) {
  const std::string digits = "123456789";  // the check value of the catalogue of parametrised CRC algorithms
  EXPECT_EQ(crc64({reinterpret_cast<const std::uint8_t*>(digits.data()), digits.size()}),
            0x6C40DF5F0B497347U);
  EXPECT_EQ(crc64({}), 0U);
}

TEST(IgtlCodec, BringsBackWhatWasSentHoweverTheBytesAreCut) {
  Bytes stream;
  for (const Message& message : one_of_each()) {
    const Bytes bytes = encode(message, kTime);
    stream.insert(stream.end(), bytes.begin(), bytes.end());
  }
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    Decoder decoder;
    std::vector<Message> found;
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t count = std::min<std::size_t>(1 + random() % 97, stream.size() - at);
      decoder.feed(std::span(stream).subspan(at, count));
      at += count;
      for (Message& message : all_in(decoder)) found.push_back(std::move(message));
    }
    const auto sent = one_of_each();
    ASSERT_EQ(found, sent);
    EXPECT_EQ(decoder.waiting_bytes(), 0U);
  }
}

TEST(IgtlCodec, ReadsTheBytesOfTheSpecification) {
  const std::string body = std::string("\0\3\0\4STOP", 8);
  Bytes bytes{0, 1};
  for (const std::string& text :
       {std::string("STRING\0\0\0\0\0\0", 12), std::string("CMD_0009") + std::string(12, '\0'),
        std::string(8, '\0'), std::string("\0\0\0\0\0\0\0\10", 8)})
    bytes.insert(bytes.end(), text.begin(), text.end());
  const std::uint64_t crc = crc64({reinterpret_cast<const std::uint8_t*>(body.data()), body.size()});
  for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(crc >> shift));
  bytes.insert(bytes.end(), body.begin(), body.end());
  Decoder decoder;
  decoder.feed(bytes);
  EXPECT_EQ(decoder.next(), (Message{"CMD_0009", Text{"STOP"}}));
  EXPECT_EQ(encode({"CMD_0009", Text{"STOP"}}, kTime), bytes);
}

// Version 2 of the header: 12 bytes of extended header, then the content, then metadata.
TEST(IgtlCodec, SkipsExtendedHeaderAndMetadata) {
  const std::string content = std::string("\0\3\0\6MANUAL", 10);
  Bytes body{0, 12, 0, 2, 0, 0, 0, 3, 9, 9, 9, 9};
  body.insert(body.end(), content.begin(), content.end());
  body.insert(body.end(), {0, 0, 'a', 'b', 'c'});
  for (const std::uint16_t version :
       {std::uint16_t{2}, std::uint16_t{3}}) {  // 3: of programs that write the protocol's version into it
    Decoder decoder;
    decoder.feed(framed(version, "STRING", body, crc64(body)));
    EXPECT_EQ(decoder.next(), (Message{"device", Text{"MANUAL"}}));
  }
  for (const auto& [place, value] :
       {std::pair<std::size_t, std::uint8_t>{1, 11}, {0, 1}, {2, 1}, {4, 255}, {7, 200}}) {
    const Bytes wrong = with(body, place, value);
    EXPECT_NE(why_unusable(framed(2, "STRING", wrong, crc64(wrong))).find("extended header"),
              std::string::npos);
  }
}

TEST(IgtlCodec, NamesWhatIsWrongWithABodyAndReadsOn) {
  const Bytes text{0, 3, 0, 9, 'S', 'T', 'O', 'P'};
  EXPECT_NE(why_unusable(framed(1, "STRING", text, crc64(text))).find("length"), std::string::npos);
  EXPECT_NE(why_unusable(framed(1, "STRING", text, crc64(text) ^ 1)).find("CRC"), std::string::npos);
  const Bytes nothing;
  for (const char* type : {"STRING", "STATUS", "IMAGE"})
    EXPECT_NE(why_unusable(framed(1, type, nothing, 0)).find("shorter"), std::string::npos) << type;
  EXPECT_NE(why_unusable(framed(1, "TRANSFORM", text, crc64(text))).find("48"), std::string::npos);
  EXPECT_NE(why_unusable(framed(1, "POLYDATA", nothing, 0)).find("does not use"), std::string::npos);
  Decoder decoder;
  decoder.feed(framed(1, "STRING", text, 0));
  decoder.feed(encode({"CMD_1", Text{"STOP"}}, kTime));
  EXPECT_TRUE(std::holds_alternative<Unusable>(decoder.next()->body));
  EXPECT_EQ(decoder.next(), (Message{"CMD_1", Text{"STOP"}}));
}

TEST(IgtlCodec, RefusesAnImageThatIsNotAWholeGreyVolume) {
  const Bytes good = encode({"scan", small_image(Image::Scalar::Int16)}, kTime);
  const auto refused = [&](std::size_t place, std::uint8_t value) {
    Bytes body(good.begin() + kHeader_bytes, good.end());
    body.at(place) = value;
    return why_unusable(framed(1, "IMAGE", body, crc64(body)));
  };
  EXPECT_EQ(refused(0, 0), "usable");
  EXPECT_NE(refused(2, 3).find("component"), std::string::npos);
  for (const int scalar : {0, 1, 8, 9, 12, 13, 255})  // 13: complex
    EXPECT_NE(refused(3, static_cast<std::uint8_t>(scalar)).find("scalar"), std::string::npos) << scalar;
  EXPECT_NE(refused(4, 3).find("endian"), std::string::npos);
  EXPECT_NE(refused(5, 0).find("frame"), std::string::npos);
  EXPECT_NE(refused(7, 200).find("part of a volume"), std::string::npos);  // size without the sub-volume's
  EXPECT_NE(refused(61, 1).find("part of a volume"), std::string::npos);
  EXPECT_NE(refused(12, 0x7F).find("usable"), std::string::npos);  // large, but a number
}

TEST(IgtlCodec, TurnsBigEndianVoxelsRound) {
  Image image = small_image(Image::Scalar::Int16);
  const Bytes good = encode({"scan", image}, kTime);
  Bytes body(good.begin() + kHeader_bytes, good.end());
  body[4] = 1;
  for (std::size_t i = 72; i < body.size(); i += 2) std::swap(body[i], body[i + 1]);
  Decoder decoder;
  decoder.feed(framed(1, "IMAGE", body, crc64(body)));
  EXPECT_EQ(std::get<Image>(decoder.next()->body), image);
}

TEST(IgtlCodec, GivesUpWhereTheNextMessageCannotBeFound) {
  for (const auto& [place, value] :
       {std::pair<std::size_t, std::uint8_t>{0, 'G'}, {1, 4}, {1, 0}, {42, 255}, {46, 1}}) {
    Decoder decoder;
    decoder.feed(with(encode({"CMD_1", Text{"STOP"}}, kTime), place, value));
    EXPECT_THROW(decoder.next(), FramingLost) << place;
  }
}

// Any bytes are read or refused, and nothing that was not whole is passed on. Half of them are good messages
// with some bytes overwritten, the CRC repaired as often as not.
TEST(IgtlCodec, AnyBytesAreReadOrRefused) {
  std::mt19937 random(7);
  const std::vector<Message> samples = one_of_each();
  std::size_t read = 0, refused = 0, lost = 0;
  for (int round = 0; round < 20'000; ++round) {
    const Message& sample = samples[random() % samples.size()];
    Bytes bytes = encode(sample, kTime);
    for (unsigned changes = random() % 4; changes > 0; --changes)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (random() % 2 == 0) {
      const std::uint64_t crc = crc64(std::span(bytes).subspan(kHeader_bytes));
      for (std::size_t i = 0; i < 8; ++i) bytes[50 + i] = static_cast<std::uint8_t>(crc >> (56 - 8 * i));
    }
    Decoder decoder;
    decoder.feed(bytes);
    try {
      for (const Message& message : all_in(decoder)) {
        ASSERT_LE(message.device.size(), kName_bytes);
        const bool unusable = std::holds_alternative<Unusable>(message.body);
        unusable ? ++refused : ++read;
      }
    } catch (const FramingLost& why) {
      EXPECT_FALSE(why.why.empty());
      ++lost;
    }
  }
  EXPECT_GT(read, 5'000U);
  EXPECT_GT(refused, 1'000U);
  EXPECT_GT(lost, 50U);
}

TEST(IgtlCodec, ANameThatIsTooLongIsAProgrammingError) {
  EXPECT_THROW(encode({std::string(21, 'x'), Text{}}, kTime), std::length_error);
  EXPECT_THROW(encode({"x", Text{std::string(65'536, 'x')}}, kTime), std::length_error);
}

}  // namespace
}  // namespace biopsy::igtl
