// All of the paper's experiments on one model.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "sim/paper/paper_figure.hpp"
#include "sim/paper/paper_model.hpp"

namespace biopsy::sim::paper {

using FigureFunction = PaperFigure (*)(const PaperModel&);

struct FigureEntry {
  std::string_view number;  // "7a"
  FigureFunction run;
};

// In the paper's order; "beyond" last.
const std::vector<FigureEntry>& all_figures();

// The figures named by `wanted`: all where it is empty, one ("7a"), or all parts of one ("7"). Throws
// ConfigError for any other name.
std::vector<FigureEntry> figures_named(std::string_view wanted);

// Called from any thread, one call at a time: how many figures are done, of how many, and which was last.
using FigureProgress = std::function<void(std::size_t done, std::size_t of, std::string_view number)>;

// Runs them, several at a time; the answer does not depend on how many. After `stop` no further one is begun.
Reproduction reproduce(const PaperModel& model, std::string_view wanted = {},
                       const FigureProgress& progress = {}, const std::stop_token& stop = {});

}  // namespace biopsy::sim::paper
