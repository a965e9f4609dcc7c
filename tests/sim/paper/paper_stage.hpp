// Models for the claims about the paper's figures.
#pragma once

#include <filesystem>

#include "sim/paper/paper_figure.hpp"
#include "sim/paper/paper_model.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim::paper {

// The stage of docs/explanation/model.md without any effect, and the films and mechanisms of
// sim/models/paper.toml.
inline PaperModel bare_paper_model() {
  const std::filesystem::path models = source_dir() / "sim/models";
  return read_paper_model(models / "baseline.toml", models / "paper.toml");
}

// The row whose words hold `words`; fails a test by returning none.
inline const PaperRow* row_about(const PaperFigure& figure, const std::string& words) {
  for (const PaperRow& row : figure.rows)
    if (row.quantity.find(words) != std::string::npos) return &row;
  return nullptr;
}

}  // namespace biopsy::sim::paper
