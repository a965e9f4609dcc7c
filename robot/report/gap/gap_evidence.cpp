#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/gap/gap_figures.hpp"
#include "robot/report/gap/gap_labels.hpp"
#include "robot/report/gap/gap_sections.hpp"
#include "robot/report/markup/html_markup.hpp"

namespace biopsy::report {
namespace {

using namespace markup;

constexpr const char* kScoreColour = "#9aa5ae";
constexpr const char* kProbabilityColour = "#005fa8";
constexpr const char* kRoundCaption =
    "Score: share of the gap that a small step would close, on training runs. Held-out RMSE: after the fit. "
    "Probabilities are among the candidates of the round.";
constexpr std::size_t kUnfittedRows = 5;  // of a round; the others are named in one sentence
constexpr std::size_t kShapes = 3;
constexpr double kConcentratedLift = 1.2;  // lift below which an error is everywhere

std::string listed(const std::vector<std::string>& parts) {
  return joined(parts, ", ", " and ");
}

std::string times_text(double ratio) {
  return fixed(ratio, ratio < 10 ? 1 : 0) + " times";
}

std::string where_sentence(const GapFinding& finding) {
  const GapRegime& regime = finding.where.front();
  const double lift = regime.share_of_excess_error / regime.share_of_time;
  if (!(lift >= kConcentratedLift)) return "The disagreement is spread over all situations.";
  return "Worst " + regime_label(regime.name, finding.force_drive) + ": " +
         percent_text(regime.share_of_time) + " of the time, " + percent_text(regime.share_of_excess_error) +
         " of the excess error (" + times_text(lift) + " its share).";
}

bool adopted(const GapFinding& finding) {
  return finding.verdict == GapVerdict::Effect || finding.verdict == GapVerdict::Parameter;
}

const char* remark(const GapCandidate& candidate, bool is_adopted) {
  if (candidate.chosen) return is_adopted ? "✓ chosen" : "the best, not adopted";
  if (candidate.fitted) return "fitted";
  return std::isfinite(candidate.held_out_rmse) ? "leaves too much for a law that resembles many"
                                                : "ruled out by the score test";
}

std::string candidate_row(const GapCandidate& c, int decimals, bool is_adopted) {
  return row({name_cell(candidate_label(c), c.name, c.chosen),
              text_cell(c.kind == CandidateKind::Effect ? "effect" : "parameter"),
              bar_cell(c.score, kScoreColour), number_cell(c.held_out_rmse, decimals),
              c.fitted ? bar_cell(c.probability, kProbabilityColour) : text_cell(""),
              fmt::format("<td class=\"level\">{}</td>", remark(c, is_adopted))},
             c.chosen && is_adopted ? "chosen" : "");
}

std::string round_table(const std::vector<GapCandidate>& ranked, int round, int decimals, bool is_adopted) {
  std::string rows;
  std::vector<std::string> others;
  std::size_t unfitted = 0;
  for (const GapCandidate& c : ranked)
    if (c.fitted || c.chosen || ++unfitted <= kUnfittedRows) {
      rows += candidate_row(c, decimals, is_adopted);
    } else {
      others.push_back(candidate_label(c));
    }
  const std::string heading = round == 1 ? "Round 1: what to add first"
                                         : fmt::format("Round {}: what to add to the choice so far", round);
  std::string html =
      "<h3>" + heading + "</h3>\n" +
      table(round == 1 ? kRoundCaption : "",
            {"Candidate", "Kind", "Score", ">Held-out RMSE<br />mm", "Probability", "Outcome"}, rows);
  if (!others.empty()) html += paragraph("Also ruled out by the score test: " + listed(others) + ".");
  if (std::none_of(ranked.begin(), ranked.end(), [](const GapCandidate& c) { return c.chosen; }))
    html += paragraph("None of them met the criterion to enter.");
  return html;
}

std::string confusion_sentence(const FoundEffect& effect) {
  const std::string name = readable_name(effect.name);
  if (effect.confused_with.empty())
    return "No other candidate predicts these data as well as " + name + " (probability " +
           fixed(effect.probability, 2) + ").";
  std::vector<std::string> others;
  for (const GapProbability& other : effect.confused_with)
    others.push_back(explanation_label(other.name) + " (" + fixed(other.probability, 2) + ")");
  const std::string best = name + " (probability " + fixed(effect.probability, 2) + ")";
  if (effect.probability > 0.95)
    return best + " predicts the held-out runs best, but they do not exclude " + listed(others) + ".";
  return "On the held-out runs, " + best + " is indistinguishable from " + listed(others) + ".";
}

std::string experiment_sentence(const GapFinding& finding) {
  const NextExperiment& next = finding.next;
  if (next.name.empty()) return {};
  std::vector<std::string> separated;
  for (const std::string& name : next.separates) separated.push_back(explanation_label(name));
  std::string text = "The next experiment should be: " + readable_name(next.name) + ".";
  if (separated.size() > 1) text += " It separates " + listed(separated) + ".";
  if (!next.sentence.empty()) return text + " " + next.sentence;
  if (!(next.difference > 0)) return text;
  text += " Simulated there, their predictions differ by " +
          fixed(next.difference, decimals_for(next.difference), "mm") + " RMS";
  if (finding.noise_floor > 0)
    text += ", " + times_text(next.difference / finding.noise_floor) + " the noise";
  return text + ".";
}

std::string regime_row(const GapRegime& regime, int decimals, bool force_drive) {
  const double less = 1.0 - regime.rmse_after / regime.rmse_before;
  const std::string change = !std::isfinite(less) ? "–"
                             : less >= 0          ? percent_text(less) + " less"
                                                  : "▲ " + percent_text(-less) + " more";
  return row({name_cell(regime_label(regime.name, force_drive), regime.name),
              number_cell(percent_text(regime.share_of_time)),
              number_cell(percent_text(regime.share_of_excess_error)),
              number_cell(regime.share_of_excess_error / regime.share_of_time, 1),
              number_cell(regime.rmse_before, decimals), number_cell(regime.rmse_after, decimals),
              number_cell(change)});
}

}  // namespace

std::string gap_where_section(const GapFinding& finding) {
  std::string html;
  if (!finding.where.empty() && finding.verdict != GapVerdict::NoGap)
    html += paragraph(where_sentence(finding));
  const std::string tint = finding.where.empty() ? "The background names the situation. "
                                                 : "Strongest tint: what stands out, if anything. ";
  html += figure(where_figure(finding), "The run with the largest gap. " + tint +
                                            "Noise alone stays mostly within the dashed lines.");
  html +=
      figure(shares_figure(finding),
             "Excess error: squared residual above the noise. A situation stands out where blue is longer "
             "than grey. Situations overlap.");
  return section(finding.verdict == GapVerdict::NoGap ? "How model and measurement compare"
                                                      : "Where model and measurement disagree",
                 html);
}

std::string gap_overlay_section(const GapFinding& finding) {
  const GapTrace* trace = overlay_trace(finding);
  if (!trace) return {};
  const bool changed = model_changed(*trace);
  const std::string caption = !changed ? "The model was not changed."
                              : trace->held_out
                                  ? "A held-out run: nothing was fitted to it."
                                  : "▲ No held-out run can be drawn: the new model was fitted to this one.";
  return section(changed ? "Before and after" : "Measurement and model",
                 figure(overlay_figure(finding), caption));
}

std::string gap_closer_section(const GapFinding& finding) {
  return section("The worst stretch, closer",
                 figure(where_closer_figure(finding), "The tenth of the run above that disagrees most."));
}

std::string gap_shapes_section(const GapFinding& finding) {
  if (finding.shapes.empty()) return {};
  std::string html = paragraph(
      "The residual depends most on " + readable_name(finding.shapes.front().quantity) +
      (finding.verdict == GapVerdict::Unexplained ? ". A term of this shape is the first to look for."
                                                  : "."));
  for (std::size_t i = 0; i < std::min(kShapes, finding.shapes.size()); ++i)
    html += figure(
        shape_figure(finding.shapes[i]),
        escaped("The mean residual against " + readable_name(finding.shapes[i].quantity) + " accounts for " +
                percent_text(finding.shapes[i].share_explained) + " of the residual's variance."));
  return section("The shape of the residual", html);
}

std::string gap_candidates_section(const GapFinding& finding) {
  std::map<int, std::vector<GapCandidate>> rounds;
  for (const GapCandidate& candidate : ranked_candidates(finding.candidates))
    rounds[candidate.round].push_back(candidate);
  std::string html;
  for (const auto& [round, ranked] : rounds)
    html += round_table(ranked, round, decimals_for(finding.noise_floor), adopted(finding));
  return section("Candidates", html);
}

std::string gap_regimes_section(const GapFinding& finding) {
  if (finding.where.empty()) return {};
  std::string rows;
  for (const GapRegime& regime : finding.where)
    rows += regime_row(regime, decimals_for(finding.noise_floor), finding.force_drive);
  return section("By situation", table("All runs together. Lift: share of excess error over share of time.",
                                       {"Situation", ">Time", ">Excess error", ">Lift",
                                        ">RMSE before<br />mm", ">RMSE after<br />mm", ">Change"},
                                       rows));
}

std::string gap_doubts_section(const GapFinding& finding) {
  std::string html;
  for (const FoundEffect& effect : finding.effects) html += paragraph(confusion_sentence(effect));
  const std::string experiment = experiment_sentence(finding);
  if (!experiment.empty())
    html += "<p><strong>" + escaped(experiment) + "</strong></p>\n";
  else if (!finding.next.sentence.empty() && finding.verdict != GapVerdict::NoGap)
    html += paragraph(finding.next.sentence);
  return section("Indistinguishable explanations", html);
}

}  // namespace biopsy::report
