// Tables of the documentation, in docs/reference/figures as the run that measured them wrote them:
// {"command", "document", "with": versions that the figures depend on, "rows": [[cells of a row]]}. That the
// document has these rows is claimed in tests/architecture.
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/source_dir.hpp"

namespace biopsy {

struct KeptFigures {
  std::string command, document, with;  // document: below docs/
  std::vector<std::vector<std::string>> rows;
};

inline std::filesystem::path figures_file(const std::string& name) {
  return source_dir() / "docs/reference/figures" / (name + ".json");
}

inline KeptFigures read_figures(const std::string& name) {
  std::ifstream file(figures_file(name));
  const auto kept = nlohmann::json::parse(file);
  return {kept.at("command"), kept.at("document"), kept.at("with"), kept.at("rows")};
}

inline void write_figures(const std::string& name, const KeptFigures& figures) {
  const nlohmann::ordered_json kept{{"command", figures.command},
                                    {"document", figures.document},
                                    {"with", figures.with},
                                    {"rows", figures.rows}};
  std::ofstream(figures_file(name)) << kept.dump(1) << '\n';
}

}  // namespace biopsy
