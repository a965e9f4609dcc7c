#include "sim/paper/calibration/leave_one_out.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "sim/paper/calibration/gradient_steps.hpp"
#include "sim/paper/figures/figures.hpp"

namespace biopsy::sim::calibration {

std::string whole_figure(std::string_view number) {
  while (!number.empty() && std::isalpha(static_cast<unsigned char>(number.back())) != 0)
    number.remove_suffix(1);
  return std::string(number);
}

std::vector<std::string> whole_figures(const Question& question) {
  std::vector<std::string> figures;
  for (const paper::FigureEntry& figure : question.figures)
    if (figures.empty() || figures.back() != whole_figure(figure.number))
      figures.push_back(whole_figure(figure.number));
  return figures;
}

Question without_figure(Question question, std::string_view whole) {
  std::erase_if(question.figures, [&](const auto& figure) { return whole_figure(figure.number) == whole; });
  return question;
}

Question figure_alone(Question question, std::string_view whole) {
  std::erase_if(question.figures, [&](const auto& figure) { return whole_figure(figure.number) != whole; });
  return question;
}

Descent descend_from_nominal(const Question& question, int steps, const std::stop_token& stop) {
  const auto nominal = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(question.parameters.size()));
  const Descent coarse = descend(question, nominal, steps, Pull::Even, Differences::Forward, stop);
  Descent fine = descend(question, coarse.z, steps, Pull::Robust, Differences::Forward, stop);
  fine.evaluations += coarse.evaluations;
  return fine;
}

paper::HeldOut leave_one_out(const Question& question, int steps, const CalibrationProgress& progress,
                             const std::stop_token& stop) {
  paper::HeldOut out;
  out.unknowns = question.parameters.size();
  const std::vector<std::string> figures = whole_figures(question);
  const auto nominal = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(question.parameters.size()));
  for (const PaperRow& row : rows_at(question, nominal, true))
    ++(row.kind == RowKind::Trend ? out.statements : out.numbers);
  for (std::size_t i = 0; i < figures.size() && !stop.stop_requested(); ++i) {
    if (progress)
      progress(static_cast<double>(i) / static_cast<double>(figures.size()),
               fmt::format("without figure {}, from the nominal values", figures[i]));
    const Descent rest = descend_from_nominal(without_figure(question, figures[i]), steps, stop);
    if (stop.stop_requested()) break;
    const paper::PaperModel model = turned(question.start, question.parameters, rest.z);
    for (const paper::FigureEntry& figure : figure_alone(question, figures[i]).figures)
      for (const PaperRow& row : figure.run(model).rows)
        if (paper::is_fitted(row)) out.rows.push_back({row.figure, row.quantity, row.ours, row.ok});
  }
  return out;
}

}  // namespace biopsy::sim::calibration
