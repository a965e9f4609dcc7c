#include "robot/report/markup/html_markup.hpp"

namespace biopsy::report::markup {

// Grey ground, ink and white; the only saturated colour (#b00020) is for alarms. State = word + shape +
// colour.
const char* const kPageStyle = R"css(
:root { color: #1d262e; background: #d4d7da; font: 16px/1.45 "DejaVu Sans", "Segoe UI", Arial, sans-serif;
  font-variant-numeric: tabular-nums; }
body { margin: 0 auto; max-width: 1120px; padding: 0 20px 40px; }
h1 { font-size: 1.35rem; margin: 18px 0 8px; }
h2 { font-size: 1.1rem; margin: 0 0 10px; }
h3 { font-size: 1rem; margin: 14px 0 6px; }
section { background: #f6f7f8; border: 1px solid #aab1b7; padding: 14px 18px; margin: 14px 0; }
.simulated { position: sticky; top: 0; z-index: 1; margin: 0 -20px; padding: 7px 20px; background: #1d262e; color: #fff; }
.simulated strong { letter-spacing: .12em; margin-right: 1em; }
.watermark { display: none; }
.verdict { border-left: 10px solid #55636f; }
.verdict p { margin: 0; font-size: 1.2rem; }
.verdict .sentence { font-size: 1.4rem; line-height: 1.35; font-weight: bold; }
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(380px, 1fr)); gap: 10px 16px; align-items: end; }
.panels.lone { grid-template-columns: minmax(380px, 720px); }
.panels figure { margin: 0; }
.verdict .shape { font-size: 1.3rem; margin-right: .35em; }
.verdict.refused { border-left-color: #1d262e; border-left-style: double; }
.verdict.stopped, .verdict.doubted { border-left-color: #b00020; }
.verdict.stopped .shape, .alarm { color: #b00020; font-weight: bold; }
.figures { display: grid; grid-template-columns: repeat(auto-fill, minmax(165px, 1fr)); gap: 8px 18px; margin: 14px 0 0; }
.figures dt { color: #46525c; font-size: .85rem; }
.figures dd { margin: 0; font-size: 1.1rem; font-weight: bold; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; }
caption { text-align: left; color: #46525c; padding-bottom: 4px; }
th, td { text-align: left; vertical-align: top; padding: 4px 10px 4px 0; border-bottom: 1px solid #ccd1d5; }
thead th { border-bottom: 2px solid #55636f; }
th.n, td.n { text-align: right; white-space: nowrap; }
table.facts th { font-weight: normal; color: #46525c; width: 15em; }
td.long { overflow-wrap: anywhere; }
td.level { white-space: nowrap; }
figure { margin: 10px 0 0; }
figure svg, figure img { display: block; width: 100%; height: auto; }
figure img { max-width: 640px; background: #000; }
figcaption { font-size: .9rem; color: #333e47; margin-top: 5px; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 14px; }
.bar { width: 220px; height: 18px; display: block; }
@media screen and (max-width: 800px) { .pair { grid-template-columns: 1fr; } section { overflow-x: auto; } }
@page { size: A4; margin: 16mm 12mm 14mm; }
@media print {
  :root { background: #fff; font-size: 11.5px; }
  body { max-width: none; padding: 0; }
  section { background: none; border: 0; border-top: 1px solid #55636f; padding: 8px 0 0; margin: 10px 0 0; }
  .verdict { border-left-width: 8px; border-left-style: solid; padding-left: 12px; }
  .simulated { position: static; margin: 0; border: 2px solid #1d262e; background: none; color: #1d262e; }
  figure, tr, .verdict, h2, h3 { break-inside: avoid; }
  h2, h3 { break-after: avoid; }
  .pair { max-width: 146mm; }
  .panels { grid-template-columns: 1fr 1fr; break-inside: avoid; } .panels.lone { grid-template-columns: 125mm; }
  .watermark { display: block; position: fixed; z-index: -1; top: 42%; left: 0; right: 0; text-align: center; font-size: 84px;
    font-weight: bold; letter-spacing: .1em; color: #000; opacity: .09; transform: rotate(-35deg); }
}
)css";

// Every badge has its own label and sign; white on these grounds has a contrast above 7 (WCAG 2.1, 1.4.6).
const char* const kGapStyle = R"css(
.verdict .badge { display: inline-block; padding: 3px 12px; margin-left: 10px; color: #fff; background: #46525c;
  font-weight: bold; font-size: .95rem; letter-spacing: .03em; }
.badge.effect { background: #00457c; } .badge.parameter { background: #5b2a73; }
.badge.no_gap { background: #0a5540; } .badge.unexplained { background: #6e4100; }
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
