#include "robot/report/study/missing_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "robot/common/text/number_text.hpp"
#include "robot/report/markup/json_values.hpp"
#include "robot/report/study/study_html.hpp"

namespace biopsy::report {
namespace {

using sim::missing::CandidateResult, sim::missing::Difference, sim::missing::MissingInPaper;

std::string won_and_lost(const Difference& difference) {
  return fmt::format("+{} -{}", difference.won.size(), difference.lost.size());
}

std::string values_text(const CandidateResult& candidate) {
  std::string text;
  for (const auto& value : candidate.values)
    text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", value.name, value.value);
  return text;
}

bool contains(const std::vector<std::string>& rows, const std::string& row) {
  return std::find(rows.begin(), rows.end(), row) != rows.end();
}

// Names of the candidates that meet the row, by the fit to all figures or by that without its figure.
std::string met_by(const MissingInPaper& found, const std::string& row, Difference CandidateResult::*in) {
  std::string text;
  for (const CandidateResult& candidate : found.candidates)
    if (contains((candidate.*in).won, row)) text += (text.empty() ? "" : ", ") + candidate.name;
  return text.empty() ? "none" : text;
}

std::string left_out_text(const MissingInPaper& found) {
  if (!found.interrupted) return "";
  return found.left_out.empty()
             ? "Interrupted before any figure was left out with every candidate."
             : fmt::format("Interrupted: only figures {} were left out.", fmt::join(found.left_out, ", "));
}

// What the counts mean, for the page and the terminal.
constexpr const char* kRemark =
    "Won and lost: rows against the same search without any candidate, from the same point. Chance: that as "
    "many of the "
    "held-out rows that changed were won, were each as likely lost; a candidate is named below 0.05 over the "
    "number of candidates.";

Json difference_json(const Difference& difference) {
  return {{"met", difference.met}, {"won", difference.won}, {"lost", difference.lost}};
}

Json tried_json(const CandidateResult& candidate) {
  Json values = Json::array();
  for (const auto& value : candidate.values) values.push_back({{"name", value.name}, {"value", value.value}});
  return {{"name", candidate.name},
          {"meaning", candidate.meaning},
          {"values", values},
          {"fitted", difference_json(candidate.fitted)},
          {"held_out", difference_json(candidate.held_out)},
          {"chance", candidate.chance}};
}

}  // namespace

std::string missing_sentence(const MissingInPaper& found) {
  std::vector<std::string> named;
  for (const CandidateResult& candidate : found.candidates)
    if (sim::missing::is_named(found, candidate)) named.push_back(candidate.name);
  if (!named.empty())
    return fmt::format(
        "The figures lack {}: of rows that the calibration had not seen, more are met with it.",
        fmt::join(named, ", "));
  if (found.left_out.empty() || found.candidates.empty())
    return "No figure was left out yet: nothing is said about what the figures lack.";
  const CandidateResult& best = found.candidates.front();
  if (best.held_out.net() <= 0)
    return fmt::format(
        "No candidate is named: none meets more than {} of {} held-out rows, which are met without any.",
        found.met_held_out, found.rows_held_out);
  return fmt::format(
      "No candidate is named: the best, {}, wins {} of {} held-out rows and loses {}, which chance does with "
      "probability {:.2f}.",
      best.name, best.held_out.won.size(), found.rows_held_out, best.held_out.lost.size(), best.chance);
}

std::string missing_text(const MissingInPaper& found) {
  std::string text = fmt::format("{}\n\n{:<20} {:>14} {:>16} {:>7}  {}\n", missing_sentence(found), "",
                                 fmt::format("fitted, of {}", found.rows),
                                 fmt::format("held out, of {}", found.rows_held_out), "chance", "found");
  text += fmt::format("{:<20} {:>14} {:>16}\n", "no candidate", found.met, found.met_held_out);
  for (const CandidateResult& candidate : found.candidates)
    text += fmt::format("{:<20} {:>7} {:>6} {:>9} {:>6} {:>7.2f}  {}\n", candidate.name, candidate.fitted.met,
                        won_and_lost(candidate.fitted), candidate.held_out.met,
                        won_and_lost(candidate.held_out), candidate.chance, values_text(candidate));
  text += "\nmissed without any candidate, and met with:\n";
  for (const std::string& row : found.missed)
    text += fmt::format("  {}: fitted {}; held out {}\n", row, met_by(found, row, &CandidateResult::fitted),
                        met_by(found, row, &CandidateResult::held_out));
  text += fmt::format("\n{}\n{}", kRemark, found.interrupted ? left_out_text(found) + "\n" : "");
  return text;
}

std::string missing_json(const MissingInPaper& found, double seconds) {
  Json all = {{"sentence", missing_sentence(found)},
              {"left_out", found.left_out},
              {"rows", found.rows},
              {"met", found.met},
              {"rows_held_out", found.rows_held_out},
              {"met_held_out", found.met_held_out},
              {"missed", found.missed},
              {"candidates", json_list(found.candidates, tried_json)},
              {"evaluations", found.evaluations},
              {"seconds", seconds}};
  if (found.interrupted) all["interrupted"] = true;
  return json_file(all);
}

std::string missing_html(const MissingInPaper& found) {
  StudyPage page;
  page.title = "What the paper's figures lack";
  page.sentence = missing_sentence(found);
  page.doubted = found.interrupted;
  if (found.interrupted) page.remarks.push_back(left_out_text(found));
  page.remarks.emplace_back(kRemark);
  StudyTable candidates{
      "Candidates",
      {"Candidate", ">Fitted", ">Won, lost", ">Held out", ">Won, lost", ">Chance", "Found", ""},
      {}};
  candidates.rows.push_back(
      {"none", std::to_string(found.met), "", std::to_string(found.met_held_out), "", "", "", ""});
  for (const CandidateResult& candidate : found.candidates)
    candidates.rows.push_back({candidate.name, std::to_string(candidate.fitted.met),
                               won_and_lost(candidate.fitted), std::to_string(candidate.held_out.met),
                               won_and_lost(candidate.held_out), fmt::format("{:.2f}", candidate.chance),
                               values_text(candidate), candidate.meaning});
  StudyTable rows{"Rows that are missed without any candidate", {"Row", "Met, fitted", "Met, held out"}, {}};
  for (const std::string& row : found.missed)
    rows.rows.push_back(
        {row, met_by(found, row, &CandidateResult::fitted), met_by(found, row, &CandidateResult::held_out)});
  page.tables = {candidates, rows};
  return study_html(page);
}

}  // namespace biopsy::report
