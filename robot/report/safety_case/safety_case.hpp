// The safety case as values: claim, evidence, and the gaps between them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "robot/report/safety_case/risk.hpp"

namespace biopsy::safety_case {

// After ISO 14971. Severity of the harm, unmitigated: 1 negligible to 5 catastrophic.
struct Hazard {
  std::string id, name, cause, harm;
  int severity = 0;
  std::string detection, reaction;
  int max_time_ms = 0;  // from the first sample that shows it to the reaction; 0 where none is asked for
  std::vector<std::string> requirements, tests;
};

// Needs a passed test that names it, and every proof listed.
struct Requirement {
  std::string id, text;
  std::vector<std::string> proofs;  // ids of sources
};

// Acceptance criterion: one figure of a source and its limits; `name` is its name in the case.
struct Criterion {
  std::string name, figure, unit;
  std::optional<double> at_least, at_most;
};

enum class SourceKind : std::uint8_t {
  Tests,  // a program of tests: gtest's JSON
  Proof   // a program of its own: {"passed", "figures", "tables"}
};

// A program that gives evidence, and how it is called. {tests}: folder of the test programs, {source}: the
// source tree, {out}: the JSON file it writes.
struct Source {
  std::string id, title;
  SourceKind kind = SourceKind::Proof;
  std::vector<std::string> command;
  std::vector<std::string> quick, full;  // added for the short subset, and for the whole
  bool in_quick = true;
  std::vector<Criterion> criteria;
  bool side_by_side = false;  // measures no real time: runs beside the others that say so
};

struct SafetyCase {
  std::string claim;
  std::vector<Hazard> hazards;
  std::vector<Requirement> requirements;
  std::vector<Source> sources;
  std::vector<std::string> not_covered, open_items;
  RiskFile risk{};
};

struct TestResult {
  std::string name;  // SUITE.NAME, with the parameter's name behind a slash
  bool passed = false;
  std::vector<std::string> verifies;  // ids of requirements
};

using Row = std::map<std::string, std::string>;  // column -> text

// The result of one source.
struct Finding {
  std::string source;        // its id
  std::string date, commit;  // when, and the commit it was built from
  std::string code;          // fingerprint of the code; evidence of other code is stale
  double seconds = 0.0;
  bool quick = false;
  bool passed = false;
  std::map<std::string, double> figures{};
  std::map<std::string, std::vector<Row>> tables{};
  std::vector<TestResult> tests{};
};

// Where the case does not hold: an item without a link, a failure, or missing evidence.
struct Gap {
  std::string where, what;
};

// What this case is about.
struct Build {
  std::string date, commit, code, version;
  bool quick = false;    // the short subset: its criteria are not judged, and it releases nothing
  double seconds = 0.0;  // to gather all evidence
};

}  // namespace biopsy::safety_case
