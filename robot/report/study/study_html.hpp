// A study's answer as one page: a sentence, tables of finished texts, pictures. Loads nothing, runs no
// script, prints well. All text is escaped.
#pragma once

#include <string>
#include <vector>

#include "sim/paper/paper_figure.hpp"

namespace biopsy::report {

struct StudyTable {
  std::string heading;
  std::vector<std::string> columns;  // a leading > marks a column of numbers
  std::vector<std::vector<std::string>> rows;
};

struct StudyPage {
  std::string title;
  std::string sentence;              // the answer
  std::vector<std::string> remarks;  // what it rests on
  bool doubted = false;              // shown as an alarm
  std::vector<StudyTable> tables;
  std::vector<FigurePanel> panels;
};

std::string study_html(const StudyPage& page);

}  // namespace biopsy::report
