// The procedure log counts time on the computer's clock, run.csv from the run's first tick. Both hold the
// changes of the supervisor's state, which tell where the run lies in the log.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "robot/msg/fixed_messages.hpp"
#include "robot/recorder/record.hpp"

namespace biopsy::recorder {

struct ModeChange {
  std::int64_t at_us = 0;  // on its own clock
  Mode mode = Mode::Boot;  // from then on
};

// As logs and run.csv name it: "armed".
std::optional<Mode> mode_named(std::string_view name);

// The state changes of a log, on its monotonic clock; records that name no state are left out.
std::vector<ModeChange> mode_changes(const std::vector<Record>& records);

struct Alignment {
  std::int64_t zero_us = 0;    // the log's time at the run's zero
  std::size_t matched = 0;     // changes of the run that the log has too
  std::int64_t spread_us = 0;  // between the earliest and the latest of them
};

inline constexpr std::int64_t kSpreadMax_us = 100'000;

// The place where most changes of the run are in the log within kSpreadMax_us; of several such places the one
// with the least spread. None: fewer than two match. A log may hold several runs, and each side may lack
// changes. Looks at the first 2,000 changes of each.
std::optional<Alignment> align(const std::vector<ModeChange>& run, const std::vector<ModeChange>& log);

}  // namespace biopsy::recorder
