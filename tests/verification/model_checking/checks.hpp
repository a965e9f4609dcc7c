// The parts of the proof. Each adds its figures and tables to the report and what does not hold to its
// verdict.
#pragma once

#include "tests/verification/evidence_program.hpp"
#include "tests/verification/model_checking/seeded_bugs/mutant_build.hpp"

namespace biopsy::model_checking {

// Every reachable state and input of the shipped step, on every plan.
void check_supervisor(EvidenceReport& report, bool quick);

// The same of the shipped gate.
void check_gate(EvidenceReport& report, bool quick);

// Every seeded bug is found, an unchanged copy is as clean as the shipped code.
void check_bugs(EvidenceReport& report, const MutantBuild& mutant_build);

// Spin, an independent explorer, over the same compiled step.
void check_with_spin(EvidenceReport& report, const MutantBuild& mutant_build);

}  // namespace biopsy::model_checking
