// Exhaustive exploration of the shipped supervisor and gate, and what shows that it would see a mistake.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>

#include "parts.hpp"
#include "robot/common/config_error.hpp"
#include "tests/source_dir.hpp"

namespace {

using namespace biopsy;

struct Options {
  std::filesystem::path json;
  explore::MutantBuild mutant_build{source_dir(), binary_dir() / "generated", BIOPSY_CXX, BIOPSY_BENCH};
  bool quick = false, bugs = false, spin = false;
};

explore::Report prove(const Options& options) {
  const auto start = std::chrono::steady_clock::now();
  explore::Report report;
  explore::prove_supervisor(report, options.quick);
  explore::prove_gate(report, options.quick);
  const auto figure = [&](const char* name) { return report.figures[name].get<std::uint64_t>(); };
  for (const std::string what : {"transitions", "states", "violations"})
    report.figures[what] = figure(("supervisor_" + what).c_str()) + figure(("gate_" + what).c_str());
  report.figures["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.bugs) explore::prove_bugs(report, options.mutant_build);
  if (options.spin) explore::prove_with_spin(report, options.mutant_build);
  return report;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Every reachable state and input of the shipped supervisor and gate, against every invariant"};
  app.add_option("--json", options.json, "write figures and tables to this file");
  app.add_flag("--quick", options.quick, "one hazard of each class instead of all combinations");
  app.add_flag("--bugs", options.bugs, "also find_violation the seeded bugs");
  app.add_flag("--spin", options.spin, "also ask Spin");
  app.add_option("--bench", options.mutant_build.bench, "folder for copies and models")
      ->capture_default_str();
  try {
    app.parse(argc, argv);
    const explore::Report report = prove(options);
    if (!options.json.empty()) explore::write(report, "explore", options.json);
    for (const auto& [name, value] : report.figures.items()) fmt::print("{:32} {}\n", name, value.dump());
    return report.passed ? 0 : 3;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const ConfigError& error) {
    fmt::print(stderr, "{}\n  {}\n  {}\n", error.what_is_wrong, error.where, error.remedy);
    return 2;
  }
}
