// The codec against Debian's libopenigtlink, which shares no code with it: each reads what the other wrote.
#include <gtest/gtest.h>
#include <igtlImageMessage.h>
#include <igtlMessageHeader.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>
#include <igtl_util.h>

#include <cstring>
#include <random>

#include "planner/imaging/io/read_volume.hpp"
#include "robot/common/files/file.hpp"
#include "robot/igtl/codec.hpp"
#include "robot/igtl/crc64.hpp"
#include "robot/igtl/image_folder.hpp"
#include "tests/scratch_folder.hpp"

namespace library = igtl;  // before ours of the same name

namespace biopsy::igtl {
namespace {

// As the library sends it, read by us.
Message read_from(library::MessageBase& message) {
  message.Pack();
  const auto* bytes = static_cast<const std::uint8_t*>(message.GetPackPointer());
  Decoder decoder;
  decoder.feed({bytes, static_cast<std::size_t>(message.GetPackSize())});
  auto found = decoder.next();
  EXPECT_TRUE(found);
  return found.value_or(Message{});
}

// As we send it, read by the library, with its check of the CRC.
template <class Kind>
typename Kind::Pointer read_by_library(const Message& message) {
  const auto bytes = encode(message, std::chrono::system_clock::time_point{});
  auto header = library::MessageHeader::New();
  header->InitPack();
  EXPECT_EQ(header->GetPackSize(), static_cast<int>(kHeader_bytes));
  std::memcpy(header->GetPackPointer(), bytes.data(), kHeader_bytes);
  header->Unpack();
  auto body = Kind::New();
  body->SetMessageHeader(header);
  body->AllocatePack();
  EXPECT_EQ(body->GetPackBodySize(), static_cast<int>(bytes.size() - kHeader_bytes));
  std::memcpy(body->GetPackBodyPointer(), bytes.data() + kHeader_bytes, bytes.size() - kHeader_bytes);
  EXPECT_TRUE(body->Unpack(1) & library::MessageHeader::UNPACK_BODY);
  EXPECT_EQ(body->GetDeviceName(), message.device);
  return body;
}

library::Matrix4x4& some_pose(library::Matrix4x4& matrix) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      matrix[row][column] = static_cast<float>(10 * row + column) * 0.37F;
  for (int column = 0; column < 4; ++column) matrix[3][column] = column == 3 ? 1.0F : 0.0F;
  return matrix;
}

TEST(IgtlReference, CrcAgrees) {
  std::mt19937 random(3);
  for (int round = 0; round < 100; ++round) {
    std::vector<std::uint8_t> bytes(random() % 500);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    EXPECT_EQ(crc64(bytes), ::crc64(bytes.data(), bytes.size(), 0ULL));
  }
}

TEST(IgtlReference, StringsGoBothWays) {
  auto message = library::StringMessage::New();
  message->SetDeviceName("CMD_0001");
  message->SetString("START_UP");
  EXPECT_EQ(read_from(*message), (Message{"CMD_0001", Text{"START_UP"}}));
  const auto back = read_by_library<library::StringMessage>({"ACK_0001", Text{"START_UP"}});
  EXPECT_STREQ(back->GetString(), "START_UP");
  EXPECT_EQ(back->GetEncoding(), 3);
}

TEST(IgtlReference, TransformsGoBothWays) {
  library::Matrix4x4 pose, back;
  auto message = library::TransformMessage::New();
  message->SetDeviceName("TGT_0006");
  message->SetMatrix(some_pose(pose));
  const Message found = read_from(*message);
  ASSERT_TRUE(std::holds_alternative<Transform>(found.body));
  const Transform& transform = std::get<Transform>(found.body);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      EXPECT_EQ(transform.columns[static_cast<std::size_t>(3 * column + row)], pose[row][column]);
  read_by_library<library::TransformMessage>({"ACK_0006", transform})->GetMatrix(back);
  EXPECT_EQ(std::memcmp(back, pose, sizeof pose), 0);
}

TEST(IgtlReference, StatusGoesBothWays) {
  const Status status{StatusCode::ConfigError, "TARGET", "44.7 mm off the needle axis"};
  const auto back = read_by_library<library::StatusMessage>({"TARGET", status});
  EXPECT_EQ(back->GetCode(), 10);
  EXPECT_STREQ(back->GetErrorName(), "TARGET");
  EXPECT_STREQ(back->GetStatusString(), status.message.c_str());
  back->SetDeviceName("TARGET");
  EXPECT_EQ(read_from(*back), (Message{"TARGET", status}));
}

TEST(IgtlReference, QueriesAreRead) {
  auto transform = library::GetTransformMessage::New();
  transform->SetDeviceName("CURRENT_POSITION");
  EXPECT_EQ(read_from(*transform), (Message{"CURRENT_POSITION", Query::Transform}));
  auto status = library::GetStatusMessage::New();
  status->SetDeviceName("CURRENT_STATUS");
  EXPECT_EQ(read_from(*status), (Message{"CURRENT_STATUS", Query::Status}));
}

// The library's image of 4 x 3 x 3 voxels of a type, each with a value of its own.
template <class Value>
void read_an_image_of(int type, Value first, Value step) {
  auto message = library::ImageMessage::New();
  message->SetDeviceName("scan");
  message->SetDimensions(4, 3, 3);
  message->SetSpacing(0.5F, 0.75F, 2.0F);
  message->SetScalarType(type);
  message->SetEndian(
      library::ImageMessage::ENDIAN_LITTLE);  // of the scalars; the library does not turn them round
  message->SetOrigin(10.0F, -20.0F, 30.0F);
  message->AllocateScalars();
  std::vector<Value> voxels(36);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    voxels[i] = static_cast<Value>(first + static_cast<Value>(i) * step);
  const std::size_t bytes = voxels.size() * sizeof(Value);
  std::memcpy(message->GetScalarPointer(), voxels.data(), bytes);
  const Message found = read_from(*message);
  ASSERT_TRUE(std::holds_alternative<Image>(found.body)) << std::get<Unusable>(found.body).why;
  const Image& image = std::get<Image>(found.body);
  EXPECT_EQ(image.size, (std::array<std::uint16_t, 3>{4, 3, 3}));
  EXPECT_EQ(image.axes, (std::array<float, 9>{0.5F, 0, 0, 0, 0.75F, 0, 0, 0, 2.0F}));
  EXPECT_EQ(image.centre, (std::array<float, 3>{10, -20, 30}));
  ASSERT_EQ(image.voxels.size(), bytes);
  EXPECT_EQ(std::memcmp(image.voxels.data(), voxels.data(), bytes), 0);
  // As the file that the planner reads.
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "scan.nrrd";
  atomic_write(file, nrrd_of(image));
  const Volume volume = imaging::read_volume(file);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    EXPECT_EQ(volume.voxels[i], static_cast<float>(voxels[i])) << i;
}

TEST(IgtlReference, ImagesOfEveryRealTypeAreRead) {
  using Library = library::ImageMessage;
  read_an_image_of<std::int8_t>(Library::TYPE_INT8, -100, 6);
  read_an_image_of<std::uint8_t>(Library::TYPE_UINT8, 3, 7);
  read_an_image_of<std::int16_t>(Library::TYPE_INT16, -3000, 251);
  read_an_image_of<std::uint16_t>(Library::TYPE_UINT16, 1000, 37);
  read_an_image_of<std::int32_t>(Library::TYPE_INT32, -90'000, 7001);
  read_an_image_of<std::uint32_t>(Library::TYPE_UINT32, 70'000, 9001);
  read_an_image_of<float>(Library::TYPE_FLOAT32, -0.5F, 12.25F);
  read_an_image_of<double>(Library::TYPE_FLOAT64, -0.125, 1003.5);
}

}  // namespace
}  // namespace biopsy::igtl
