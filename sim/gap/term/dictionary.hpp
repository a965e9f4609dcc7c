// What a proposed term may be made of: products of motion and drive, and their values along the recording.
#pragma once

#include <vector>

#include "sim/gap/select/evidence_runs.hpp"
#include "sim/term/term.hpp"

namespace biopsy::sim::gap {

struct DictionaryEntry {
  TermPowers powers{};
  double memory_time = 0.0;  // s, where it has memory
  double period = 0.0;       // m, where it repeats with position
  double exponent = 0.0;     // of a power of the speed, where it has one
};

// Products of low degree, and what repeats at least once over the `travel` [m]. Those of the baseline and of
// the library are among them, as parts of a longer equation.
std::vector<DictionaryEntry> dictionary(double travel);

// Motion and drive at every row of all runs, one run after the other.
struct MotionRows {
  std::vector<TermPoint> points;  // memory is not filled
  std::vector<double> times;      // s, of the row's span
  std::vector<bool> begins;       // a run or a window begins with this row

  TermRanges ranges() const;
};

// Those that the recording tells apart: without each that is a multiple of one before it, as u^2 is of a
// constant where |u| is the same throughout.
std::vector<DictionaryEntry> distinct_entries(const MotionRows& motion);

// As measured: smoothed as much as the noise requires, standing where the speed is within its noise. The
// voltage that pulls is the model's.
MotionRows measured_motion(const PlantModel& model, const Evidence& evidence);
// As the model moves.
MotionRows simulated_motion(const PlantModel& model, const Evidence& evidence);

// The term's memory with that time constant: term.hpp.
std::vector<double> memory_of(const MotionRows& motion, double time);

// A product of a term, with the numbers that the term has beside its coefficients.
inline DictionaryEntry entry_of(const TermPart& part, const Term& term) {
  return {.powers = part.powers,
          .memory_time = term.memory_time,
          .period = term.period,
          .exponent = term.exponent};
}

// The entry's product at every row, SI.
std::vector<double> values_of(const DictionaryEntry& entry, const MotionRows& motion);

}  // namespace biopsy::sim::gap
