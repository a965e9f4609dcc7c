#include "sim/gap/term/term_meaning.hpp"

namespace biopsy::sim::gap {

std::string term_meaning(const TermPowers& strongest, bool on_stack) {
  const auto power = [&](TermFactor factor) { return power_of(strongest, factor); };
  const int position = power(TermFactor::Position);
  const int drive = power(TermFactor::Drive) + power(TermFactor::DriveSize) + power(TermFactor::DriveSign);
  const int speed = power(TermFactor::Speed) + power(TermFactor::SpeedSize) + power(TermFactor::SpeedPower);
  if (power(TermFactor::Memory) > 0)
    return "a spring with a damper in series, such as tubing, a cable, an adhesive or tissue that relaxes";
  if (repeats_with_position(strongest))
    return "a force that repeats along the way, such as the cogging of a motor, detents, a gear or a screw";
  if (acts_at_rest(strongest)) {
    if (drive > 0)
      return on_stack ? "dry friction that changes with the voltage, such as films that cling"
                      : "dry friction that changes with the driving force, such as a load on the guide";
    if (position > 0)
      return "dry friction that depends on the place, such as a guide that is bent, worn or loaded on one "
             "side";
    return "dry friction of another kind than the library's";
  }
  if (drive > 0 && speed > 0) return "damping that changes with the drive";
  if (drive > 0 && position > 0)
    return on_stack ? "a pull that depends on the place, such as electrodes that overlap less as they move"
                    : "a drive whose force depends on the place, such as a coil that leaves its magnet";
  if (drive > 0)
    return on_stack ? "a pull of the voltage on plate A besides that of the pouches, or a pressure that is "
                      "not in proportion to its square"
                    : "a drive whose force is not in proportion to the one recorded";
  if (position > 0 && speed > 0)
    return "damping that depends on the place, such as a guide that is rough or dirty there, or a damper "
           "whose "
           "gap changes";
  if (speed > 0 && (power(TermFactor::Speed) + power(TermFactor::SpeedSign)) % 2 == 0)
    return "a force of one direction that grows with the speed of either, such as of a flow";
  if (power(TermFactor::SpeedPower) > 0)
    return "a drag that grows with a power of the speed, such as of a lubricated contact or a paste that "
           "thins as it flows";
  if (speed > 0)
    return "a drag that grows otherwise than with the speed or its square, such as flow through a gap, a "
           "seal "
           "or eddy currents";
  if (position == 0) return "a constant push";
  return position % 2 == 0 ? "a spring that is stiffer to one side, such as a flexure, a cable, a magnet or "
                             "a weight on a lever"
                           : "a spring that stiffens or yields with its travel";
}

}  // namespace biopsy::sim::gap
