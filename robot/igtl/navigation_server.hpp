// The robot protocol on a port: one navigation program controls, others may look and stop.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "robot/igtl/image_writer.hpp"
#include "robot/igtl/protocol.hpp"
#include "robot/igtl/server.hpp"

namespace biopsy::igtl {

// The robot, as this program reaches it.
class RobotLink {
 public:
  virtual ~RobotLink() = default;
  virtual RobotView view(std::int64_t now_us) = 0;
  // Called at least every few milliseconds, with the newest wish.
  virtual void tell(const Wish& wish, std::int64_t now_us) = 0;
};

class NavigationServer {
 public:
  // `robot` must outlive this. `images`: of IMAGE messages; empty: they are refused. Throws ConfigError.
  NavigationServer(const ServerSettings& settings, Dialect dialect, const std::filesystem::path& images,
                   RobotLink& robot);

  // Once round; returns after `timeout` at the latest.
  void turn(std::chrono::milliseconds timeout);
  std::uint16_t port() const { return server_.port(); }
  std::size_t connections() const { return server_.connections(); }

 private:
  void handle(Client client, Message& message, std::int64_t now_us);  // takes an image out of it
  void tell_stored(Client client, const std::string& device,
                   const std::variant<std::string, Refused>& stored);
  void send(Client client, const std::vector<Message>& messages);

  Server server_;
  RobotProtocol protocol_;
  ImageWriter images_;
  RobotLink& robot_;
  std::optional<Client> controller_;
  std::optional<Client> patient_sensor_;  // who measures the patient's motion
  Client asked_ = 0;                      // the client of the last command: answers that had to wait are its
};

}  // namespace biopsy::igtl
