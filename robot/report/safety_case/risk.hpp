// The risk management file as values, in the style of ISO 14971; with the software items and SOUP (IEC
// 62304), the threat model (IEC 81001-5-1) and the hazard-related use scenarios (IEC 62366) that it rests on.
// Nothing is claimed about conformity. Source: safety/case/risk.toml, software.toml, threats.toml,
// scenarios.toml.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace biopsy::safety_case {

enum class Acceptability : std::uint8_t { Acceptable, Tolerable, NotAcceptable };

// The words of the files: "acceptable", "tolerable", "not acceptable, open".
std::string text_of(Acceptability acceptability);
std::optional<Acceptability> acceptability_from(const std::string& text);

inline constexpr int kRiskLevels = 5;  // of severity and of probability: 1 least, 5 most

// The only place that says which risk is acceptable.
struct RiskMatrix {
  std::array<std::string, kRiskLevels> severity, probability;  // what each level means, level 1 first
  std::array<std::array<Acceptability, kRiskLevels>, kRiskLevels>
      verdicts{};  // [severity - 1][probability - 1]

  Acceptability at(int severity_level, int probability_level) const;  // levels within 1..kRiskLevels
};

// Where the probability after control comes from. A probability that nobody knows counts as the highest.
enum class Basis : std::uint8_t { Measured, Estimated, Unknown };
std::string text_of(Basis basis);

struct Control {
  std::string kind;         // "inherent", "protective" or "information", in this order of preference
  std::string requirement;  // R-nn
};

struct Risk {
  std::string id, hazard;  // RISK-nn, H-nn
  std::string sequence, situation, harm;
  int severity = 0;
  int before = 0, after = 0;  // probability of the harm without and with the controls
  std::string before_reason, after_reason;
  Basis basis = Basis::Unknown;
  std::vector<std::string> evidence;  // ids of evidence.toml; of a measured probability
  std::vector<Control> controls;
  Acceptability residual = Acceptability::NotAcceptable;  // as written; must be what the matrix says
  std::string open;                                       // what is missing where the risk is not acceptable
  std::vector<std::string> new_risks;                     // from the controls: H-nn, or a sentence
};

struct SoftwareItem {
  std::string id, name;              // SI-nn
  std::vector<std::string> folders;  // of the source tree
  std::string safety_class, reason, separation;
};

// Software of unknown provenance: what others wrote and the robot uses as it is.
struct Soup {
  std::string name, package, version;  // package of Debian, or of npm; version as its maker numbers it
  std::string manager;                 // "dpkg" or "npm"
  std::vector<std::string> libraries;  // shared objects that programs of the robot load directly
  std::string purpose, failure;        // what it is for, what its failure could do
  std::vector<std::string> anomalies;  // known ones that matter here
};

struct Threat {
  std::string id, threat, way;  // T-nn
  std::string hazard, countermeasure;
  std::vector<std::string> tests;
  std::string residual;  // what remains
  bool open = false;     // no test, or what remains is not acceptable
};

struct UseScenario {
  std::string id, user, task, use_error, hazard, design;  // U-nn
  std::vector<std::string> tests;  // SUITE.NAME, or FILE.spec.ts: TITLE of the console's browser tests
  std::string residual;
  bool open = false;
};

struct RiskFile {
  std::string scope;
  std::vector<std::string> rules;  // of estimation, as sentences
  RiskMatrix matrix;
  std::vector<Risk> risks;
  std::vector<SoftwareItem> items;
  std::vector<Soup> soup;
  std::vector<std::string> soup_limits;
  std::vector<Threat> threats;
  std::vector<std::string> scenario_limits;
  std::vector<UseScenario> scenarios;
};

}  // namespace biopsy::safety_case
