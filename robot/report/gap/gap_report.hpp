// The result of a comparison of model and data: as a page, as gap.json, as lines for a terminal, as a
// sentence. Text from files is sanitised.
#pragma once

#include <filesystem>
#include <string>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

// model.toml (the new model), report.html, signals.csv and gap.json. Makes the folder. Throws ConfigError
// where it cannot write.
void save_gap(const GapFinding& finding, const std::filesystem::path& folder);

// One self-contained page: verdict, where, before and after on the first sheet, then the evidence. No script,
// nothing from a network; prints on A4.
std::string gap_html(const GapFinding& finding);

// One line for each row of each run: role, input, measured, both models' readings, both residuals.
std::string signals_csv(const GapFinding& finding);

// The fields of docs/reference first and exactly, then additions. Numbers that are not known are null.
std::string gap_json(const GapFinding& finding);

// At most 30 lines: verdict, RMSE, failing margins, where, candidates, next experiment.
std::string gap_console(const GapFinding& finding);

// The verdict in a sentence or two.
std::string verdict_sentence(const GapFinding& finding);

}  // namespace biopsy::report
