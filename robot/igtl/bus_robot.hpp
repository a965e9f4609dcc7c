// The robot over its bus: what supervisor, stage and console tell, and what this program wishes of the
// console. Its role on the bus can write nothing else.
#pragma once

#include "robot/igtl/navigation_server.hpp"
#include "robot/live/heartbeat.hpp"
#include "robot/msg/messages.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::igtl {

NavigationRequest request_of(const Wish& wish);  // seq is the sender's

class BusRobot : public RobotLink {
 public:
  BusRobot(const transport::Participant& bus, std::uint64_t config_tag);

  RobotView view(std::int64_t now_us) override;
  void tell(const Wish& wish, std::int64_t now_us) override;

 private:
  transport::Reader<Measurement> measurements_;
  transport::Reader<Decision> decisions_;
  transport::Reader<NavigationReply> replies_;
  transport::Writer<NavigationRequest> requests_;
  live::Heartbeat heartbeat_;
  Measurement measurement_;
  Decision decision_;
  NavigationReply reply_;
  NavigationRequest request_;
  std::int64_t measured_us_ = 0, decided_us_ = 0, replied_us_ = 0, sent_us_ = 0;
};

}  // namespace biopsy::igtl
