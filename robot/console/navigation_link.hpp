// The console's side of the bus to a navigation program.
#pragma once

#include <cstdint>
#include <optional>

#include "robot/msg/messages.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::robot {

class NavigationLink {
 public:
  explicit NavigationLink(const transport::Participant& bus) : requests_(bus), replies_(bus) {}

  // The newest request; nothing where no program is there, or more than one.
  std::optional<NavigationRequest> newest(std::int64_t now_us);
  // Sent where it changed, and often enough to be seen alive.
  void answer(NavigationReply reply, std::int64_t now_us);

 private:
  transport::Reader<NavigationRequest> requests_;
  transport::Writer<NavigationReply> replies_;
  NavigationRequest request_;
  NavigationReply reply_;
  bool alone_ = false;
  std::int64_t looked_us_ = 0, sent_us_ = 0;
};

}  // namespace biopsy::robot
