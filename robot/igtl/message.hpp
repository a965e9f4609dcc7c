// Messages of OpenIGTLink that a navigation program and a robot exchange, as values. Millimetres, RAS.
// Source: OpenIGTLink protocol, versions 2 and 3, http://openigtlink.org/protocols.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace biopsy::igtl {

// STRING
struct Text {
  std::string text;
  std::uint16_t encoding = 3;  // MIBenum; 3: US-ASCII, the only one that the robot protocol uses
  bool operator==(const Text&) const = default;
};

// TRANSFORM: the first three columns are the axes, the fourth the origin, mm. Kept as the numbers that were
// sent, so that an acknowledgement repeats them to the bit.
struct Transform {
  std::array<float, 12> columns{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  bool operator==(const Transform&) const = default;
};

// Codes of STATUS that this robot sends.
enum class StatusCode : std::uint16_t {
  Ok = 1,
  Panic = 3,
  AccessDenied = 5,
  Timeout = 7,
  ConfigError = 10,
  IllegalInstruction = 12,
  NotReady = 13,
  ManualMode = 14,
  HardwareFailure = 18,
};

// STATUS
struct Status {
  StatusCode code = StatusCode::NotReady;
  std::string error_name;  // at most 20 bytes
  std::string message;
  bool operator==(const Status&) const = default;
};

// GET_TRANS (older clients: GET_TRANSFORM) and GET_STATUS
enum class Query : std::uint8_t { Transform, Status };

// IMAGE: voxels with x fastest, little-endian, one component.
struct Image {
  enum class Scalar : std::uint8_t {
    Int8 = 2,
    UInt8 = 3,
    Int16 = 4,
    UInt16 = 5,
    Int32 = 6,
    UInt32 = 7,
    Float32 = 10,
    Float64 = 11
  };
  Scalar scalar = Scalar::Int16;
  bool ras = true;  // otherwise LPS
  std::array<std::uint16_t, 3> size{};
  std::array<float, 9> axes{};    // three columns: direction of i, j, k times spacing, mm
  std::array<float, 3> centre{};  // of the volume, mm
  std::vector<std::uint8_t> voxels;
  bool operator==(const Image&) const = default;
};
constexpr std::size_t bytes_of(Image::Scalar scalar) {
  switch (scalar) {
    case Image::Scalar::Int8:
    case Image::Scalar::UInt8:
      return 1;
    case Image::Scalar::Int16:
    case Image::Scalar::UInt16:
      return 2;
    case Image::Scalar::Int32:
    case Image::Scalar::UInt32:
    case Image::Scalar::Float32:
      return 4;
    case Image::Scalar::Float64:
      return 8;
  }
  return 0;
}

// A type that the robot does not use, or a body that is not what its type says.
struct Unusable {
  std::string type;
  std::string why;
  bool operator==(const Unusable&) const = default;
};

struct Message {
  std::string device;  // at most 20 bytes
  std::variant<Text, Transform, Status, Query, Image, Unusable> body;
  bool operator==(const Message&) const = default;
};

}  // namespace biopsy::igtl
