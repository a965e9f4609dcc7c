// A program of the safety case: its options, its figures as JSON, its exit code.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "robot/common/config_error.hpp"

namespace biopsy {

// What a program found: figures by name, tables by name, and whether all holds.
struct EvidenceReport {
  bool passed = true;
  nlohmann::ordered_json figures = nlohmann::ordered_json::object();
  nlohmann::ordered_json tables = nlohmann::ordered_json::object();

  void require(bool holds) { passed = passed && holds; }
  // Figures and rows of another part of the same program.
  void add(const EvidenceReport& part) {
    require(part.passed);
    figures.update(part.figures);
    for (const auto& [name, rows] : part.tables.items())
      for (const auto& row : rows) tables[name].push_back(row);
  }
};

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// The report goes to disk whole or not at all. Throws ConfigError where it cannot be written.
inline void write_evidence(const std::string& tool, const EvidenceReport& report,
                           const std::filesystem::path& file) {
  const nlohmann::ordered_json whole{
      {"tool", tool}, {"passed", report.passed}, {"figures", report.figures}, {"tables", report.tables}};
  const std::filesystem::path part = file.string() + ".part";
  std::ofstream stream(part);
  stream << whole.dump(2) << '\n';
  stream.close();
  std::error_code failed;
  if (stream) std::filesystem::rename(part, file, failed);
  if (!stream || failed)
    throw ConfigError("cannot be written", file.string(),
                      "name a file in a folder that exists and may be written");
}

// Parses the command line, with --json beside the options that `app` has, and runs. Exit code: 0 all holds, 3
// something does not, 2 unusable input.
template <class Run>
int evidence_program(const std::string& tool, CLI::App& app, int argc, char** argv, const Run& run) {
  std::filesystem::path json;
  app.add_option("--json", json, "write figures and tables to this file");
  try {
    app.parse(argc, argv);
    const EvidenceReport report = run();
    if (!json.empty()) write_evidence(tool, report, json);
    return report.passed ? 0 : 3;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const ConfigError& error) {
    fmt::print(stderr, "{}\n  {}\n  {}\n", error.what_is_wrong, error.where, error.remedy);
    return 2;
  }
}

}  // namespace biopsy
