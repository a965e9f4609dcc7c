#include "robot/report/gap/gap_console.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "robot/common/number_text.hpp"
#include "robot/common/sanitize_text.hpp"
#include "robot/report/gap/gap_candidates.hpp"
#include "robot/report/gap/gap_labels.hpp"
#include "robot/report/gap/gap_sections.hpp"

namespace biopsy::report {
namespace {

constexpr std::size_t kLineWidth = 100;
constexpr std::size_t kSentenceLines = 5, kMargins = 2, kRegimes = 3, kCandidates = 5, kNextLines = 3;

std::size_t letters(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char byte) { return (byte & 0xC0) != 0x80; }));
}

std::string padded(std::string text, std::size_t width) {
  return text.append(width - std::min(width, letters(text)), ' ');
}

// At most `most` lines of about kLineWidth letters, each indented; what does not fit is left out and marked.
std::string wrapped(const std::string& text, const std::string& indent, std::size_t most) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string next = text.substr(at, end - at);
    at = end + 1;
    if (!lines.back().empty() && letters(lines.back()) + 1 + letters(next) > kLineWidth) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + next;
  }
  if (lines.size() > most) {
    lines.resize(most);
    lines.back() += " …";
  }
  std::string shown;
  for (const std::string& line : lines) shown.append(indent).append(line).append("\n");
  return shown;
}

// "gain of the drive circuit, K": parameters have a letter that people know.
std::string candidate_name(const GapCandidate& candidate) {
  const std::string words = plain(candidate_words(candidate));
  return candidate.kind == CandidateKind::Effect ? words : words + ", " + plain(candidate.name);
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
    if (!m.ok && ++failing <= kMargins) text += wrapped("MARGIN LOST  " + plain(margin_finding(m)), "  ", 2);
  if (failing > kMargins) text += fmt::format("  MARGIN LOST  {} more in the report\n", failing - kMargins);
  if (failing == 0 && !f.margins.empty())
    text += fmt::format("  Safety margins: all {} hold with the new model\n", f.margins.size());
  return text;
}

std::string where_lines(const GapFinding& f) {
  if (f.where.empty()) return {};
  std::string text = "\n  Where                                     time   excess error\n";
  for (std::size_t i = 0; i < std::min(kRegimes, f.where.size()); ++i)
    text +=
        fmt::format("  {}{:>8}{:>15}\n", padded(plain(regime_words(f.where[i].name, f.force_drive)), 38),
                    percent_text(f.where[i].share_of_time), percent_text(f.where[i].share_of_excess_error));
  return text;
}

// What was chosen, round by round, then the best of the first round.
std::vector<GapCandidate> told_candidates(const GapFinding& f) {
  std::vector<GapCandidate> told = ranked_candidates(f.candidates);
  std::stable_partition(told.begin(), told.end(), [](const GapCandidate& c) { return c.chosen; });
  told.resize(std::min(told.size(), kCandidates));
  return told;
}

std::string outcome(const GapCandidate& c, GapVerdict verdict) {
  const bool adopted = verdict == GapVerdict::Effect || verdict == GapVerdict::Parameter;
  if (c.chosen) return adopted ? fmt::format("  chosen, round {}", c.round) : "  best, not adopted";
  return c.fitted ? "" : "  ruled out";
}

std::string candidate_lines(const GapFinding& f) {
  if (f.candidates.empty()) return {};
  std::string text = "\n  Candidates                                score   held-out mm  probability\n";
  for (const GapCandidate& c : told_candidates(f))
    text += fmt::format("  {}{:>8}{:>14}{:>13}{}\n", padded(candidate_name(c), 39), percent_text(c.score),
                        fixed(c.held_out_rmse, decimals_for(f.noise_floor)),
                        c.fitted ? fixed(c.probability, 2) : "–", outcome(c, f.verdict));
  return text;
}

std::string next_lines(const GapFinding& f) {
  if (f.next.name.empty()) return {};
  std::string text = "Next experiment: " + name_words(f.next.name);
  for (std::size_t i = 0; i < f.next.separates.size(); ++i)
    text += (i == 0 ? ", to separate " : " / ") + explanation_words(f.next.separates[i]);
  if (!f.next.sentence.empty()) text += ". " + f.next.sentence;
  return "\n" + wrapped(plain(text), "  ", kNextLines);
}

}  // namespace

std::string gap_console(const GapFinding& f) {
  return wrapped(std::string(badge_word(f.verdict)) + ". " + plain(f.sentence), "", kSentenceLines) + "\n" +
         rmse_line(f) + margin_lines(f) + where_lines(f) + candidate_lines(f) + next_lines(f) +
         (f.warnings.empty() ? ""
                             : fmt::format("\n  {}, in the report\n", counted(f.warnings.size(), "warning")));
}

}  // namespace biopsy::report
