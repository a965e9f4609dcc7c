// OpenIGTLink's TCP port: connections in, messages out, within limits. One thread, no knowledge of the robot.
// The protocol has no passwords and no encryption: by default only this machine can connect.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot/igtl/codec.hpp"

namespace biopsy::igtl {

using Client = std::uint64_t;  // never used twice

struct ServerSettings {
  std::string address = "127.0.0.1";  // IPv4 of the interface; 0.0.0.0: all
  std::uint16_t port = 18944;         // 0: any that is free
  Limits limits;
  std::size_t connections = 16;
  std::chrono::milliseconds idle_gives_way{2'000};  // silent for so long, where there are as many
  std::size_t messages_per_s = 500;
  std::size_t received_bytes = 268'435'456;     // of all messages that are not whole yet
  std::size_t unsent_bytes = 262'144;           // of a connection that does not read
  std::size_t unsent_droppable_bytes = 16'384;  // above, positions are left out
  std::chrono::milliseconds message_time{10'000}, image_time{60'000};  // from the first byte to the last
  // A peer that does not answer for so long is gone, cable or power: found by the kernel's keep-alive.
  std::chrono::seconds half_open{4};
};

// What poll() found.
struct ServerEvent {
  Client client = 0;
  std::optional<Message> message;  // absent: the connection has ended
  std::string why;                 // it ended
};

class Server {
 public:
  // Listens. Throws ConfigError: no such address, or the port is in use.
  explicit Server(const ServerSettings& settings);
  ~Server();

  std::uint16_t port() const;
  // Accepts, reads, writes and closes what is due; returns after `timeout` at the latest.
  std::vector<ServerEvent> poll(std::chrono::milliseconds timeout);
  // Nothing happens for a client that is gone. A droppable message is left out where the client reads slowly.
  void send(Client client, const Message& message, bool droppable = false);
  // The one connection that never gives way to another; nothing: none.
  void keep(std::optional<Client> client);
  // Writes what can be written at once.
  void flush();
  std::size_t connections() const;

 private:
  struct Connection;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace biopsy::igtl
