#include "sim/paper/calibration/leave_one_out.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "sim/paper/calibration/gradient_steps.hpp"
#include "sim/paper/figures/figures.hpp"

namespace biopsy::sim::calibration {
namespace {

// "9" of "9a".
std::string whole_figure(std::string_view number) {
  while (!number.empty() && std::isalpha(static_cast<unsigned char>(number.back())) != 0)
    number.remove_suffix(1);
  return std::string(number);
}

}  // namespace

paper::HeldOut leave_one_out(const Question& question, int steps, const CalibrationProgress& progress,
                             const std::stop_token& stop) {
  paper::HeldOut out;
  out.unknowns = question.parameters.size();
  std::vector<std::string> figures;
  for (const paper::FigureEntry& figure : question.figures)
    if (figures.empty() || figures.back() != whole_figure(figure.number))
      figures.push_back(whole_figure(figure.number));
  const auto nominal = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(question.parameters.size()));
  for (const PaperRow& row : rows_at(question, nominal, true))
    ++(row.kind == RowKind::Trend ? out.statements : out.numbers);
  for (std::size_t i = 0; i < figures.size() && !stop.stop_requested(); ++i) {
    Question rest = question;
    std::erase_if(rest.figures,
                  [&](const auto& figure) { return whole_figure(figure.number) == figures[i]; });
    const auto say = [&](double share, const char* how) {
      if (progress)
        progress((static_cast<double>(i) + share) / static_cast<double>(figures.size()),
                 fmt::format("without figure {}: {}", figures[i], how));
    };
    say(0.0, "from the nominal values");
    const Descent coarse = descend(rest, nominal, steps, Pull::Even, Differences::Forward);
    say(0.5, "as many rows as possible");
    const Descent fine = descend(rest, coarse.z, steps, Pull::Robust, Differences::Forward);
    const paper::PaperModel model = turned(question.start, question.parameters, fine.z);
    for (const paper::FigureEntry& figure : question.figures) {
      if (whole_figure(figure.number) != figures[i]) continue;
      for (const PaperRow& row : figure.run(model).rows) {
        if (!paper::is_fitted(row)) continue;
        out.rows.push_back({row.figure, row.quantity, row.ours, row.ok});
      }
    }
  }
  return out;
}

}  // namespace biopsy::sim::calibration
