// The pieces of HTML a gap report is made of, and its own look on top of kPageStyle. Headings, captions and
// classes are taken as markup; everything else is escaped.
#pragma once

#include <string>
#include <vector>

namespace biopsy::report::markup {

std::string section(const std::string& heading, const std::string& content);
std::string figure(const std::string& svg, const std::string& caption_markup);  // empty without a picture
std::string paragraph(const std::string& text);

std::string text_cell(const std::string& text);
std::string number_cell(const std::string& text);
// "coulomb friction" with coulomb_friction small beside it.
std::string name_cell(const std::string& words, const std::string& name_in_files, bool strong = false);
std::string bar_cell(double share, const char* colour);  // with the percentage beside it

// A leading > marks a heading over numbers.
std::string table(const std::string& caption, const std::vector<std::string>& headings,
                  const std::string& rows);
std::string facts(const std::vector<std::pair<std::string, std::string>>& rows);

extern const char* const kGapStyle;

}  // namespace biopsy::report::markup
