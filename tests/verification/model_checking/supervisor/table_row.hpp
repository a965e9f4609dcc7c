// Rows of the table of transitions, unfolded once: it is asked at every step.
#pragma once

#include <array>
#include <cstddef>

#include "safety/types/transitions.hpp"

namespace biopsy::model_checking {

// {from, event} -> to, as in transitions.hpp.
inline const auto kTo = [] {
  std::array<std::array<Mode, safety::kEvents>, safety::kModes> to{};
  for (std::size_t from = 0; from < safety::kModes; ++from)
    for (std::size_t event = 0; event < safety::kEvents; ++event)
      to[from][event] = safety::next_mode(static_cast<Mode>(from), static_cast<safety::Event>(event));
  return to;
}();
inline bool is_table_row(Mode from, safety::Event event, Mode to) {
  return from <= Mode::Lock && event <= safety::Event::Reset &&
         kTo[static_cast<std::size_t>(from)][static_cast<std::size_t>(event)] == to;
}

}  // namespace biopsy::model_checking
