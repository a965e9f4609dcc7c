#include "robot/report/study/paper_score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "robot/common/text/number_text.hpp"

namespace biopsy::report {
namespace {

constexpr const char* kTheory = "2";  // Fig. 2 draws equations

std::string number_with_unit(const std::string& number, const std::string& unit) {
  return unit.empty() || unit == "1" || number == "–" ? number : number + " " + unit;
}

}  // namespace

void PaperScore::add(const PaperRow& row) {
  if (row.kind == RowKind::Shown) return;
  const bool trend = row.kind == RowKind::Trend, of_theory = row.figure == kTheory;
  ++(of_theory ? theory : trend ? trends : numbers);
  if (row.ok) ++(of_theory ? theory_ok : trend ? trends_ok : numbers_ok);
  if (of_theory) return;
  if (row.leakage_ok) {
    (trend ? leakage_trends : leakage_numbers).add(*row.leakage_ok);
    if (!*row.leakage_ok) beyond_leakage.add(row.ok);
  }
  if (row.held_out) (trend ? held_out_trends : held_out_numbers).add(row.held_out->ok);
  if (row.kind != RowKind::AtMost) return;
  ++bounds;
  if (row.ok) ++bounds_ok;
}

PaperScore score_of(const PaperFigure& figure) {
  PaperScore score;
  for (const PaperRow& row : figure.rows) score.add(row);
  return score;
}

PaperScore score_of(const Reproduction& reproduction) {
  PaperScore score;
  for (const PaperFigure& figure : reproduction.figures)
    for (const PaperRow& row : figure.rows) score.add(row);
  return score;
}

std::string score_sentence(const PaperScore& s) {
  const std::string closed_forms =
      s.theory > 0 ? fmt::format(", closed forms {} of {}", s.theory_ok, s.theory) : "";
  const std::string parts =
      s.bounds > 0 ? fmt::format(" ({} of {} to be met, {} of {} bounds)", s.numbers_ok - s.bounds_ok,
                                 s.numbers - s.bounds, s.bounds_ok, s.bounds)
                   : "";
  return fmt::format("{} of {} of the paper's numbers within their band{}, trends {} of {}{}", s.numbers_ok,
                     s.numbers, parts, s.trends_ok, s.trends, closed_forms);
}

std::vector<std::string> score_remarks(const Reproduction& r) {
  const PaperScore s = score_of(r);
  std::vector<std::string> remarks;
  remarks.push_back(r.fitted
                        ? fmt::format("Fitted: {} unknowns to {} numbers and {} statements of the paper.",
                                      r.fitted->unknowns, r.fitted->numbers, r.fitted->statements)
                        : "What this model was fitted to is not known here; without held-out column.");
  const std::size_t held = s.held_out_numbers.of + s.held_out_trends.of;
  if (held > 0)
    remarks.push_back(
        fmt::format("Held out, each row by a calibration without its figure: {} of {} numbers and {} of {} "
                    "statements met "
                    "({:.0f} %).",
                    s.held_out_numbers.ok, s.held_out_numbers.of, s.held_out_trends.ok, s.held_out_trends.of,
                    100.0 * static_cast<double>(s.held_out_numbers.ok + s.held_out_trends.ok) /
                        static_cast<double>(held)));
  if (s.leakage_numbers.of + s.leakage_trends.of > 0)
    remarks.push_back(
        fmt::format("The leakage model alone, without any effect (baseline.toml), meets {} of {} numbers and "
                    "{} of {} statements; "
                    "of the {} rows that it misses, this model meets {}.",
                    s.leakage_numbers.ok, s.leakage_numbers.of, s.leakage_trends.ok, s.leakage_trends.of,
                    s.beyond_leakage.of, s.beyond_leakage.ok));
  return remarks;
}

std::string leakage_text(const PaperRow& row) {
  if (!row.leakage_ok) return "–";
  return *row.leakage_ok ? "met too" : "missed";
}

std::string held_out_text(const PaperRow& row) {
  if (!row.held_out) return "–";
  PaperRow held = row;
  held.ours = row.held_out->ours;
  held.ok = row.held_out->ok;
  return (held.ok ? "✓ " : "■ ") + ours_text(held);
}

bool is_missed(const PaperRow& row) {
  return row.kind != RowKind::Shown && !row.ok;
}

std::vector<const PaperRow*> missed_rows(const Reproduction& reproduction) {
  std::vector<const PaperRow*> missed;
  for (const PaperFigure& figure : reproduction.figures)
    for (const PaperRow& row : figure.rows)
      if (is_missed(row)) missed.push_back(&row);
  return missed;
}

std::string paper_text(const PaperRow& row) {
  // The paper's numbers as it prints them; what a shown row starts from is a result of ours.
  const std::string printed = std::isfinite(row.paper) ? fmt::format("{:g}", row.paper) : "–";
  switch (row.kind) {
    case RowKind::Number:
      return number_with_unit(printed, row.unit);
    case RowKind::AtMost:
      return "at most " + number_with_unit(printed, row.unit);
    case RowKind::Trend:
      return "as stated";
    case RowKind::Shown:
      return number_with_unit(three_digits(row.paper), row.unit);
  }
  return {};
}

std::string ours_text(const PaperRow& row) {
  if (row.kind == RowKind::Trend) return row.ok ? "holds" : "does not hold";
  return number_with_unit(three_digits(row.ours), row.unit);
}

std::string band_text(const PaperRow& row) {
  return row.kind == RowKind::Number ? fmt::format("± {:g} %", rounded(100.0 * row.band, 4)) : "–";
}

std::string verdict_text(const PaperRow& row) {
  if (row.kind == RowKind::Shown) return "· shown";
  if (!row.ok) return "■ missed";
  return row.kind == RowKind::Trend ? "✓ as stated" : "✓ within";
}

std::string kind_name(RowKind kind) {
  constexpr std::array kNames{"number", "at_most", "trend", "shown"};  // in the order of RowKind
  return kNames[static_cast<std::size_t>(kind)];
}

std::string three_digits(double value) {
  if (!std::isfinite(value)) return "–";
  if (value == 0.0) return "0";
  const double size = std::abs(value);
  if (size < 1e-4 || size >= 1e6) return fmt::format("{:.1e}", value);
  return fixed(value, std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 6));
}

}  // namespace biopsy::report
