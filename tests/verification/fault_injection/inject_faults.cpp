// Fault injection on the virtual clock: every class of faults, many random runs, one table. Exit 0 if nothing
// was missed, 3 if something was, 2 for bad usage.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tests/source_dir.hpp"
#include "tests/verification/fault_injection/campaign.hpp"
#include "tests/verification/fault_injection/evidence_file.hpp"
#include "tests/verification/fault_injection/trace_text.hpp"

namespace {

using namespace biopsy::proof;

struct Options {
  std::string json, only, story;
  std::int32_t runs = 299;
  std::uint64_t seed = 1;
};

std::optional<Options> parse(int count, char** words) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--quick") {
      options.runs = 12;
      continue;
    }
    if (i + 1 == count) return std::nullopt;
    const std::string value = words[++i];
    try {
      if (word == "--json")
        options.json = value;
      else if (word == "--class")
        options.only = value;
      else if (word == "--story")
        options.story = value;
      else if (word == "--runs")
        options.runs = std::stoi(value);
      else if (word == "--seed")
        options.seed = std::stoull(value);
      else
        return std::nullopt;
    } catch (const std::exception&) {
      return std::nullopt;
    }
  }
  return options.runs > 0 ? std::optional(options) : std::nullopt;
}

int usage() {
  fmt::print(
      stderr,
      "inject_faults [--json FILE] [--quick] [--class R-nn] [--runs N] [--seed S] [--story CLASS:RUN]\n");
  return 2;
}

const FaultClass* find(const std::vector<FaultClass>& faults, const std::string& id) {
  for (const FaultClass& fault : faults)
    if (fault.id == id) return &fault;
  return nullptr;
}

int tell(const Campaign& campaign, const std::vector<FaultClass>& faults, const std::string& which) {
  const std::size_t colon = which.find(':');
  const FaultClass* fault = find(faults, which.substr(0, colon));
  if (fault == nullptr || colon == std::string::npos) return usage();
  const std::uint64_t run = std::strtoull(which.c_str() + colon + 1, nullptr, 10);
  fmt::print("{}", story_of(*fault, run_one(campaign, *fault, run)));
  return 0;
}

void print(const std::vector<Tally>& tallies) {
  fmt::print("{:<18}{:>5}{:>6}{:>8}{:>6}{:>6}{:>7}{:>13}{:>13}{:>9}{:>9}{:>7}{:>8}\n", "class", "runs",
             "found", "another", "late", "miss", "unseen", "detect ms", "react ms", "in all", "deep mm", "kV",
             "cover");
  for (const Tally& t : tallies) {
    fmt::print("{:<18}{:>5}{:>6}{:>8}{:>6}{:>6}{:>7}{:>6} /{:>5}{:>6} /{:>5}{:>9}{:>9.2f}{:>7.2f}{:>8.3f}",
               t.fault->id, t.runs, t.detected, t.by_another, t.late, t.missed, t.not_shown, t.detect_ms,
               t.fault->detect_ms, t.react_ms, t.fault->react_ms, t.from_fault_ms, t.beyond_mm, t.highest_kV,
               t.coverage());
    if (t.too_deep + t.too_high + t.rose > 0)
      fmt::print("  deep {} high {} rose {}", t.too_deep, t.too_high, t.rose);
    if (!t.bad.empty()) fmt::print("  see --story {}:{}", t.fault->id, t.bad.front());
    fmt::print("\n");
  }
}

nlohmann::json row(const Tally& t) {
  return {{"class", t.fault->id},
          {"what", t.fault->what},
          {"runs", t.runs},
          {"detected", t.detected},
          {"detected_by_another", t.by_another},
          {"late", t.late},
          {"misses", t.missed + t.not_shown},
          {"worst_detection_ms", t.detect_ms},
          {"allowed_detection_ms", t.fault->detect_ms},
          {"worst_reaction_ms", t.react_ms},
          {"allowed_reaction_ms", t.fault->react_ms},
          {"worst_from_fault_ms", t.from_fault_ms},
          {"worst_beyond_target_mm", t.beyond_mm},
          {"fault_moves_needle", t.fault->moves_needle},
          {"highest_kV", t.highest_kV},
          {"coverage_lower_95", t.coverage()},
          {"story_of_first_bad", t.bad.empty() ? "" : fmt::format("{}:{}", t.fault->id, t.bad.front())}};
}

nlohmann::json figures_of(const std::vector<Tally>& tallies, double seconds) {
  nlohmann::json figures{{"classes", tallies.size()}, {"seconds", seconds}};
  std::int64_t runs = 0, misses = 0, late = 0, deep = 0, high = 0, rose = 0;
  double least = 1.0, driven_mm = 0.0;
  for (const Tally& t : tallies) {
    runs += t.runs, misses += t.missed + t.not_shown, late += t.late;
    deep += t.too_deep, high += t.too_high, rose += t.rose;
    least = std::min(least, t.coverage());
    if (!t.fault->moves_needle) driven_mm = std::max(driven_mm, t.beyond_mm);
  }
  figures["runs"] = runs;
  figures["fewest_runs_per_class"] = tallies.empty() ? 0 : tallies.front().runs;
  figures["misses"] = misses;
  figures["late"] = late;
  figures["too_deep"] = deep;
  figures["over_voltage"] = high;
  figures["voltage_rose_after_stop"] = rose;
  figures["least_coverage_lower_95"] = least;
  figures["worst_beyond_target_mm"] = driven_mm;
  return figures;
}

}  // namespace

int main(int count, char** words) {
  const std::optional<Options> options = parse(count, words);
  if (!options) return usage();
  const Workshop workshop = open_workshop(biopsy::source_dir() / "sim/models");
  const Campaign campaign{workshop, options->seed, 0};
  std::vector<FaultClass> faults = all_faults();
  if (!options->story.empty()) return tell(campaign, faults, options->story);
  if (!options->only.empty()) {
    if (find(faults, options->only) == nullptr) return usage();
    std::erase_if(faults, [&](const FaultClass& fault) { return fault.id != options->only; });
  }
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Tally> tallies = run_all(campaign, faults, options->runs, [](double share) {
    fmt::print(stderr, "\rinjecting faults: {:3.0f} %", 100.0 * share);
  });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  fmt::print(stderr, "\n");
  print(tallies);
  const bool passed = std::ranges::all_of(tallies, &Tally::holds);
  nlohmann::json out{
      {"tool", "inject_faults"}, {"passed", passed}, {"figures", figures_of(tallies, seconds)}};
  for (const Tally& tally : tallies) out["tables"]["classes"].push_back(row(tally));
  if (!options->json.empty() && !write_json(options->json, out)) return 2;
  return passed ? 0 : 3;
}
