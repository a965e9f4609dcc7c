#include "robot/report/markup/html_markup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/report/gap/gap_labels.hpp"

namespace biopsy::report::markup {

std::string page(const Page& page, const std::string& content) {
  const std::string& heading = page.heading.empty() ? page.title : page.heading;
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; {}style-src "
      "'unsafe-inline'\" />\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n"
      "<title>{}</title>\n<style>{}{}</style>\n</head>\n<body>\n{}<main>\n<h1>{}</h1>\n{}</main>\n</body>\n"
      "</html>\n",
      page.embedded_pictures ? "img-src data:; " : "", escaped(page.title), kPageStyle, page.style,
      page.banner, escaped(heading), content);
}

std::string section(const std::string& heading, const std::string& content) {
  if (content.empty()) return {};
  return "<section>\n<h2>" + heading + "</h2>\n" + content + "</section>\n";
}

std::string verdict_section(const std::string& state, const std::string& sentence,
                            const std::string& content) {
  return "<section class=\"verdict" + (state.empty() ? "" : " " + state) + "\">\n<p class=\"sentence\">" +
         escaped(sentence) + "</p>\n" + content + "</section>\n";
}

std::string figure(const std::string& svg, const std::string& caption_markup) {
  if (svg.empty()) return {};
  return "<figure>\n" + svg + "\n<figcaption>" + caption_markup + "</figcaption>\n</figure>\n";
}

std::string panels(const std::vector<std::string>& svgs) {
  if (svgs.empty()) return {};
  std::string html = svgs.size() == 1 ? "<div class=\"panels lone\">\n" : "<div class=\"panels\">\n";
  for (const std::string& svg : svgs) html += "<figure>\n" + svg + "\n</figure>\n";
  return html + "</div>\n";
}

std::string paragraph(const std::string& text) {
  return "<p>" + escaped(text) + "</p>\n";
}

std::string list(const std::vector<std::string>& items) {
  std::string html = "<ul>\n";
  for (const std::string& item : items) html += "<li>" + escaped(item) + "</li>\n";
  return html + "</ul>\n";
}

std::string alarm(const std::string& text) {
  return "<p class=\"alarm\">■ " + escaped(text) + "</p>\n";
}

std::string text_cell(const std::string& text) {
  return "<td>" + escaped(text.empty() ? "–" : text) + "</td>";
}

std::string number_cell(const std::string& text) {
  return "<td class=\"n\">" + escaped(text) + "</td>";
}

std::string number_cell(double value, int decimals) {
  return number_cell(fixed(value, decimals));
}

std::string name_cell(const std::string& label, const std::string& name_in_files, bool strong) {
  const std::string shown = strong ? "<strong>" + escaped(label) + "</strong>" : escaped(label);
  const std::string code = label == name_in_files ? "" : " <code>" + escaped(name_in_files) + "</code>";
  return "<th scope=\"row\" class=\"name\">" + shown + code + "</th>";
}

std::string bar_cell(double share, const char* colour) {
  const double shown = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0.0;
  return fmt::format(R"(<td class="level"><svg class="small-bar" viewBox="0 0 100 10" aria-hidden="true">)"
                     R"(<rect width="100" height="10" fill="#ffffff" stroke="#8b959d"/>)"
                     R"(<rect class="filled" width="{:.1f}" height="10" fill="{}"/></svg>{}</td>)",
                     100 * shown, colour, percent_text(share));
}

std::string row(const std::vector<std::string>& cells, const std::string& css_class) {
  return (css_class.empty() ? "<tr>" : "<tr class=\"" + css_class + "\">") +
         fmt::format("{}</tr>\n", fmt::join(cells, ""));
}

std::string table(const std::string& caption, const std::vector<std::string>& headings,
                  const std::string& rows) {
  std::string html =
      "<table>\n" + (caption.empty() ? "" : "<caption>" + caption + "</caption>\n") + "<thead><tr>";
  for (const std::string& heading : headings)
    html += heading.starts_with('>') ? "<th scope=\"col\" class=\"n\">" + heading.substr(1) + "</th>"
                                     : "<th scope=\"col\">" + heading + "</th>";
  return html + "</tr></thead>\n<tbody>\n" + rows + "</tbody>\n</table>\n";
}

std::string key_figures(const std::vector<std::pair<std::string, std::string>>& figures) {
  std::string html = "<dl class=\"figures\">\n";
  for (const auto& [name, value] : figures)
    html += "<div><dt>" + name + "</dt><dd>" + escaped(value) + "</dd></div>\n";
  return html + "</dl>\n";
}

std::string facts(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::string html = "<table class=\"facts\">\n<tbody>\n";
  for (const auto& [name, value] : rows)
    html += "<tr><th scope=\"row\">" + escaped(name) + "</th><td class=\"long\">" +
            escaped(value.empty() ? "–" : value) + "</td></tr>\n";
  return html + "</tbody>\n</table>\n";
}

}  // namespace biopsy::report::markup
