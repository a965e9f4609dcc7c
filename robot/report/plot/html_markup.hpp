// The pieces of HTML that every report is made of. Headings, captions and classes are taken as markup;
// everything else is escaped.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace biopsy::report::markup {

// Everything before <body>: `own_style` comes on top of kPageStyle. The page may load nothing, whatever a
// file's text may contain; pictures only where they stand in it.
enum class Pictures : std::uint8_t { None, Embedded };
std::string page_head(const std::string& title, const std::string& own_style,
                      Pictures pictures = Pictures::None);

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
// One large number of a page's first section.
std::string key_figure(const std::string& name_markup, const std::string& value);
std::string facts(const std::vector<std::pair<std::string, std::string>>& rows);

// The look of every page, on screen and on paper (html_style.cpp), and what a gap report adds to it.
extern const char* const kPageStyle;
extern const char* const kGapStyle;

}  // namespace biopsy::report::markup
