// Steps of one model, with what they share worked out once: for runs of many steps.
#pragma once

#include "sim/plant/circuit.hpp"
#include "sim/plant/mechanics.hpp"

namespace biopsy::sim {

class Stepper {
 public:
  explicit Stepper(const PlantModel& model);

  // As step(), to the bit; in place. `model`: the one that this was made of, unchanged.
  void advance(const PlantModel& model, PlantState& state, const PlantInputs& inputs, Seconds duration);

 private:
  ActiveTerms has_;
  double mass_;  // kg, of plate A
  Circuit circuit_;
};

}  // namespace biopsy::sim
