#include <fmt/format.h>

#include <set>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/safety_case/case_page.hpp"
#include "robot/report/safety_case/gaps.hpp"

namespace biopsy::safety_case {
namespace {

constexpr std::size_t kWidth = 44;  // characters of a line in a box

// A text as a label of graphviz: broken into lines, quoted.
std::string label(const std::string& title, const std::string& text) {
  std::string quoted;
  for (const char c : title + "\\n" + joined(wrapped(text, kWidth), "\\n"))
    quoted += c == '"' ? std::string("\\\"") : std::string(1, c);
  return "\"" + quoted + "\"";
}

// As much of a requirement as a box holds: its first clause.
std::string first_clause(const std::string& text) {
  return text.substr(0, text.find_first_of(":;."));
}

class Drawing {
 public:
  explicit Drawing(const std::vector<Gap>& gaps) {
    for (const Gap& gap : gaps) alarmed_.insert(gap.where);
  }
  void node(const std::string& id, const std::string& text, const std::string& shape) {
    const bool alarmed = alarmed_.contains(id);
    out_ += fmt::format("  \"{}\" [label={} {}{}];\n", id, label(id, text), shape,
                        alarmed ? " color=\"#b00020\" penwidth=3" : "");
  }
  void link(const std::string& from, const std::string& to, const char* style = "") {
    out_ += fmt::format("  \"{}\" -> \"{}\"{};\n", from, to, style);
  }
  std::string text() const {
    return "digraph argument {\n  rankdir=LR; nodesep=0.12; ranksep=0.9; bgcolor=\"transparent\";\n"
           "  node [fontname=\"DejaVu Sans\" fontsize=10 color=\"#55636f\" style=filled fillcolor=white];\n"
           "  edge [color=\"#8b959d\" arrowsize=0.6];\n" +
           out_ + "}\n";
  }

 private:
  std::set<std::string> alarmed_;
  std::string out_;
};

std::string solution_text(const Source& source, const std::vector<Finding>& findings) {
  const Finding* finding = finding_of(findings, source.id);
  if (finding == nullptr) return "not run";
  std::string text;
  for (const Criterion& criterion : source.criteria)
    if (const auto figure = finding->figures.find(criterion.figure); figure != finding->figures.end())
      text += fmt::format("{}{} {:g}", text.empty() ? "" : ", ", criterion.name, figure->second);
  return text.empty() ? source.title : text;
}

}  // namespace

std::string argument_dot(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                         const std::vector<Gap>& gaps) {
  Drawing drawing(gaps);
  drawing.node("G-1", safety_case.claim, "shape=box");
  drawing.node("C-1",
               "software and simulated stage of this build; what is not covered is listed in the report",
               "shape=box style=\"rounded,filled\"");
  drawing.node("S-1", "argument over every identified hazard and its risk controls", "shape=parallelogram");
  drawing.link("G-1", "C-1", " [arrowhead=empty]");
  drawing.link("G-1", "S-1");
  for (const Hazard& hazard : safety_case.hazards) {
    const bool controlled = !hazard.requirements.empty();
    drawing.node(
        hazard.id,
        hazard.name + (controlled ? " is detected and controlled in time"
                                  : " is not controlled by the software: see the risk management file"),
        controlled ? "shape=box" : "shape=box style=\"dashed\"");
    drawing.link("S-1", hazard.id);
    for (const std::string& requirement : hazard.requirements) drawing.link(hazard.id, requirement);
  }
  for (const Requirement& requirement : safety_case.requirements) {
    drawing.node(requirement.id, first_clause(requirement.text), "shape=box");
    const std::size_t tests = tests_for(findings, requirement.id).size();
    drawing.node("Sn " + requirement.id, counted(tests, "test"), "shape=circle margin=0.02");
    drawing.link(requirement.id, "Sn " + requirement.id);
    for (const std::string& proof : requirement.proofs) drawing.link(requirement.id, proof);
  }
  for (const Source& source : safety_case.sources)
    if (source.kind == SourceKind::Proof || finding_of(findings, source.id) == nullptr)
      drawing.node(source.id, solution_text(source, findings), "shape=ellipse");
    else
      drawing.node(source.id, source.title, "shape=ellipse");
  return drawing.text();
}

}  // namespace biopsy::safety_case
