// Exhaustive exploration of the shipped supervisor and gate, and the checks that it would find a mistake.
#include <array>

#include "robot/common/in_parallel.hpp"
#include "tests/source_dir.hpp"
#include "tests/verification/evidence_program.hpp"
#include "tests/verification/model_checking/checks.hpp"

namespace {

using namespace biopsy;

struct Options {
  model_checking::MutantBuild mutant_build{source_dir(), binary_dir() / "generated", BIOPSY_CXX,
                                           BIOPSY_BENCH};
  bool quick = false, bugs = false, spin = false;
};

EvidenceReport check(const Options& options) {
  const Stopwatch time;
  EvidenceReport report;
  std::array<EvidenceReport, 2> parts;
  in_parallel(parts.size(), [&](std::size_t i) {
    const auto check = i == 0 ? model_checking::check_supervisor : model_checking::check_gate;
    check(parts[i], options.quick);
  });
  for (const EvidenceReport& part : parts) report.add(part);
  const auto figure = [&](const std::string& name) { return report.figures[name].get<std::uint64_t>(); };
  for (const std::string what : {"transitions", "states", "violations"})
    report.figures[what] = figure("supervisor_" + what) + figure("gate_" + what);
  report.figures["seconds"] = time.seconds();
  if (options.bugs) model_checking::check_bugs(report, options.mutant_build);
  if (options.spin) model_checking::check_with_spin(report, options.mutant_build);
  for (const auto& [name, value] : report.figures.items()) fmt::print("{:32} {}\n", name, value.dump());
  return report;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Every reachable state and input of the shipped supervisor and gate, against every invariant"};
  app.add_flag("--quick", options.quick, "one hazard of each class instead of all combinations");
  app.add_flag("--bugs", options.bugs, "also find the seeded bugs");
  app.add_flag("--spin", options.spin, "also check Spin's model");
  app.add_option("--bench", options.mutant_build.bench, "folder for copies and models")
      ->capture_default_str();
  return evidence_program("explore", app, argc, argv, [&] { return check(options); });
}
