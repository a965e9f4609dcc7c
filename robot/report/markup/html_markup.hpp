// The elements of HTML that every report is made of. Headings, captions and classes are taken as markup;
// everything else is escaped.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace biopsy::report::markup {

// A whole page. It may load nothing, whatever a file's text may contain; pictures only where they are
// embedded in it.
struct Page {
  std::string title;
  std::string heading = {};        // empty: the title
  std::string style = {};          // added to kPageStyle
  std::string banner = {};         // above everything
  bool embedded_pictures = false;  // may hold data: images
};
std::string page(const Page& page, const std::string& content);

std::string section(const std::string& heading, const std::string& content);  // empty without content
// The first section: `state` is added to its class; the sentence is escaped, `content` is not.
std::string verdict_section(const std::string& state, const std::string& sentence,
                            const std::string& content);
std::string figure(const std::string& svg, const std::string& caption_markup);  // empty without a picture
std::string panels(const std::vector<std::string>& svgs);                       // side by side
std::string paragraph(const std::string& text);
std::string list(const std::vector<std::string>& items);
std::string alarm(const std::string& text);

std::string text_cell(const std::string& text);
std::string number_cell(const std::string& text);
std::string number_cell(double value, int decimals);
// "coulomb friction" with coulomb_friction small beside it.
std::string name_cell(const std::string& label, const std::string& name_in_files, bool strong = false);
std::string bar_cell(double share, const char* colour);  // with the percentage beside it
std::string row(const std::vector<std::string>& cells, const std::string& css_class = "");

// A leading > marks a heading over numbers.
std::string table(const std::string& caption, const std::vector<std::string>& headings,
                  const std::string& rows);
// Large numbers of a page's first section: name (markup) and value.
std::string key_figures(const std::vector<std::pair<std::string, std::string>>& figures);
std::string facts(const std::vector<std::pair<std::string, std::string>>& rows);

// The look of every page, on screen and on paper, and what a gap report adds to it (html_style.cpp).
extern const char* const kPageStyle;
extern const char* const kGapStyle;

}  // namespace biopsy::report::markup
