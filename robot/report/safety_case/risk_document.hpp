// The risk management file as one document: the same content as a page of Markdown and as part of the case's
// report.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "robot/report/safety_case/safety_case.hpp"

namespace biopsy::safety_case {

struct DocumentTable {
  std::vector<std::string> headings;
  std::vector<std::vector<std::string>> rows;
};

struct DocumentSection {
  int level = 2;  // of its heading
  std::string heading;
  std::vector<std::string> sentences;                        // as a list
  DocumentTable table{};                                     // may be empty
  std::vector<std::pair<std::string, std::string>> facts{};  // name and text
};

// It holds no figure of a run: those are in the case's report, beside their date and code.
std::vector<DocumentSection> risk_document(const SafetyCase& safety_case);

// docs/reference/risk-management.md, whole.
std::string risk_markdown(const SafetyCase& safety_case);

std::string risk_html(const SafetyCase& safety_case);

}  // namespace biopsy::safety_case
