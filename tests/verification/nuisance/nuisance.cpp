// Hours of healthy procedures on the virtual clock: no trip and no stop that nobody asked for. Exit 0 if
// there was none, 3 if there was one, 2 for bad usage.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <optional>
#include <string>

#include "tests/source_dir.hpp"
#include "tests/verification/fault_injection/evidence_file.hpp"
#include "tests/verification/nuisance/shift.hpp"

namespace {

using namespace biopsy::proof;

struct Options {
  std::string json;
  double hours = 8.0;
  std::uint64_t seed = 1;
};

std::optional<Options> parse(int count, char** words) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--quick") {
      options.hours = 1.0 / 3.0;
      continue;
    }
    if (i + 1 == count) return std::nullopt;
    const std::string value = words[++i];
    try {
      if (word == "--json")
        options.json = value;
      else if (word == "--hours")
        options.hours = std::stod(value);
      else if (word == "--seed")
        options.seed = std::stoull(value);
      else
        return std::nullopt;
    } catch (const std::exception&) {
      return std::nullopt;
    }
  }
  return options.hours > 0.0 && options.hours <= 1'000.0 ? std::optional(options) : std::nullopt;
}

nlohmann::json report(const Shift& day, bool passed, double seconds) {
  nlohmann::json out{{"tool", "nuisance"},
                     {"passed", passed},
                     {"figures",
                      {{"simulated_hours", day.hours},
                       {"procedures", day.procedures},
                       {"completed", day.completed},
                       {"given_up", day.given_up},
                       {"stages", day.stages},
                       {"releases", day.releases},
                       {"trips", day.trips},
                       {"unexpected_holds", day.unexpected_stops},
                       {"punctures_held", day.punctures_held},
                       {"not_completed", day.procedures - day.completed - day.given_up},
                       {"seconds", seconds}}}};
  out["tables"]["alarms"] = nlohmann::json::array();
  for (const Alarm& alarm : day.alarms)
    out["tables"]["alarms"].push_back(
        {{"procedure", alarm.procedure}, {"at_s", alarm.at_s}, {"what", alarm.what}});
  return out;
}

}  // namespace

int main(int count, char** words) {
  const std::optional<Options> options = parse(count, words);
  if (!options) {
    fmt::print(stderr, "nuisance [--json FILE] [--quick] [--hours H] [--seed S]\n");
    return 2;
  }
  const Workshop workshop = open_workshop(biopsy::source_dir() / "sim/models");
  const auto begin = std::chrono::steady_clock::now();
  const Shift day = work(workshop, options->hours, options->seed, {}, [](double share) {
    fmt::print(stderr, "\rhealthy procedures: {:3.0f} %", 100.0 * std::min(share, 1.0));
  });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const bool passed = day.alarms.empty() && day.trips == 0 && day.unexpected_stops == 0;
  fmt::print(
      "\n{:.2f} h, {} procedures ({} completed, {} given up), {} stages, {} releases: {} trips, {} stops "
      "nobody asked for, {} holds after a puncture that truly jumped\n",
      day.hours, day.procedures, day.completed, day.given_up, day.stages, day.releases, day.trips,
      day.unexpected_stops, day.punctures_held);
  for (const Alarm& alarm : day.alarms)
    fmt::print("  procedure {} at {:.2f} s: {}\n", alarm.procedure, alarm.at_s, alarm.what);
  if (!options->json.empty() && !write_json(options->json, report(day, passed, seconds))) return 2;
  return passed ? 0 : 3;
}
