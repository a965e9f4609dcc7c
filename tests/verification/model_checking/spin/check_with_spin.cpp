#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <regex>
#include <sstream>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/in_parallel.hpp"
#include "tests/verification/model_checking/checks.hpp"

namespace biopsy::model_checking {
namespace {

namespace fs = std::filesystem;

struct Property {
  const char* name;  // of the ltl formula; "assertions" for the first run
  const char* sentence;
};
constexpr std::array kProperties{
    Property{"assertions", "Every input of every mode: 23 assertions on each step."},
    Property{"lock_absorbs", "Lock is never left."},
    Property{"boot_ends", "Boot ends."},
    Property{"armed_ends", "Armed ends, whatever operator and sensors do."},
    Property{"hold_ends", "Hold ends, whatever operator and sensors do."},
    Property{"retract_ends", "Retract ends, whatever operator and sensors do."},
    Property{"trip_stays_until_reset", "Trip stays until the reset key is turned, or ends in Lock."},
    Property{"no_rise_before_arming", "Nothing rises before the arm key was turned."},
    Property{"off_after_a_trip_until_armed",
             "After a trip the drive stays off until the arm key was turned."},
};

struct Verdict {
  std::uint64_t states = 0, transitions = 0, errors = 1;
  double seconds = 0.0;
};

void run(const std::string& command, const fs::path& folder) {
  const std::string all = fmt::format("cd '{}' && ( {} ) > log.txt 2>&1", folder.string(), command);
  if (std::system(all.c_str()) != 0)
    throw ConfigError("Spin's model cannot be built", (folder / "log.txt").string(),
                      "install spin; read the log");
}

// The model checker of one run, against the step compiled with `headers` first on the include path.
fs::path build(const MutantBuild& mutant_build, const std::string& name, const std::string& defines,
               const fs::path& headers) {
  const fs::path folder = mutant_build.bench / name,
                 here = mutant_build.source / "tests/verification/model_checking";
  fs::create_directories(folder);
  fs::copy_file(here / "spin/supervisor.pml", folder / "supervisor.pml",
                fs::copy_options::overwrite_existing);
  const std::string cxx =
      fmt::format("'{}' -std=c++20 -O2 -w -I'{}' -I'{}' -I'{}'", mutant_build.compiler.string(),
                  headers.string(), mutant_build.source.string(), mutant_build.generated.string());
  run(fmt::format("spin {0} -a supervisor.pml && cc -O2 -w -DNOFAIR {1} -I'{2}/spin' -c pan.c && "
                  "{3} -c '{2}/spin/entry.cpp' && {3} -c '{2}/seeded_bugs/shared_object.cpp' && {3} pan.o "
                  "entry.o shared_object.o -o pan",
                  defines, defines.empty() ? "-DSAFETY -DNOCLAIM" : "-DNOREDUCE", here.string(), cxx),
      folder);
  return folder;
}

std::uint64_t number_before(const std::string& text, const std::string& words) {
  std::smatch match;
  return std::regex_search(text, match, std::regex("(\\d+) " + words)) ? std::stoull(match[1]) : 0;
}

Verdict verify(const fs::path& folder, const Property& property) {
  const Stopwatch time;
  const std::string name = property.name, file = name + ".txt";
  const std::string options = name == "assertions" ? "" : "-a -N " + name;
  const std::string command =
      fmt::format("cd '{}' && ./pan -m1000000 -n {} > {} 2>&1", folder.string(), options, file);
  [[maybe_unused]] const int code = std::system(command.c_str());  // the verdict is in its output
  const std::string said = read_file(folder / file);
  Verdict verdict;
  verdict.states = number_before(said, "states, stored");
  verdict.transitions = number_before(said, "transitions");
  std::smatch match;
  const bool complete = said.find("max search depth too small") == std::string::npos;
  if (complete && std::regex_search(said, match, std::regex("errors: (\\d+)")))
    verdict.errors = std::stoull(match[1]);
  verdict.seconds = time.seconds();
  return verdict;
}

// The same model over a step with a seeded bug: Spin must find it, or it sees nothing.
std::uint64_t errors_with_a_bug(const MutantBuild& mutant_build) {
  const SeededBug& bug = *std::ranges::find(seeded_bugs(), "token-not-greater", &SeededBug::id);
  MutantBuild apart = mutant_build;
  apart.bench /= "spin-canary";
  const SeededSubject subject(apart, &bug);
  const fs::path copy = apart.bench / bug.id;
  return verify(build(mutant_build, "spin-canary/pan", "", copy), kProperties[0]).errors;
}

}  // namespace

void check_with_spin(EvidenceReport& report, const MutantBuild& mutant_build) {
  const Stopwatch time;
  const fs::path every_input = build(mutant_build, "spin-every-input", "", mutant_build.source);
  const fs::path every_tick = build(mutant_build, "spin-every-tick", "-DEXACT", mutant_build.source);
  std::array<Verdict, kProperties.size()> verdicts;
  std::mutex mutex;
  in_parallel(kProperties.size(), [&](std::size_t i) {
    verdicts[i] = verify(i == 0 ? every_input : every_tick, kProperties[i]);
    const std::lock_guard lock(mutex);
    fmt::print(stderr, "spin, {}: {} states, {} transitions, {} errors\n", kProperties[i].name,
               verdicts[i].states, verdicts[i].transitions, verdicts[i].errors);
  });
  Verdict sum{0, 0, 0, 0.0};
  for (std::size_t i = 0; i < kProperties.size(); ++i) {
    sum.states += verdicts[i].states;
    sum.transitions += verdicts[i].transitions;
    sum.errors += verdicts[i].errors;
    report.tables["spin"].push_back({{"property", kProperties[i].name},
                                     {"sentence", kProperties[i].sentence},
                                     {"states", verdicts[i].states},
                                     {"transitions", verdicts[i].transitions},
                                     {"errors", verdicts[i].errors},
                                     {"seconds", verdicts[i].seconds}});
  }
  const std::uint64_t canary = errors_with_a_bug(mutant_build);
  report.figures["spin_properties"] = kProperties.size();
  report.figures["spin_states"] = sum.states;
  report.figures["spin_transitions"] = sum.transitions;
  report.figures["spin_errors"] = sum.errors;
  report.figures["spin_errors_with_a_seeded_bug"] = canary;
  report.figures["spin_seconds"] = time.seconds();
  report.require(sum.errors == 0 && canary > 0);
}

}  // namespace biopsy::model_checking
