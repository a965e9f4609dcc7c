// Every input that can make a difference in a mode, as a product of small dimensions; and what "worse" means.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "safety/supervisor.hpp"
#include "tests/safety/situation.hpp"

namespace biopsy::model_checking {

using safety::Situation;
using safety::SupervisorState;

// One digit each. A dimension that decides nothing in a mode has one value there; equivalent_steps check that
// it does not.
enum class Dimension : std::uint8_t {
  Hazards,  // none, every combination of the classes (locking, C0, C1, C2)
  Stop,     // None .. C0Off
  ZeroVolts,
  ArmKey,
  ResetKey,
  Motion,  // {nothing, an old token, the present one, a new one} x {let go, held}
  SelfTest,
  NeedleHome,
  Request,  // {reached, finished} x {this step, another}
  Depth,    // refused, accepted, accepted for the next step, accepted for the one before
  Drive,    // {|V|, ceiling}: both 0, both 1 mV, all under no ceiling, all
  Network,  // {arm} x {reset} asked over it
  Image,    // being taken, not
  Brake,    // none fitted, off, on, on with the needle still
  NeedleBack,
};
inline constexpr std::size_t kDimensions = 15;
using Digits = std::array<std::uint8_t, kDimensions>;

// Which hazard of a class is present decides nothing but its name: equivalents have each of them, alone too.
enum class Grain : std::uint8_t {
  Thin,   // no hazard; drive: 0 and all
  Quick,  // hazards: none, one of each class, C0 with C1, all classes; drive: 0, all, all under no ceiling
  Full,
};
constexpr std::string_view name_of(Grain grain) {
  constexpr std::string_view kNames[] = {"thin", "quick", "full"};
  return kNames[static_cast<std::size_t>(grain)];
}

// From value `first` to value `second` of a dimension the input becomes worse in one respect.
using Worsening = std::pair<std::uint8_t, std::uint8_t>;

class InputSpace {
 public:
  InputSpace(Mode mode, Grain grain);

  std::uint32_t size() const { return size_; }
  std::uint32_t size_of(Dimension d) const { return sizes_[static_cast<std::size_t>(d)]; }
  std::uint32_t stride_of(Dimension d) const { return strides_[static_cast<std::size_t>(d)]; }
  Digits digits(std::uint32_t index) const;
  Situation at(std::uint32_t index, const SupervisorState& state) const;
  // Writes one dimension's value into an input.
  void put(Situation& input, Dimension d, std::uint8_t value, const SupervisorState& state) const;
  // The covering pairs of "worse", which generate the whole order.
  const std::vector<Worsening>& worse(Dimension d) const { return worse_[static_cast<std::size_t>(d)]; }

  // Calls visit(index, input) for every input from `first` up to `end`, in order of index.
  template <class Visit>
  void for_each(std::uint32_t first, std::uint32_t end, const SupervisorState& state, Visit&& visit) const {
    Digits digit = digits(first);
    Situation input = at(first, state);
    for (std::uint32_t index = first;;) {
      visit(index, input);
      if (++index == end) return;
      std::size_t d = 0;
      while (++digit[d] == sizes_[d]) {
        digit[d] = 0;
        put(input, static_cast<Dimension>(d), 0, state);
        ++d;
      }
      put(input, static_cast<Dimension>(d), digit[d], state);
    }
  }

 private:
  void set_sizes(Mode mode);
  void set_worse(Mode mode);

  struct Drive {
    std::int32_t drive_mV, ceiling_mV;
  };
  static std::vector<Drive> drive_values(Grain grain);

  std::vector<safety::HazardSet> hazards_;
  std::vector<Drive> drives_;
  std::array<std::uint32_t, kDimensions> sizes_{}, strides_{};
  std::array<std::vector<Worsening>, kDimensions> worse_;
  std::uint32_t size_ = 1;
};

// One hazard that stands for each class: locking, C0, C1, C2.
inline constexpr std::array kClassHazard{safety::Hazard::ResidualCharge, safety::Hazard::EStop,
                                         safety::Hazard::OverDepth, safety::Hazard::StepDepth};
// All members of the class that `hazard` stands for.
safety::HazardSet class_of(safety::Hazard hazard);

}  // namespace biopsy::model_checking
