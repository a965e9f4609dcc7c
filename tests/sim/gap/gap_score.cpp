#include "tests/sim/gap/gap_score.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "robot/common/statistics.hpp"

namespace biopsy::hidden {
namespace {

constexpr double kConfident = 0.5;

std::string verdict_word(GapVerdict verdict) {
  switch (verdict) {
    case GapVerdict::NoGap:
      return "no_gap";
    case GapVerdict::Parameter:
      return "parameter";
    case GapVerdict::Effect:
      return "effect";
    case GapVerdict::Unexplained:
      return "unexplained";
  }
  return "";
}

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

std::vector<std::string> names_of(const Answer& answer) {
  std::vector<std::string> out;
  for (const AnsweredEffect& effect : answer.effects) out.push_back(effect.name);
  return out;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::string rejection(const Answer& answer) {
  if (answer.rejected.empty()) return {};
  return fmt::format("; rejected {}: {}", fmt::join(answer.rejected, " + "),
                     fmt::join(answer.objections, "; "));
}

std::string expectation(const HiddenCase& hidden) {
  switch (hidden.kind) {
    case HiddenKind::Outside:
      return "unexplained";
    case HiddenKind::Nothing:
      return hidden.parameter_error > 0.0 ? "no_gap or parameter" : "no_gap";
    case HiddenKind::Parameter: {
      std::string out = "parameter:";
      for (const WrongParameter& wrong : hidden.wrong) out += " " + wrong.name;
      return out;
    }
    case HiddenKind::Single:
    case HiddenKind::Pair:
      break;
  }
  return fmt::format("{}", fmt::join(hidden.expected(), " + "));
}

std::string found(const Answer& answer) {
  std::string out = answer.verdict;
  for (const AnsweredEffect& effect : answer.effects) {
    out += fmt::format(" {} {:.2f}", effect.name, effect.probability);
    if (!effect.confused_with.empty()) out += fmt::format(" (or {})", fmt::join(effect.confused_with, ", "));
  }
  if (!answer.parameters_changed.empty())
    out += fmt::format(" [{}]", fmt::join(answer.parameters_changed, " "));
  return out;
}

}  // namespace

Answer answer_of(const GapFinding& finding) {
  Answer out{verdict_word(finding.verdict),
             {},
             {},
             finding.rmse_before,
             finding.rmse_after,
             finding.noise_floor,
             finding.gap_closed,
             finding.seconds,
             finding.rejected.effects,
             finding.rejected.objections};
  for (const FoundEffect& effect : finding.effects) {
    AnsweredEffect named{effect.name, effect.probability, {}, {}};
    for (const GapProbability& other : effect.confused_with) named.confused_with.push_back(other.name);
    for (const GapEstimate& number : effect.parameters)
      named.parameters.push_back({number.name, number.value, number.std});
    out.effects.push_back(std::move(named));
  }
  for (const ChangedParameter& changed : finding.parameters_changed)
    out.parameters_changed.push_back(changed.name);
  return out;
}

void Score::compare_parameters(const HiddenCase& hidden, const Answer& answer) {
  if (std::ranges::all_of(answer.effects, [](const auto& effect) { return effect.parameters.empty(); }))
    return;  // a peer, or a generator of another parametrisation
  for (const TrueParameter& truth : hidden.truth())
    for (const AnsweredEffect& effect : answer.effects) {
      if (effect.name != truth.effect) continue;
      const auto number = std::ranges::find(effect.parameters, truth.parameter, &AnsweredParameter::name);
      const std::string label = truth.effect + "." + truth.parameter;
      if (number == effect.parameters.end()) {
        if (!holds(not_compared, label)) not_compared.push_back(label);
        continue;
      }
      const bool inside = std::abs(number->value - truth.value) <= kTwoSided95 * number->std;  // NaN: outside
      inside_interval.count(inside);
      lines_.back() += fmt::format("\n    {} {:.4g} +- {:.2g}, true {:.4g}{}", label, number->value,
                                   number->std, truth.value, inside ? "" : "  OUTSIDE");
    }
}

void Score::add(const HiddenCase& hidden, const Answer& answer) {
  const auto names = names_of(answer), expected = hidden.expected();
  const bool effect = answer.verdict == "effect" && !names.empty();
  bool right = false;
  switch (hidden.kind) {
    case HiddenKind::Single:
      right = effect && names.front() == expected.front();
      right_first.count(right);
      right_or_tied.count(right || (effect && holds(answer.effects.front().confused_with, expected.front())));
      invented.count(effect && names.size() > 1);
      break;
    case HiddenKind::Pair: {
      const auto hits = std::ranges::count_if(expected, [&](const auto& name) { return holds(names, name); });
      right = effect && hits == 2;
      both_names.count(right);
      one_name.count(effect && hits >= 1);
      break;
    }
    case HiddenKind::Parameter:
      right = answer.verdict == "parameter" && std::ranges::all_of(hidden.wrong, [&](const auto& wrong) {
                return holds(answer.parameters_changed, wrong.name);
              });
      parameter_found.count(right);
      break;
    case HiddenKind::Nothing:
      right = answer.verdict == "no_gap" || (answer.verdict == "parameter" && hidden.parameter_error > 0.0);
      false_alarm.count(!right);
      break;
    case HiddenKind::Outside:
      right = answer.verdict == "unexplained";
      unexplained.count(right);
      confident_wrong.count(effect && std::ranges::any_of(answer.effects, [](const auto& one) {
                              return one.probability >= kConfident;
                            }));
      break;
  }
  wrong_name.count(effect && !std::ranges::all_of(names, [&](const auto& n) { return holds(expected, n); }));
  lines_.push_back(fmt::format(
      "{} {:11} {:40} expected {:34} found {}; rmse {:.4f} -> {:.4f} (noise {:.4f}) mm, closed {:.3f}{}",
      right ? "  " : "!!", hidden.group, hidden.name, expectation(hidden), found(answer), answer.rmse_before,
      answer.rmse_after, answer.noise, answer.gap_closed, rejection(answer)));
  const bool in_library = hidden.kind != HiddenKind::Nothing && hidden.kind != HiddenKind::Outside;
  if (in_library) gap_closed.push_back(answer.gap_closed);
  seconds.push_back(answer.seconds);
  compare_parameters(hidden, answer);
}

double Score::median_gap_closed() const {
  return median(gap_closed);
}

std::string Score::list() const {
  std::string out = fmt::format("{}\n", fmt::join(lines_, "\n"));
  if (!not_compared.empty())
    out += fmt::format("not compared (named otherwise): {}\n", fmt::join(not_compared, ", "));
  return out;
}

std::vector<std::vector<std::string>> score_rows(const std::vector<std::pair<std::string, Score>>& methods) {
  const auto share = [](const Share& s) {
    return s.of ? fmt::format("{:.0f} % of {}", s.percent(), s.of) : "-";
  };
  using Row = std::pair<std::string, std::function<std::string(const Score&)>>;
  const std::vector<Row> rows{
      {"right name first, single effects (>= 95 %)", [&](const Score& s) { return share(s.right_first); }},
      {"... or reported as tied with it", [&](const Score& s) { return share(s.right_or_tied); }},
      {"a further effect invented beside it", [&](const Score& s) { return share(s.invented); }},
      {"false alarm, nothing hidden (<= 5 %)", [&](const Score& s) { return share(s.false_alarm); }},
      {"wrong parameters recognised and named", [&](const Score& s) { return share(s.parameter_found); }},
      {"both names of pairs (>= 80 %)", [&](const Score& s) { return share(s.both_names); }},
      {"at least one of them", [&](const Score& s) { return share(s.one_name); }},
      {"unexplained, outside the library (>= 80 %)", [&](const Score& s) { return share(s.unexplained); }},
      {"confident wrong name there (<= 10 %)", [&](const Score& s) { return share(s.confident_wrong); }},
      {"an effect named that is not there, any case", [&](const Score& s) { return share(s.wrong_name); }},
      {"median gap closed (>= 0.95)",
       [](const Score& s) {
         return s.gap_closed.empty() ? "-" : fmt::format("{:.3f}", s.median_gap_closed());
       }},
      {"truth inside the 95 % interval (85-99 %)", [&](const Score& s) { return share(s.inside_interval); }},
      {"median time of a case [s]", [](const Score& s) { return fmt::format("{:.1f}", median(s.seconds)); }}};
  std::vector<std::vector<std::string>> out;
  for (const auto& [label, cell] : rows) {
    out.push_back({label});
    for (const auto& [name, score] : methods) out.back().push_back(cell(score));
    if (std::all_of(out.back().begin() + 1, out.back().end(), [](const auto& c) { return c == "-"; }))
      out.pop_back();
  }
  return out;
}

std::string score_table(const std::vector<std::pair<std::string, Score>>& methods) {
  std::string out = fmt::format("| {:44} |", ""), rule = fmt::format("|{:-<46}|", "");
  for (const auto& [name, score] : methods) {
    out += fmt::format(" {:>14} |", name);
    rule += fmt::format("{:->15}:|", "");
  }
  out += "\n" + rule + "\n";
  for (const std::vector<std::string>& row : score_rows(methods)) {
    out += fmt::format("| {:44} |", row.front());
    for (std::size_t column = 1; column < row.size(); ++column) out += fmt::format(" {:>14} |", row[column]);
    out += "\n";
  }
  return out;
}

}  // namespace biopsy::hidden
