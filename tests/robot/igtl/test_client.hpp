// A navigation program's end of a connection, or a hostile client's.
#pragma once

#include <gtest/gtest.h>
#include <linux/filter.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <vector>

#include "robot/igtl/codec.hpp"
#include "tests/robot/igtl/scripted_robot.hpp"

namespace biopsy::igtl {

class TestClient {
 public:
  explicit TestClient(std::uint16_t port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~TestClient() { close(socket_); }
  TestClient(const TestClient&) = delete;
  TestClient& operator=(const TestClient&) = delete;

  void send(const Message& message) { send_bytes(encode(message, {})); }
  void send_bytes(const std::vector<std::uint8_t>& bytes) {
    EXPECT_EQ(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  // Nothing that comes to this socket is seen by its kernel any more, and nothing is acknowledged: a cable
  // that was pulled out.
  void pull_the_cable() {
    sock_filter drop{BPF_RET | BPF_K, 0, 0, 0};
    const sock_fprog program{1, &drop};
    ASSERT_EQ(setsockopt(socket_, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof program), 0);
  }
  // What has come; "closed" at the end where the server ended the connection.
  Script came() {
    Script all;
    std::uint8_t bytes[4096];
    ssize_t count = 0;
    while ((count = recv(socket_, bytes, sizeof bytes, MSG_DONTWAIT)) > 0)
      decoder_.feed({bytes, static_cast<std::size_t>(count)});
    const bool closed = count == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
    while (const auto message = decoder_.next()) all.push_back(brief(*message));
    if (closed) all.emplace_back("closed");
    return all;
  }
  bool is_connected() const { return connected_; }
  int socket_number() const { return socket_; }

 private:
  int socket_;
  bool connected_ = false;
  Decoder decoder_;
};

}  // namespace biopsy::igtl
