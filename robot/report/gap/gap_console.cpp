#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/gap/gap_labels.hpp"
#include "robot/report/gap/gap_report.hpp"
#include "robot/report/gap/gap_sections.hpp"

namespace biopsy::report {
namespace {

constexpr std::size_t kLineWidth = 100;
constexpr std::size_t kSentenceLines = 8, kProposalLines = 3, kMargins = 2, kRegimes = 2, kCandidates = 4,
                      kNextLines = 2, kRemarks = 2;

// Indented lines, `most` of them; what does not fit is left out and marked.
std::string wrapped_paragraph(const std::string& text, const std::string& indent, std::size_t most) {
  std::vector<std::string> lines = wrapped(text, kLineWidth);
  if (lines.size() > most) {
    lines.resize(most);
    lines.back() += " … (all of it: report.html)";
  }
  std::string shown;
  for (const std::string& line : lines) shown += indent + line + "\n";
  return shown;
}

// "gain of the drive circuit, K": parameters are also known by their symbol.
std::string candidate_name(const GapCandidate& candidate) {
  const std::string label = plain(candidate_label(candidate));
  return candidate.kind == CandidateKind::Effect ? label : label + ", " + plain(candidate.name);
}

std::string rmse_line(const GapFinding& f) {
  const int decimals = decimals_for(std::min(f.noise_floor, f.rmse_after));
  std::string line = fmt::format("  RMSE on held-out runs: {} before, {} after, {} noise",
                                 fixed(f.rmse_before, decimals, "mm"), fixed(f.rmse_after, decimals, "mm"),
                                 fixed(f.noise_floor, decimals, "mm"));
  if (f.verdict != GapVerdict::NoGap) line += "; gap closed " + percent_text(f.gap_closed);
  return line + fmt::format(" ({} of work)\n", fixed(f.seconds, 1, "s"));
}

std::string margin_lines(const GapFinding& f) {
  std::string text;
  std::size_t failing = 0;
  for (const MarginChange& m : f.margins)
    if (!m.ok && ++failing <= kMargins)
      text += wrapped_paragraph("MARGIN LOST  " + plain(margin_finding(m)), "  ", 2);
  if (failing > kMargins) text += fmt::format("  MARGIN LOST  {} more in the report\n", failing - kMargins);
  if (failing == 0 && !f.margins.empty())
    text += fmt::format("  Safety margins: all {} hold with the new model\n", f.margins.size());
  return text;
}

std::string where_lines(const GapFinding& f) {
  if (f.where.empty()) return {};
  std::string text = "\n  Where                                     time   excess error\n";
  for (std::size_t i = 0; i < std::min(kRegimes, f.where.size()); ++i)
    text += fmt::format(
        "  {}{:>8}{:>15}\n", padded_right(plain(regime_label(f.where[i].name, f.force_drive)), 38),
        percent_text(f.where[i].share_of_time), percent_text(f.where[i].share_of_excess_error));
  return text;
}

// What was chosen, round by round, then the best of the first round.
std::vector<GapCandidate> shown_candidates(const GapFinding& f) {
  std::vector<GapCandidate> shown = ranked_candidates(f.candidates);
  std::stable_partition(shown.begin(), shown.end(), [](const GapCandidate& c) { return c.chosen; });
  shown.resize(std::min(shown.size(), kCandidates));
  return shown;
}

std::string outcome(const GapCandidate& c, GapVerdict verdict) {
  const bool adopted = verdict == GapVerdict::Effect || verdict == GapVerdict::Parameter;
  if (c.chosen) return adopted ? fmt::format("  chosen, round {}", c.round) : "  best, not adopted";
  return c.fitted ? "" : "  ruled out";
}

std::string candidate_lines(const GapFinding& f) {
  if (f.candidates.empty()) return {};
  std::string text = "\n  Candidates                                score   held-out mm  probability\n";
  for (const GapCandidate& c : shown_candidates(f))
    text += fmt::format("  {}{:>8}{:>14}{:>13}{}\n", padded_right(candidate_name(c), 39),
                        percent_text(c.score), fixed(c.held_out_rmse, decimals_for(f.noise_floor)),
                        c.fitted ? fixed(c.probability, 2) : "–", outcome(c, f.verdict));
  return text;
}

// Remarks that block are in the verdict's sentence.
std::string data_lines(const GapFinding& f) {
  std::string text;
  std::size_t shown = 0;
  for (const DataRemark& remark : f.data)
    if (!remark.blocks && ++shown <= kRemarks)
      text += wrapped_paragraph(plain("Data: " + remark.sentence), "  ", 2);
  if (!f.comparison.reason.empty())
    text += wrapped_paragraph("Chosen from the data: " + plain(f.comparison.reason), "  ", 3);
  return text.empty() ? text : "\n" + text;
}

std::string next_lines(const GapFinding& f) {
  if (f.next.name.empty()) return {};
  std::string text = "Next experiment: " + readable_name(f.next.name);
  for (std::size_t i = 0; i < f.next.separates.size(); ++i)
    text += (i == 0 ? ", to separate " : " / ") + explanation_label(f.next.separates[i]);
  if (!f.next.sentence.empty()) text += ". " + f.next.sentence;
  return "\n" + wrapped_paragraph(plain(text), "  ", kNextLines);
}

}  // namespace

std::string gap_console(const GapFinding& f) {
  return wrapped_paragraph(std::string(badge_label(f.verdict)) + ". " + plain(f.sentence), "",
                           kSentenceLines + (f.proposed ? kProposalLines : 0)) +
         "\n" + rmse_line(f) + margin_lines(f) + where_lines(f) + candidate_lines(f) + data_lines(f) +
         next_lines(f) +
         (f.warnings.empty() ? "" : "\n  " + counted(f.warnings.size(), "warning") + " in the report\n");
}

}  // namespace biopsy::report
