#include "robot/report/gap/gap_labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "robot/common/statistics.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/common/text/text_layout.hpp"

namespace biopsy::report {
namespace {

struct Named {
  std::string_view name, label;
};

// In the order of GapVerdict.
constexpr std::array kVerdicts{Named{"no_gap", "✓ No gap"}, Named{"parameter", "◆ Parameter off"},
                               Named{"effect", "● Effect found"}, Named{"unexplained", "? Unexplained"}};
static_assert(kVerdicts.size() == static_cast<std::size_t>(GapVerdict::Unexplained) + 1);

constexpr std::array kRegimes{
    Named{"after_reversal", "after a polarity reversal"},
    Named{"rising", "while rising"},
    Named{"falling", "while falling"},
    Named{"holding", "while holding"},
    Named{"stuck", "while stuck"},
    Named{"low_voltage", "at low voltage"},
    Named{"high_voltage", "at high voltage"},
    Named{"low_force", "at low force"},
    Named{"high_force", "at high force"},
    Named{"shallow", "in the shallow part of the stroke"},
    Named{"deep", "in the deep part of the stroke"},
    Named{"early", "early in the run"},
    Named{"late", "late in the run"},
    Named{"before_puncture", "before a puncture"},
    Named{"after_puncture", "after a puncture"},
};

struct BaselineName {
  std::string_view name, label, unit;
  double per_si;
};

// The names of [baseline] in model files (docs/explanation/model.md, section 1).
constexpr std::array kBaseline{
    BaselineName{"K", "gain of the drive circuit", "", 1},
    BaselineName{"tau", "time constant of the leakage", "s", 1},
    BaselineName{"eps_film", "permittivity of the film", "", 1},
    BaselineName{"d_film", "thickness of the films", "µm", 1e6},
    BaselineName{"L0", "width of a pouch", "mm", 1e3},
    BaselineName{"V0", "displaced volume of a pouch", "mm³", 1e9},
    BaselineName{"H_0", "height of a pouch at rest", "mm", 1e3},
    BaselineName{"n", "number of pouches", "", 1},
    BaselineName{"tau_h", "time constant of the oil flow", "ms", 1e3},
    BaselineName{"k", "stiffness of the spring", "N/m", 1},
    BaselineName{"c_k", "damping of the spring", "N s/m", 1},
    BaselineName{"c_s", "viscous damping of the slider", "N s/m", 1},
    BaselineName{"fixture_mass", "mass of plate A", "g", 1e3},
    BaselineName{"m_B", "mass of plate B", "g", 1e3},
    BaselineName{"m", "moving mass", "kg", 1},
    BaselineName{"C1", "capacitance C1", "nF", 1e9},
    BaselineName{"T", "control period", "ms", 1e3},
    BaselineName{"g", "gravity", "m/s²", 1},
};

constexpr std::array<std::string_view, 22> kUnits{"N",  "mN",  "mm", "um", "m",   "s",      "ms", "Hz",
                                                  "kV", "V",   "g",  "kg", "rad", "m2",     "s2", "mm2",
                                                  "m3", "mm3", "uA", "nF", "deg", "percent"};

bool is_unit(std::string_view token) {
  return token == "per" || std::find(kUnits.begin(), kUnits.end(), token) != kUnits.end();
}

std::vector<std::string> tokens_of(std::string_view name) {
  std::vector<std::string> tokens(1);
  for (const char letter : name)
    if (letter == '_') {
      tokens.emplace_back();
    } else {
      tokens.back() += letter;
    }
  return tokens;
}

std::string unit_sign(const std::string& token) {
  if (token == "percent") return "%";
  if (token.starts_with("u")) return "µ" + token.substr(1);
  if (token.ends_with("2")) return token.substr(0, token.size() - 1) + "²";
  if (token.ends_with("3")) return token.substr(0, token.size() - 1) + "³";
  return token;
}

// {"N", "s", "per", "m"} -> "N s/m"; {"mm", "s"} is a speed: "mm/s".
std::string unit_text(const std::vector<std::string>& tokens) {
  if (tokens.size() == 2 && tokens[1] == "s" && tokens[0] != "N") return tokens[0] + "/s";
  std::string unit;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    if (tokens[i] == "per") continue;
    const bool under = i > 0 && tokens[i - 1] == "per";
    unit += (unit.empty() ? "" : under ? "/" : " ") + unit_sign(tokens[i]);
  }
  return unit;
}

int digits_after_point(double size, int significant) {
  if (!std::isfinite(size) || size <= 0) return 3;
  return std::clamp(significant - 1 - static_cast<int>(std::floor(std::log10(size))), 0, 9);
}

bool known(double std) {
  return std::isfinite(std) && std > 0;
}

// What is not known counts as the worst, so that the order is one.
double or_worst(double value) {
  return std::isfinite(value) ? value : std::numeric_limits<double>::max();
}

auto rank(const GapCandidate& c) {
  return std::tuple(c.round, !c.chosen, !c.fitted, or_worst(-c.probability), or_worst(c.held_out_rmse),
                    or_worst(-c.score));
}

}  // namespace

std::string_view label(GapVerdict verdict) {
  return kVerdicts[static_cast<std::size_t>(verdict)].name;
}

std::string_view badge_label(GapVerdict verdict) {
  return kVerdicts[static_cast<std::size_t>(verdict)].label;
}

std::string readable_name(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  using Spelling = std::pair<std::string_view, std::string_view>;
  constexpr std::array kSpellings{Spelling{"coulomb", "Coulomb"}, Spelling{"stribeck", "Stribeck"},
                                  Spelling{"lugre", "LuGre"}, Spelling{"load dependent", "load-dependent"}};
  for (const auto& [plain, proper] : kSpellings)
    if (text.starts_with(plain)) text.replace(0, plain.size(), proper);
  return text;
}

std::string explanation_label(std::string_view name) {
  return baseline_quantity(name).label;
}

std::string regime_label(std::string_view name, bool force_drive) {
  if (force_drive && name == "after_reversal") return "after the motion turns around";
  const auto* found =
      std::find_if(kRegimes.begin(), kRegimes.end(), [&](const Named& n) { return n.name == name; });
  if (found != kRegimes.end()) return std::string(found->label);
  for (const std::string_view prefix : {"run:", "run_"})  // a run's name stays as its owner wrote it
    if (name.starts_with(prefix)) {
      name.remove_prefix(prefix.size());
      while (name.starts_with(' ')) name.remove_prefix(1);
      return "in run " + std::string(name);
    }
  return readable_name(name);
}

std::string candidate_label(const GapCandidate& candidate) {
  return candidate.kind == CandidateKind::Effect ? readable_name(candidate.name)
                                                 : explanation_label(candidate.name);
}

ReadableQuantity effect_quantity(std::string_view name) {
  std::vector<std::string> tokens = tokens_of(name);
  std::size_t first_unit = tokens.size();
  while (first_unit > 1 && is_unit(tokens[first_unit - 1])) --first_unit;
  const std::vector<std::string> unit(tokens.begin() + static_cast<std::ptrdiff_t>(first_unit), tokens.end());
  tokens.resize(first_unit);
  return {joined(tokens, " "), unit_text(unit), 1.0};
}

ReadableQuantity baseline_quantity(std::string_view name) {
  for (const BaselineName& known_name : kBaseline)
    if (known_name.name == name)
      return {std::string(known_name.label), std::string(known_name.unit), known_name.per_si};
  const std::size_t dot = name.find('.');  // of an effect that the model had: EFFECT.PARAMETER
  if (dot == std::string_view::npos) return {readable_name(name), "", 1.0};
  ReadableQuantity quantity = effect_quantity(name.substr(dot + 1));
  quantity.label = readable_name(name.substr(0, dot)) + ", " + quantity.label;
  return quantity;
}

std::string estimate_text(double value, double std) {
  if (!known(std)) return fixed(value, digits_after_point(std::abs(value), 3));
  const int decimals = digits_after_point(std, 2);
  return fixed(value, decimals) + " ± " + fixed(std, decimals);
}

std::string interval_text(double value, double std) {
  if (!known(std) || !std::isfinite(value)) return "–";
  const int decimals = digits_after_point(std, 2);
  return fixed(value - kTwoSided95 * std, decimals) + " to " + fixed(value + kTwoSided95 * std, decimals);
}

int decimals_for(double smallest) {
  return std::clamp(digits_after_point(smallest, 2), 2, 5);
}

std::string percent_text(double share) {
  const double percent = 100.0 * share;
  const bool fine = std::abs(percent) < 10 || (percent > 99 && percent < 100);
  return fixed(percent, fine ? 1 : 0, "%");
}

std::vector<GapCandidate> ranked_candidates(std::vector<GapCandidate> candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const GapCandidate& a, const GapCandidate& b) { return rank(a) < rank(b); });
  return candidates;
}

}  // namespace biopsy::report
