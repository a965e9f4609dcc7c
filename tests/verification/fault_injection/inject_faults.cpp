// Every class of faults in many random procedures: what was detected, and how fast.
#include <algorithm>

#include "tests/source_dir.hpp"
#include "tests/verification/evidence_program.hpp"
#include "tests/verification/fault_injection/campaign.hpp"
#include "tests/verification/fault_injection/trace_text.hpp"

namespace {

using namespace biopsy::fault_injection;

struct Options {
  std::string only, trace;
  bool quick = false;
  std::int32_t runs = 299;
  std::uint64_t seed = 1;
};

const FaultClass& find(const std::vector<FaultClass>& faults, const std::string& id) {
  const auto fault = std::ranges::find(faults, id, &FaultClass::id);
  if (fault == faults.end())
    throw biopsy::ConfigError("no such class of faults", id, "see the table of a run without options");
  return *fault;
}

// `which`: CLASS:RUN.
void print_trace(const Campaign& campaign, const std::vector<FaultClass>& faults, const std::string& which) {
  const std::size_t colon = std::min(which.find(':'), which.size() - 1);
  const FaultClass& fault = find(faults, which.substr(0, colon));
  fmt::print("{}", trace_text(fault, run_one(campaign, fault,
                                             std::strtoull(which.c_str() + colon + 1, nullptr, 10))));
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
    if (!t.bad.empty()) fmt::print("  see --trace {}:{}", t.fault->id, t.bad.front());
    fmt::print("\n");
  }
}

nlohmann::ordered_json row(const Tally& t) {
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
          {"trace_of_first_bad", t.bad.empty() ? "" : fmt::format("{}:{}", t.fault->id, t.bad.front())}};
}

nlohmann::ordered_json figures_of(const std::vector<Tally>& tallies, double seconds) {
  nlohmann::ordered_json figures{{"classes", tallies.size()}, {"seconds", seconds}};
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

biopsy::EvidenceReport inject(const Options& options) {
  const NominalModels models = read_nominal_models(biopsy::source_dir() / "sim/models");
  const Campaign campaign{models, options.seed, 0};
  std::vector<FaultClass> faults = all_faults();
  if (!options.trace.empty()) return print_trace(campaign, faults, options.trace), biopsy::EvidenceReport{};
  if (!options.only.empty()) faults = {find(faults, options.only)};
  const biopsy::Stopwatch time;
  const std::vector<Tally> tallies =
      run_all(campaign, faults, options.quick ? 12 : options.runs,
              [](double share) { fmt::print(stderr, "\rinjecting faults: {:3.0f} %", 100.0 * share); });
  fmt::print(stderr, "\n");
  print(tallies);
  biopsy::EvidenceReport report{.passed = std::ranges::all_of(tallies, &Tally::holds),
                                .figures = figures_of(tallies, time.seconds())};
  for (const Tally& tally : tallies) report.tables["classes"].push_back(row(tally));
  return report;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Fault injection on the virtual clock: every class of faults, many random runs, one table"};
  app.add_flag("--quick", options.quick, "12 runs of each class");
  app.add_option("--class", options.only, "this class only, as R-06");
  app.add_option("--runs", options.runs, "of each class")->check(CLI::PositiveNumber);
  app.add_option("--seed", options.seed, "of all random choices");
  app.add_option("--trace", options.trace, "print one run tick by tick: CLASS:RUN");
  return biopsy::evidence_program("inject_faults", app, argc, argv, [&] { return inject(options); });
}
