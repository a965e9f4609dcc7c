#include "sim/gap/sentences.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "sim/effect_words.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kConcentrated = 1.3;  // share of error over share of time worth a word

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// The number without its unit: "breakaway" of "breakaway_N".
std::string bare(const std::string& parameter, const std::string& unit) {
  if (unit.empty()) return spaced(parameter);
  std::string suffix = unit;
  for (char& c : suffix)
    if (c == '/' || c == ' ') c = '_';
  const std::size_t at = parameter.rfind('_' + suffix.substr(0, suffix.find('_')));
  return spaced(at == std::string::npos ? parameter : parameter.substr(0, at));
}

std::string numbers(const FoundEffect& effect) {
  std::vector<std::string> words;
  for (const GapEstimate& p : effect.parameters) {
    const std::string unit = unit_of(p.name);
    words.push_back(fmt::format("{} {:.3g} +- {:.1g}{}{}", bare(p.name, unit), p.value, p.std,
                                unit.empty() ? "" : " ", unit));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string concentrated(const GapFinding& finding) {
  if (finding.where.empty()) return "";
  const GapRegime& first = finding.where.front();
  if (first.share_of_time <= 0.0 || first.share_of_excess_error < kConcentrated * first.share_of_time) return "";
  const std::string place =
      first.name.starts_with("run:") ? fmt::format("in the run \"{}\"", first.name.substr(4)) : "\"" + spaced(first.name) + "\"";
  return fmt::format(" {:.0f} % of it lies {} ({:.0f} % of the time).", 100.0 * first.share_of_excess_error,
                     first.name.starts_with("run:") ? place : "in the regime " + place, 100.0 * first.share_of_time);
}

std::string effect_sentence(const GapFinding& finding) {
  std::string out;
  for (const FoundEffect& effect : finding.effects)
    out += fmt::format("{} {}: {}. ", effect.sentence, spaced(effect.name), numbers(effect));
  return out + fmt::format("{} {:.0f} % of the disagreement on runs that were not used for fitting.{}",
                           finding.effects.size() > 1 ? "Together they explain" : "It explains",
                           100.0 * finding.gap_closed, concentrated(finding));
}

std::string parameter_sentence(const GapFinding& finding) {
  std::vector<std::string> words;
  for (const ChangedParameter& p : finding.parameters_changed)
    words.push_back(fmt::format("{} is {:.4g} and not {:.4g}", p.name, p.after, p.before));
  const std::string what = words.empty() ? "small errors of calibration" : fmt::format("{}", fmt::join(words, ", "));
  return fmt::format("Nothing is missing in the model, but its numbers are off: {}. That explains {:.0f} % of the disagreement.",
                     what, 100.0 * finding.gap_closed);
}

}  // namespace

std::string verdict_sentence(const GapFinding& finding) {
  switch (finding.verdict) {
    case GapVerdict::NoGap:
      return fmt::format("Model and measurement agree: what is left ({:.3g} mm) is the sensor's noise ({:.3g} mm).",
                         finding.rmse_before, finding.noise_floor);
    case GapVerdict::Parameter: return parameter_sentence(finding);
    case GapVerdict::Effect: return effect_sentence(finding);
    case GapVerdict::Unexplained: break;
  }
  std::string out = fmt::format(
      "Model and measurement differ by {:.3g} mm where the noise is {:.3g} mm, and no effect of the library explains "
      "that.{}", finding.rmse_before, finding.noise_floor, concentrated(finding));
  if (!finding.shapes.empty())
    out += fmt::format(" What is left depends most on the {} ({:.0f} % of its variance).",
                       spaced(finding.shapes.front().quantity), 100.0 * finding.shapes.front().share_explained);
  return out;
}

}  // namespace biopsy::sim::gap
