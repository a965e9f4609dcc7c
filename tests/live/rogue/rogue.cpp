// A participant without keys that shouts on the robot's domain: permits, requests, stops. Until it is killed.
#include <chrono>
#include <cstdlib>
#include <thread>

#include "robot/keys/cyclone_xml.hpp"
#include "robot/messages/drive_request.hpp"
#include "robot/messages/live.hpp"
#include "robot/messages/permit.hpp"
#include "robot/transport/bus.hpp"

int main(int, char** argv) {
  using namespace biopsy;
  const auto domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  const transport::Participant bus({domain, keys::cyclone_xml({}), 1});
  transport::Writer<Permit> permits(bus);
  transport::Writer<DriveRequest> requests(bus);
  transport::Writer<OperatorAct> acts(bus);
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
    permits.write(permit);
    requests.write(request);
    acts.write(act);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}
