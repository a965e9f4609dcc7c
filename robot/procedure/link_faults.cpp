#include "robot/procedure/link_faults.hpp"

#include "sim/plant/seeded_noise.hpp"

namespace biopsy::robot {

using sim::FaultKind;
using sim::FaultSignal;

bool LinkFaults::is_lost(std::size_t i) {
  const sim::Fault& fault = stage_.faults()[i];
  return fault.kind == FaultKind::Dropout &&
         sim::uniform(sim::hashed(seed_, 0x6c696e6b), draws_++) < fault.value;
}

void LinkFaults::corrupt_contact(std::size_t i, bool& closed) {
  const sim::Fault& fault = stage_.faults()[i];
  if (!stage_.shows(i)) {
    contacts_[i] = closed;
    return;
  }
  if (fault.kind == FaultKind::Frozen) closed = contacts_[i];
  if (fault.kind == FaultKind::Inverted) closed = !closed;
  if (fault.kind == FaultKind::OtherSurface) closed = fault.value >= 0.5;
}

void LinkFaults::before_monitors(safety::SupervisorInputs& in) {
  for (std::size_t i = 0; i < stage_.faults().size(); ++i) {
    const sim::Fault& fault = stage_.faults()[i];
    const bool shows = stage_.shows(i);
    switch (fault.signal) {
      case FaultSignal::Measurement:
        in.measurement = measurements_[i].arriving(fault, shows, shows && is_lost(i), in.measurement);
        break;
      case FaultSignal::Request:
        in.request = requests_[i].arriving(fault, shows, shows && is_lost(i), in.request);
        break;
      case FaultSignal::EStopA:
        corrupt_contact(i, in.estop_a_closed);
        break;
      case FaultSignal::EStopB:
        corrupt_contact(i, in.estop_b_closed);
        break;
      case FaultSignal::ArmKey:
        corrupt_contact(i, in.local_arm);
        break;
      case FaultSignal::ResetKey:
        corrupt_contact(i, in.local_reset);
        break;
      case FaultSignal::Relay:
        corrupt_contact(i, in.relay_closed);
        break;
      default:
        break;
    }
  }
}

void LinkFaults::before_gate(GateInputs& in) {
  for (std::size_t i = 0; i < stage_.faults().size(); ++i) {
    const sim::Fault& fault = stage_.faults()[i];
    const bool shows = stage_.shows(i);
    if (fault.signal == FaultSignal::Request)
      in.request = gate_requests_[i].arriving(fault, shows, shows && is_lost(i), in.request);
    if (fault.signal == FaultSignal::Permit)
      in.permit = permits_[i].arriving(fault, shows, shows && is_lost(i), in.permit);
  }
}

}  // namespace biopsy::robot
