// The parts of the proof. Each adds its figures and tables to the report and what does not hold to its
// verdict.
#pragma once

#include "mutant_build.hpp"
#include "report.hpp"

namespace biopsy::explore {

// Every reachable state and input of the shipped step, on every plan.
void prove_supervisor(Report& report, bool quick);

// The same of the shipped gate.
void prove_gate(Report& report, bool quick);

// Every seeded bug is found, an unchanged copy is as clean as the shipped code.
void prove_bugs(Report& report, const MutantBuild& mutant_build);

// Spin, an independent explorer, over the same compiled step.
void prove_with_spin(Report& report, const MutantBuild& mutant_build);

}  // namespace biopsy::explore
