#include <fmt/format.h>

#include <vector>

#include "robot/common/text/text_layout.hpp"
#include "robot/report/gap/gap_labels.hpp"
#include "robot/report/gap/gap_report.hpp"

namespace biopsy::report {
namespace {

constexpr double kConcentratedShare = 1.3;  // share of error over share of time that is mentioned
constexpr std::size_t kMostNumbers = 4;
constexpr double kOnlyNoise = 1.03;  // of it, that is no difference
constexpr double kClear = 0.9;       // probability from which no rival is worth a sentence

std::string with_unit(const std::string& number, const std::string& unit) {
  return unit.empty() ? number : number + " " + unit;
}

std::string estimate(const ReadableQuantity& q, double value, double std) {
  return with_unit(estimate_text(value * q.per_file_unit, std * q.per_file_unit), q.unit);
}

std::string numbers_of(const FoundEffect& effect) {
  std::vector<std::string> numbers;
  for (const GapEstimate& p : effect.parameters) {
    if (numbers.size() == kMostNumbers) break;
    const ReadableQuantity q = effect_quantity(p.name);
    numbers.push_back(q.label + " " + estimate(q, p.value, p.std));
  }
  return joined(numbers);
}

std::string concentrated(const GapFinding& finding) {
  if (finding.where.empty()) return "";
  const GapRegime& first = finding.where.front();
  if (first.share_of_time <= 0.0 || first.share_of_excess_error < kConcentratedShare * first.share_of_time)
    return "";
  return fmt::format(" It is concentrated {}: {:.0f} % of the error in {:.0f} % of the time.",
                     regime_label(first.name, finding.force_drive), 100.0 * first.share_of_excess_error,
                     100.0 * first.share_of_time);
}

// Of an effect that other candidates may be as well.
std::string rivals_sentence(const FoundEffect& effect) {
  if (effect.probability >= kClear || effect.confused_with.empty()) return "";
  std::vector<std::string> rivals;
  for (const GapProbability& one : effect.confused_with)
    if (one.probability >= 1.0 - kClear)
      rivals.push_back(fmt::format("{} ({:.2f})", readable_name(one.name), one.probability));
  return rivals.empty() ? ""
                        : fmt::format("These runs do not tell it ({:.2f}) from {}. ", effect.probability,
                                      joined(rivals, " or "));
}

std::string effect_sentence(const GapFinding& finding) {
  std::string out;
  for (const FoundEffect& effect : finding.effects)
    out += fmt::format("{} {}: {}. {}", effect.sentence, readable_name(effect.name), numbers_of(effect),
                       rivals_sentence(effect));
  return out +
         fmt::format("{} {:.0f} % of the disagreement, on runs that were not used for fitting.{}",
                     finding.effects.size() > 1 ? "Together they explain" : "That explains",
                     100.0 * finding.gap_closed, concentrated(finding)) +
         (finding.partial
              ? fmt::format(
                    " It is part of what is missing: {:.3g} mm are left where the noise is {:.3g} mm.",
                    finding.rmse_after, finding.noise_floor)
              : "");
}

std::string parameter_sentence(const GapFinding& finding) {
  std::vector<std::string> changes;
  for (const ChangedParameter& p : finding.parameters_changed) {
    if (changes.size() == kMostNumbers) break;
    const ReadableQuantity q = baseline_quantity(p.name);
    changes.push_back(fmt::format("{} ({}) is {} and not {}", p.name, q.label, estimate(q, p.after, p.std),
                                  with_unit(fmt::format("{:.4g}", p.before * q.per_file_unit), q.unit)));
  }
  return fmt::format(
      "Nothing is missing in the model, but its numbers are off: {}. That explains {:.0f} % of the "
      "disagreement.",
      changes.empty() ? "small errors of calibration" : joined(changes), 100.0 * finding.gap_closed);
}

std::string rejected_sentence(const RejectedName& rejected) {
  if (rejected.effects.empty()) return "";
  std::vector<std::string> names;
  for (const std::string& name : rejected.effects)  // an effect, or "another value of c_s"
    names.push_back(name.find(' ') == std::string::npos ? readable_name(name) : name);
  return fmt::format(" The nearest, {}, closes {:.0f} % of it and is not its name: {}.",
                     joined(names, " with "), 100.0 * rejected.gap_closed, joined(rejected.objections, "; "));
}

std::string proposed_sentence(const std::optional<ProposedTerm>& term) {
  if (!term) return "";
  return fmt::format(
      " Proposed, not a name: a force {} (N up, SI) closes {:.0f} % of it on held-out runs ({:.3g} mm left). "
      "It may be {}.",
      equation_text(*term), 100.0 * term->gap_closed, term->rmse_after, term->meaning);
}

std::string recording_sentence(const GapFinding& finding) {
  std::string out = "The recording is to be corrected first; nothing was fitted to it.";
  for (const DataRemark& remark : finding.data)
    if (remark.blocks) out += " " + remark.sentence;
  return out;
}

std::string unexplained_sentence(const GapFinding& finding) {
  if (!finding.data.empty() && finding.data.front().blocks) return recording_sentence(finding);
  std::string out =
      finding.rmse_before > kOnlyNoise * finding.noise_floor
          ? fmt::format(
                "Model and measurement differ by {:.3g} mm where the noise is {:.3g} mm, and nothing in "
                "the library explains it.",
                finding.rmse_before, finding.noise_floor)
          : fmt::format(
                "On the runs that were held out model and measurement differ by no more than the noise "
                "({:.3g} mm); on those that were fitted they do, and nothing in the library explains "
                "it.",
                finding.noise_floor);
  out += concentrated(finding);
  out += proposed_sentence(finding.proposed);
  out += rejected_sentence(finding.rejected);
  if (!finding.shapes.empty())
    out += fmt::format(" It depends most on {}, which accounts for {:.0f} % of its variance.",
                       readable_name(finding.shapes.front().quantity),
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
