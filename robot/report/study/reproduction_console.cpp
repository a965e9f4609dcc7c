#include <fmt/format.h>

#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/study/paper_score.hpp"
#include "robot/report/study/reproduction_report.hpp"

namespace biopsy::report {
namespace {

constexpr std::size_t kQuantity = 58;

struct Ink {
  const char *bold, *alarm, *grey, *plain;
};

Ink ink(bool colour) {
  return colour ? Ink{"\033[1m", "\033[1;31m", "\033[90m", "\033[0m"} : Ink{"", "", "", ""};
}

std::string line_of(const PaperRow& row, const Ink& letters) {
  const char* start = is_missed(row) ? letters.alarm : row.kind == RowKind::Shown ? letters.grey : "";
  std::string line =
      fmt::format("{}{:<7} {:<{}} {:>16} {:>14}  {:<8} {}{}\n", start, plain(row.figure),
                  shortened(plain(row.quantity), kQuantity), kQuantity, paper_text(row), ours_text(row),
                  band_text(row), verdict_text(row), *start != '\0' ? letters.plain : "");
  if (is_missed(row)) line += fmt::format("{:<8}{}\n", "", plain(row.note));
  return line;
}

}  // namespace

std::string reproduction_console(const Reproduction& r, bool colour) {
  const Ink letters = ink(colour);
  std::string text = fmt::format("{}{:<7} {:<{}} {:>16} {:>14}  {:<8} {}{}\n", letters.bold, "figure",
                                 "quantity", kQuantity, "paper", "ours", "band", "verdict", letters.plain);
  for (const PaperFigure& figure : r.figures)
    for (const PaperRow& row : figure.rows) text += line_of(row, letters);
  text += fmt::format("\n{}{}{}\n", letters.bold, score_sentence(score_of(r)), letters.plain);
  for (const std::string& remark : score_remarks(r)) text += remark + "\n";
  return text;
}

}  // namespace biopsy::report
