#include "drivers/digital_io/interlock_relay.hpp"

#include <utility>

namespace biopsy::digital_io {

InterlockRelay::InterlockRelay(const std::filesystem::path& folder, std::int64_t now_ns)
    : out_(folder), in_(folder) {
  open(now_ns);
}

void InterlockRelay::tick(std::int64_t now_ns) {
  const std::int64_t now_us = now_ns / 1'000;
  const std::uint64_t stage = in_.stage_pulses(), supervisor = in_.supervisor_pulses();
  if (std::exchange(stage_pulses_, stage) != stage)
    interlock_ = safety::feed_from_driver(interlock_, ticked_us_);
  if (std::exchange(supervisor_pulses_, supervisor) != supervisor)
    interlock_ = safety::feed_from_supervisor(interlock_, ticked_us_);
  ticked_us_ = now_us;
  closed_ = safety::is_closed(interlock_, now_us + (kRelayPeriod + kRelayLate).count());
  const ConverterOutput output = in_.converter();
  out_.write({closed_ && output.hv_enabled ? output.mV : 0, closed_}, now_ns);
}

void InterlockRelay::open(std::int64_t now_ns) {
  interlock_ = {};
  stage_pulses_ = in_.stage_pulses();
  supervisor_pulses_ = in_.supervisor_pulses();
  ticked_us_ = now_ns / 1'000;
  closed_ = false;
  out_.write({}, now_ns);
}

}  // namespace biopsy::digital_io
