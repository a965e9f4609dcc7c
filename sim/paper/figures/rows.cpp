#include "sim/paper/figures/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace biopsy::sim::paper {
namespace {

constexpr double kFarthest = 10.0;  // and for a row that could not be computed

PaperRow row(RowName name, RowKind kind, double paper, double ours, double band, std::string note) {
  PaperRow out;
  out.figure = std::move(name.figure);
  out.quantity = std::move(name.quantity);
  out.unit = std::move(name.unit);
  out.kind = kind;
  out.paper = paper;
  out.ours = ours;
  out.band = band;
  out.note = std::move(note);
  return out;
}

}  // namespace

PaperRow number_row(RowName name, double paper, double ours, std::string note, double band) {
  PaperRow out = row(std::move(name), RowKind::Number, paper, ours, band, std::move(note));
  out.ok = std::abs(ours / paper - 1.0) <= band;
  return out;
}

PaperRow at_most_row(RowName name, double paper, double ours, std::string note) {
  PaperRow out = row(std::move(name), RowKind::AtMost, paper, ours, 0.0, std::move(note));
  out.ok = ours <= paper;
  return out;
}

PaperRow trend_row(std::string figure, std::string statement, double margin, std::string note) {
  const double holds = margin > 0.0 ? 1.0 : 0.0;
  PaperRow out =
      row({std::move(figure), std::move(statement), "1"}, RowKind::Trend, 1.0, holds, 0.0, std::move(note));
  out.ok = margin > 0.0;
  out.margin = margin;
  return out;
}

PaperRow shown_row(RowName name, double before, double ours, std::string note) {
  PaperRow out = row(std::move(name), RowKind::Shown, before, ours, 0.0, std::move(note));
  out.ok = true;
  return out;
}

void add_window_rows(std::vector<PaperRow>& rows, const std::string& figure, const std::string& of,
                     double paper, const Course& course) {
  for (const double settling : kOtherSettling)
    rows.push_back(
        shown_row({figure, fmt::format("{}RMSE from {:g} s after each jump on", of, settling), "mm"}, paper,
                  rmse_settled(course, settling),
                  fmt::format("how much the window of {:g} s, which is judged, decides", kSettling)));
}

double shortfall(const PaperRow& row) {
  if (row.kind == RowKind::Shown) return 0.0;
  if (!std::isfinite(row.ours)) return kFarthest;
  double out = 0.0;
  switch (row.kind) {
    case RowKind::Shown:
      break;
    case RowKind::Number: {
      const double off = row.ours / row.paper - 1.0;
      if (std::abs(off) <= row.band) break;
      const double distance =
          row.ours / row.paper > 0.0 ? std::abs(std::log(row.ours / row.paper)) : kFarthest;
      out = distance / row.band - (off > 0.0 ? std::log1p(row.band) : -std::log1p(-row.band)) / row.band;
      break;
    }
    case RowKind::AtMost:
      out = (row.ours - row.paper) / std::abs(row.paper);
      break;
    case RowKind::Trend:
      out = -row.margin;
      break;
  }
  return std::clamp(out, 0.0, kFarthest);
}

}  // namespace biopsy::sim::paper
