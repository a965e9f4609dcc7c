// What every effect says about itself. An effect is one physical term that can be absent; absent is exactly
// the baseline. Its file holds the parameters (SI inside, people's units in files), the equation and where it
// attaches.
#pragma once

#include <span>
#include <string_view>

namespace biopsy::sim {

enum class Attachment { Electrical, Pouch, Stage, Tissue, Sensor };

// What a number does in its effect; tells a search where to begin.
enum class Role {
  Strength,   // all strengths 0: the effect is absent, exactly
  Shape,      // how it acts; the typical value is a start, within a factor of ten or so
  Place,      // where along the displacement it acts
  Level,      // above which voltage it acts
  Frequency,  // to be read off a spectrum
  Phase,
};

inline constexpr bool kMayBeLeftOut = true;

template <class Effect>
struct Parameter {
  std::string_view name;   // with its unit, as it stands in files
  double Effect::*member;  // SI
  double si_per_unit;      // SI value of one file unit
  double low, high;        // sensible range, file units
  double typical;          // file units
  std::string_view meaning;
  Role role = Role::Strength;
  bool optional = false;  // may be left out of a file, and is then 0
};

struct EffectInfo {
  std::string_view name;
  Attachment attaches;
  std::string_view sentence;  // for a person
  std::string_view equation;
  std::string_view experiment;  // that would show it most clearly
  std::string_view source;
};

}  // namespace biopsy::sim
