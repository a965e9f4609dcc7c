// An IMAGE message in bytes that are put together by the protocol's description, without our codec: header
// versions 1 and 2, both byte orders, both frames.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "robot/igtl/navigation_server.hpp"
#include "robot/msg/volume.hpp"
#include "tests/robot/igtl/test_client.hpp"

namespace biopsy::robot {

using Bytes = std::vector<std::uint8_t>;

inline void append(Bytes& to, std::uint64_t value, int count) {
  while (count-- > 0) to.push_back(static_cast<std::uint8_t>(value >> (8 * count)));
}
inline void append(Bytes& to, float value) {
  append(to, std::bit_cast<std::uint32_t>(value), 4);
}
inline void append_name(Bytes& to, const std::string& name, std::size_t count) {
  to.insert(to.end(), name.begin(), name.end());
  to.resize(to.size() + count - name.size());
}

// ECMA-182, a bit at a time.
inline std::uint64_t crc_of(const Bytes& bytes) {
  std::uint64_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<std::uint64_t>(byte) << 56U;
    for (int bit = 0; bit < 8; ++bit) crc = crc << 1U ^ (crc >> 63U) * 0x42F0E1EBA9EA3693U;
  }
  return crc;
}

struct Way {
  int version = 1;              // of the header
  bool big_endian = true;       // voxels
  bool ras = true;              // or LPS
  bool says_the_other = false;  // frame than the numbers are in
  int components = 1;
};

inline Bytes image_message(const std::string& device, const Volume& volume, const Way& way) {
  const Grid& grid = volume.grid;
  const Eigen::Vector3d turn = way.ras ? Eigen::Vector3d(-1, -1, 1) : Eigen::Vector3d(1, 1, 1);
  Bytes content;
  append(content, 1, 2), append(content, static_cast<std::uint64_t>(way.components), 1);
  append(content, way.big_endian ? 10 : 4, 1);  // float32, int16
  append(content, way.big_endian ? 1 : 2, 1), append(content, way.ras != way.says_the_other ? 1 : 2, 1);
  for (int axis = 0; axis < 3; ++axis) append(content, static_cast<std::uint64_t>(grid.size[axis]), 2);
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      append(content, static_cast<float>(turn[row] * grid.X_SI.linear()(row, column)));
  const Point centre = turn.cwiseProduct(
      grid.X_SI * Point((grid.size.x() - 1) / 2.0, (grid.size.y() - 1) / 2.0, (grid.size.z() - 1) / 2.0));
  for (int row = 0; row < 3; ++row) append(content, static_cast<float>(centre[row]));
  append(content, 0, 6);
  for (int axis = 0; axis < 3; ++axis) append(content, static_cast<std::uint64_t>(grid.size[axis]), 2);
  for (const float value : volume.voxels) {
    if (way.big_endian) {
      append(content, value);
      continue;
    }
    const auto whole = static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(value)));
    content.push_back(static_cast<std::uint8_t>(whole));
    content.push_back(static_cast<std::uint8_t>(whole >> 8U));
  }
  Bytes body;
  if (way.version == 2) {  // extended header; one entry of metadata, "a" = "b", behind the content
    append(body, 12, 2), append(body, 2 + 8, 2), append(body, 2, 4), append(body, 7, 4);
    body.insert(body.end(), content.begin(), content.end());
    append(body, 1, 2), append(body, 1, 2), append(body, 3, 2), append(body, 1, 4);
    append_name(body, "ab", 2);
  } else {
    body = content;
  }
  Bytes message;
  append(message, static_cast<std::uint64_t>(way.version), 2);
  append_name(message, "IMAGE", 12), append_name(message, device, 20), append(message, 0, 8);
  append(message, body.size(), 8), append(message, crc_of(body), 8);
  message.insert(message.end(), body.begin(), body.end());
  return message;
}

// By a server without a robot, which keeps images in `folder`: what the sender is told.
inline igtl::Script told_by_server(const Bytes& message, const std::filesystem::path& folder,
                                   igtl::Dialect dialect) {
  using namespace std::chrono_literals;
  struct : igtl::RobotLink {
    igtl::RobotView view(std::int64_t) override { return {}; }
    void tell(const igtl::Wish&, std::int64_t) override {}
  } nobody;
  igtl::ServerSettings settings;
  settings.port = 0;
  igtl::NavigationServer server(settings, dialect, folder, nobody);
  igtl::TestClient client(server.port());
  std::jthread sends([&] { client.send_bytes(message); });
  igtl::Script told;
  for (const auto until = std::chrono::steady_clock::now() + 20s;
       told.empty() && std::chrono::steady_clock::now() < until;) {
    server.turn(1ms);
    told = client.came();
  }
  return told;
}

}  // namespace biopsy::robot
