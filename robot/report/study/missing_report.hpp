// What the paper's figures lack: as text, JSON and a page.
#pragma once

#include <string>

#include "sim/paper/missing/find_missing.hpp"

namespace biopsy::report {

// Which effect the held-out rows name, or that they name none, and with how many rows.
std::string missing_sentence(const sim::missing::MissingInPaper& found);

std::string missing_text(const sim::missing::MissingInPaper& found);
std::string missing_json(const sim::missing::MissingInPaper& found, double seconds);
std::string missing_html(const sim::missing::MissingInPaper& found);

}  // namespace biopsy::report
