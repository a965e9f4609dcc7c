// rogue DOMAIN [KEYS]: shouts on the robot's domain permits, requests and stops, until it is killed. With the
// folder of a set of keys it is that set's controller, and shouts requests, which is all its own bus lets it.
#include <chrono>
#include <cstdlib>
#include <optional>
#include <thread>

#include "robot/msg/messages.hpp"
#include "robot/security/cyclone_xml.hpp"
#include "robot/transport/bus.hpp"

int main(int count, char** argv) {
  using namespace biopsy;
  const auto domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  security::CycloneOptions options;
  if (count > 2) options.security = security::Security{argv[2], security::Role::Controller};
  const transport::Participant bus({domain, security::cyclone_xml(options), 1});
  transport::Writer<DriveRequest> requests(bus);
  std::optional<transport::Writer<Permit>> permits;
  std::optional<transport::Writer<OperatorAct>> acts;
  if (!options.security) permits.emplace(bus), acts.emplace(bus);
  Permit permit;
  permit.session = 0xffff'ffff;
  permit.ttl_us = 5'000;
  permit.mode = Mode::Active;
  permit.stop = StopCategory::None;
  permit.hv_enable = true;
  permit.v_max_mV = 8'000'000;
  permit.slew_up_mV_per_tick = 400'000;
  DriveRequest request;
  request.wanted_mV = 8'000'000;
  OperatorAct act;
  act.stop = StopCategory::C0Off;
  for (;;) {
    ++permit.seq;
    ++request.seq;
    ++act.seq;
    requests.write(request);
    if (permits) permits->write(permit);
    if (acts) acts->write(act);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}
