#include "robot/recorder/log_alignment.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace biopsy::recorder {
namespace {

constexpr std::size_t kChangesMax = 2'000;

struct Pair {
  std::int64_t apart_us;
  std::size_t change;  // of the run
};

std::vector<Pair> pairs_of(const std::vector<ModeChange>& run, const std::vector<ModeChange>& log) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < std::min(run.size(), kChangesMax); ++i)
    for (std::size_t k = 0; k < std::min(log.size(), kChangesMax); ++k)
      if (run[i].mode == log[k].mode) pairs.push_back({log[k].at_us - run[i].at_us, i});
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return a.apart_us != b.apart_us ? a.apart_us < b.apart_us : a.change < b.change;
  });
  return pairs;
}

}  // namespace

std::optional<Mode> mode_named(std::string_view name) {
  for (const Mode mode : all_values<Mode>())
    if (name_of(mode) == name) return mode;
  return std::nullopt;
}

std::vector<ModeChange> mode_changes(const std::vector<Record>& records) {
  std::vector<ModeChange> changes;
  for (const Record& record : records) {
    if (record.kind != name_of(RecordKind::StateChange)) continue;
    const nlohmann::json body = nlohmann::json::parse(record.body, nullptr, false);
    const auto mode = body.is_object() ? body.find("mode") : body.end();
    if (!body.is_object() || mode == body.end() || !mode->is_string()) continue;
    if (const auto value = mode_named(mode->get_ref<const std::string&>()))
      changes.push_back({record.mono_us, *value});
  }
  return changes;
}

std::optional<Alignment> align(const std::vector<ModeChange>& run, const std::vector<ModeChange>& log) {
  const std::vector<Pair> pairs = pairs_of(run, log);
  std::vector<int> times(run.size(), 0);  // that a change is in the window
  std::size_t distinct = 0;
  std::optional<Alignment> best;
  std::size_t first = 0;
  for (std::size_t last = 0; last < pairs.size(); ++last) {
    if (times[pairs[last].change]++ == 0) ++distinct;
    // Shorter at its beginning: what is too early, or is there once more.
    while (pairs[last].apart_us - pairs[first].apart_us > kSpreadMax_us || times[pairs[first].change] > 1) {
      if (--times[pairs[first].change] == 0) --distinct;
      ++first;
    }
    const std::int64_t spread_us = pairs[last].apart_us - pairs[first].apart_us;
    if (distinct < 2 ||
        (best && (distinct < best->matched || (distinct == best->matched && spread_us >= best->spread_us))))
      continue;
    best = Alignment{pairs[first + (last - first) / 2].apart_us, distinct, spread_us};
  }
  return best;
}

}  // namespace biopsy::recorder
