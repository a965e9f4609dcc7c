#include "robot/report/plot/html_markup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robot/common/sanitize_text.hpp"
#include "robot/report/gap/gap_labels.hpp"

namespace biopsy::report::markup {

std::string page_head(const std::string& title, const std::string& own_style, Pictures pictures) {
  return std::string(
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n"
             "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; ") +
         (pictures == Pictures::Embedded ? "img-src data:; " : "") +
         "style-src 'unsafe-inline'\" />\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n<title>" +
         escaped(title) + "</title>\n<style>" + kPageStyle + own_style + "</style>\n</head>\n";
}

std::string key_figure(const std::string& name_markup, const std::string& value) {
  return "<div><dt>" + name_markup + "</dt><dd>" + escaped(value) + "</dd></div>\n";
}

std::string section(const std::string& heading, const std::string& content) {
  if (content.empty()) return {};
  return "<section>\n<h2>" + heading + "</h2>\n" + content + "</section>\n";
}

std::string figure(const std::string& svg, const std::string& caption_markup) {
  if (svg.empty()) return {};
  return "<figure>\n" + svg + "\n<figcaption>" + caption_markup + "</figcaption>\n</figure>\n";
}

std::string paragraph(const std::string& text) {
  return "<p>" + escaped(text) + "</p>\n";
}

std::string text_cell(const std::string& text) {
  return "<td>" + escaped(text.empty() ? "–" : text) + "</td>";
}

std::string number_cell(const std::string& text) {
  return "<td class=\"n\">" + escaped(text) + "</td>";
}

std::string name_cell(const std::string& words, const std::string& name_in_files, bool strong) {
  const std::string shown = strong ? "<strong>" + escaped(words) + "</strong>" : escaped(words);
  const std::string code = words == name_in_files ? "" : " <code>" + escaped(name_in_files) + "</code>";
  return "<th scope=\"row\" class=\"name\">" + shown + code + "</th>";
}

std::string bar_cell(double share, const char* colour) {
  const double shown = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0.0;
  return fmt::format(R"(<td class="level"><svg class="small-bar" viewBox="0 0 100 10" aria-hidden="true">)"
                     R"(<rect width="100" height="10" fill="#ffffff" stroke="#8b959d"/>)"
                     R"(<rect class="filled" width="{:.1f}" height="10" fill="{}"/></svg>{}</td>)",
                     100 * shown, colour, percent_text(share));
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

std::string facts(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::string html = "<table class=\"facts\">\n<tbody>\n";
  for (const auto& [name, value] : rows)
    html += "<tr><th scope=\"row\">" + escaped(name) + "</th><td class=\"long\">" +
            escaped(value.empty() ? "–" : value) + "</td></tr>\n";
  return html + "</tbody>\n</table>\n";
}

// Every badge has its own word and sign; white on these grounds has a contrast above 7.
const char* const kGapStyle = R"css(
.verdict .badge { display: inline-block; padding: 3px 12px; margin-left: 10px; color: #fff; background: #46525c;
  font-weight: bold; font-size: .95rem; letter-spacing: .03em; }
.badge.effect { background: #00457c; } .badge.parameter { background: #5b2a73; }
.badge.no_gap { background: #0a5540; } .badge.unexplained { background: #6e4100; }
.verdict .sentence { font-size: 1.45rem; line-height: 1.35; font-weight: bold; }
.verdict .safety { margin-top: 12px; font-size: 1rem; }
.verdict .finding { margin-top: 12px; padding: 8px 12px; border: 2px solid #b00020; background: #fdf1f2; font-size: 1rem; }
.verdict.unsafe { border-left-color: #b00020; }
.verdict ul { margin: 4px 0 0; padding-left: 24px; }
.gap .figures { grid-template-columns: repeat(auto-fit, minmax(130px, 1fr)); }
td.n + td:not(.n), th.n + th:not(.n) { padding-left: 14px; }
th.name { font-weight: normal; }
code { color: #46525c; font-size: .85em; }
p, li { max-width: 62em; }
.small-bar { width: 84px; height: 10px; margin-right: 8px; display: inline-block; }
tr.chosen { background: #e3edf6; }
.diff { font: .85rem/1.4 "DejaVu Sans Mono", Consolas, monospace; border: 1px solid #aab1b7; background: #fff;
  padding: 8px 0; margin: 0; overflow-x: auto; white-space: pre-wrap; overflow-wrap: anywhere; }
.diff span { display: block; padding: 0 12px; }
.diff .removed { background: #fbe3d1; } .diff .added { background: #d6e8f7; } .diff .skipped { color: #46525c; }
@page { margin: 11mm 12mm; }
@media print {
  .badge, tr.chosen, .diff span, .finding { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  .verdict .sentence { font-size: 1.25rem; }
  h1 { margin: 0 0 6px; } h2 { margin-bottom: 4px; } p { margin: 4px 0; } figure { margin-top: 4px; }
  figcaption { font-size: .85rem; margin-top: 1px; }
  section { padding-top: 5px; margin: 6px 0; }
  .gap .figures { grid-template-columns: repeat(auto-fit, minmax(96px, 1fr)); gap: 4px 10px; margin-top: 8px; }
  .verdict .safety, .verdict .finding { margin-top: 6px; padding-top: 3px; padding-bottom: 3px; }
  table { break-inside: avoid; font-size: .85rem; } th, td { padding-top: 2px; padding-bottom: 2px; }
}
)css";

}  // namespace biopsy::report::markup
