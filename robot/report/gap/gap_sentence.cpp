#include "robot/report/gap/gap_sentence.hpp"

#include <fmt/format.h>

#include <vector>

#include "robot/report/gap/gap_labels.hpp"

namespace biopsy::report {
namespace {

constexpr double kConcentratedShare = 1.3;  // share of error over share of time that is worth a word
constexpr std::size_t kMostNumbers = 4;

std::string with_unit(const std::string& number, const std::string& unit) {
  return unit.empty() ? number : number + " " + unit;
}

std::string numbers_of(const FoundEffect& effect) {
  std::vector<std::string> words;
  for (const GapEstimate& p : effect.parameters) {
    if (words.size() == kMostNumbers) break;
    const ReadableQuantity q = effect_quantity(p.name);
    words.push_back(
        fmt::format("{} {}", q.words,
                    with_unit(estimate_text(p.value * q.per_file_unit, p.std * q.per_file_unit), q.unit)));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string concentrated(const GapFinding& finding) {
  if (finding.where.empty()) return "";
  const GapRegime& first = finding.where.front();
  if (first.share_of_time <= 0.0 || first.share_of_excess_error < kConcentratedShare * first.share_of_time)
    return "";
  return fmt::format(" It is concentrated {}: {:.0f} % of the error in {:.0f} % of the time.",
                     regime_words(first.name, finding.force_drive), 100.0 * first.share_of_excess_error,
                     100.0 * first.share_of_time);
}

std::string effect_sentence(const GapFinding& finding) {
  std::string out;
  for (const FoundEffect& effect : finding.effects)
    out += fmt::format("{} {}: {}. ", effect.sentence, name_words(effect.name), numbers_of(effect));
  return out + fmt::format("{} {:.0f} % of the disagreement, on runs that were not used for fitting.{}",
                           finding.effects.size() > 1 ? "Together they explain" : "That explains",
                           100.0 * finding.gap_closed, concentrated(finding));
}

std::string parameter_sentence(const GapFinding& finding) {
  std::vector<std::string> words;
  for (const ChangedParameter& p : finding.parameters_changed) {
    if (words.size() == kMostNumbers) break;
    const ReadableQuantity q = baseline_quantity(p.name);
    words.push_back(
        fmt::format("{} ({}) is {} and not {}", p.name, q.words,
                    with_unit(estimate_text(p.after * q.per_file_unit, p.std * q.per_file_unit), q.unit),
                    with_unit(fmt::format("{:.4g}", p.before * q.per_file_unit), q.unit)));
  }
  const std::string what =
      words.empty() ? "small errors of calibration" : fmt::format("{}", fmt::join(words, ", "));
  return fmt::format(
      "Nothing is missing in the model, but its numbers are off: {}. That explains {:.0f} % of the "
      "disagreement.",
      what, 100.0 * finding.gap_closed);
}

std::string unexplained_sentence(const GapFinding& finding) {
  std::string out = fmt::format(
      "Model and measurement differ by {:.3g} mm where the noise is {:.3g} mm, and nothing in the library "
      "explains it.{}",
      finding.rmse_before, finding.noise_floor, concentrated(finding));
  if (!finding.shapes.empty())
    out += fmt::format(" It depends most on {}, which accounts for {:.0f} % of its variance.",
                       name_words(finding.shapes.front().quantity),
                       100.0 * finding.shapes.front().share_explained);
  return out;
}

}  // namespace

std::string verdict_sentence(const GapFinding& finding) {
  switch (finding.verdict) {
    case GapVerdict::NoGap:
      return fmt::format(
          "Model and measurement agree: what is left ({:.3g} mm) is the sensor's noise ({:.3g} mm).",
          finding.rmse_before, finding.noise_floor);
    case GapVerdict::Parameter:
      return parameter_sentence(finding);
    case GapVerdict::Effect:
      return effect_sentence(finding);
    case GapVerdict::Unexplained:
      break;
  }
  return unexplained_sentence(finding);
}

}  // namespace biopsy::report
