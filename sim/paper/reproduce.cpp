#include "sim/paper/reproduce.hpp"

#include <fmt/format.h>

#include <chrono>
#include <exception>
#include <mutex>

#include "robot/common/config_error.hpp"
#include "robot/common/in_parallel.hpp"
#include "sim/paper/figures/figures.hpp"

namespace biopsy::sim::paper {
namespace {

bool is_part_of(std::string_view number, std::string_view figure) {
  return number.size() == figure.size() + 1 && number.starts_with(figure) && number.back() >= 'a';
}

}  // namespace

const std::vector<FigureEntry>& all_figures() {
  static const std::vector<FigureEntry> kFigures{
      {"2", figure_2},   {"4", figure_4},   {"6", figure_6},   {"7a", figure_7a},
      {"7b", figure_7b}, {"8a", figure_8a}, {"8b", figure_8b}, {"9a", figure_9a},
      {"9b", figure_9b}, {"9c", figure_9c}, {"9d", figure_9d}, {"10", figure_10},
      {"11", figure_11}, {"12", figure_12}, {"13", figure_13}, {"beyond", beyond}};
  return kFigures;
}

std::vector<FigureEntry> figures_named(std::string_view wanted) {
  std::vector<FigureEntry> found;
  std::string known;
  for (const FigureEntry& figure : all_figures()) {
    known += fmt::format("{}{}", known.empty() ? "" : ", ", figure.number);
    if (wanted.empty() || figure.number == wanted || is_part_of(figure.number, wanted))
      found.push_back(figure);
  }
  if (found.empty())
    throw ConfigError(fmt::format("the paper has no experiment \"{}\" that is reproduced here", wanted),
                      "FIGURE", "name one of " + known + "; or none for all of them");
  return found;
}

Reproduction reproduce(const PaperModel& model, std::string_view wanted, const FigureProgress& progress,
                       const std::stop_token& stop) {
  const auto started = std::chrono::steady_clock::now();
  const std::vector<FigureEntry> figures = figures_named(wanted);
  Reproduction out;
  out.model = model.name;
  out.figures.resize(figures.size());
  std::vector<std::exception_ptr> failed(figures.size());
  std::mutex one_at_a_time;
  std::size_t done = 0;
  in_parallel(figures.size(), [&](std::size_t i) {
    if (stop.stop_requested()) return;
    try {
      out.figures[i] = figures[i].run(model);
    } catch (...) {
      failed[i] = std::current_exception();
    }
    const std::scoped_lock lock(one_at_a_time);
    if (progress) progress(++done, figures.size(), figures[i].number);
  });
  for (const std::exception_ptr& failure : failed)
    if (failure) std::rethrow_exception(failure);
  for (std::size_t i = 0; i < figures.size(); ++i)
    if (out.figures[i].number.empty()) out.left_out.emplace_back(figures[i].number);
  std::erase_if(out.figures, [](const PaperFigure& figure) { return figure.number.empty(); });
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return out;
}

}  // namespace biopsy::sim::paper
