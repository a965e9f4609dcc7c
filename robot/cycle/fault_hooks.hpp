// Where fault injection wraps the inputs of the three functions of a cycle. The shipped hooks change nothing.
#pragma once

#include "safety/monitors/evidence.hpp"
#include "safety/types/supervisor_inputs.hpp"

namespace biopsy::robot {

struct GateInputs;

class FaultHooks {
 public:
  virtual ~FaultHooks() = default;
  virtual void before_monitors(safety::SupervisorInputs&) {}
  virtual void before_decision(safety::SupervisorInputs&, safety::Evidence&) {}
  virtual void before_gate(GateInputs&) {}
};

}  // namespace biopsy::robot
