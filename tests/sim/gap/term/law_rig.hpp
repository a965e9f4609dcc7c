// Recordings of a mass on a spring under a force law that is no effect of the library. Made without sim/:
// classical Runge-Kutta in short steps.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>

#include "sim/plant/dataset.hpp"
#include "tests/sim/gap/generator/hidden_physics.hpp"

namespace biopsy::hidden {

struct LawPoint {
  double x, v, drive, memory;  // m, m/s, N, m: of a damper in series, with the law's time
};

struct ForceLaw {
  std::string name;
  std::set<char> variables;  // of x, v, u (drive), q (memory)
  std::function<double(const LawPoint&)> force = [](const LawPoint&) { return 0.0; };  // N, up
  double memory_time = 1.0;                                                            // s
};

struct LawRig {
  double mass = 0.4, hertz = 2.5, damping_ratio = 0.15;  // kg, Hz, -
  ForceLaw law;
  double shocks = 0.0;  // N, of random pushes that no state explains
  double wander = 0.0;  // m, of the reading, with a memory of 0.7 s
};

// `share` of the drive where position, speed and drive have the rig's usual sizes.
std::vector<ForceLaw> outside_laws(const LawRig& rig, double share, Dice& dice);

// The same for cogging, a drag of a power near the root and dry friction along the way.
std::vector<ForceLaw> sliding_laws(const LawRig& rig, double share, Dice& dice);

// The same for laws that no finite sum of products gives: bumps, ledges, roots, exponentials.
std::vector<ForceLaw> curved_laws(const LawRig& rig, double share, Dice& dice);

// Drawn: mass 0.2 to 0.8 kg, 1.5 to 4 Hz, damping 0.05 to 0.3.
LawRig drawn_rig(Dice& dice);

// Four runs of 8 s at 250 Hz: multisines and steps. Readings in m with white noise [m].
sim::Dataset law_recording(const LawRig& rig, double noise, std::uint64_t seed);

// Whether a reading is far beyond the rig's usual sizes, or no number.
bool runs_away(const LawRig& rig, const sim::Dataset& recording);

// The linear part as a model file, each number wrong by up to 1.5 %.
std::string law_rig_model(const LawRig& rig, Dice& dice);

}  // namespace biopsy::hidden
