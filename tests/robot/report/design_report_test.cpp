#include "robot/report/study/design_report.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/count_of.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::report {
namespace {

DesignedStack stack(double stroke, double ripple) {
  DesignedStack out;
  out.figures = {stroke, ripple, 8.0, 50.0, 3.9, 16.5};
  return out;
}

DesignStudy example() {
  DesignStudy study;
  study.model = "sim/models/<mine>.toml";
  study.paper = stack(5.0, 0.1);
  study.best = {stack(6.0, 0.05), stack(7.0, 0.2)};
  study.demands = {"Stroke & push"};
  study.assumed = {"Oil flow stays"};
  study.panels = {{"Stroke against ripple", "ripple (mm)", "stroke (mm)", 0, 1, 0, 10, false, {}}};
  study.evaluated = 100;
  return study;
}

TEST(DesignHtml, ShowsEveryDesignThePapersFirstAndHowManyAreNoWorseInAnything) {
  const std::string html = design_html(example());
  EXPECT_EQ(count_of(html, "<tr class=\"paper\">"), 1U);
  EXPECT_LT(html.find("<tr class=\"paper\">"), html.find("<td>1</td>"));
  EXPECT_NE(html.find("<td>2</td>"), std::string::npos);
  EXPECT_NE(html.find("2 Pareto-optimal designs of 100 evaluated; 1 of them"), std::string::npos);
  EXPECT_NE(html.find("Stroke &amp; push"), std::string::npos);
  EXPECT_EQ(count_of(html, "class=\"panel\""), 1U);
}

TEST(DesignHtml, SaysInRedWhatThePapersOwnDesignDoesNotMeet) {
  DesignStudy study = example();
  EXPECT_EQ(design_html(study).find("class=\"alarm\""), std::string::npos);
  study.paper.broken = {"stack 40 mm high"};
  const std::string html = design_html(study);
  EXPECT_LT(html.find("class=\"alarm\""), html.find("stack 40 mm high"));
  EXPECT_NE(design_console(study).find("the paper's own: stack 40 mm high"), std::string::npos);
}

TEST(DesignHtml, LoadsNothingAndEscapesNames) {
  const std::string html = design_html(example());
  for (const char* outside : {"<script", "<link", "<img", "<mine>", "url(", "href="})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
}

TEST(DesignJson, HoldsEveryDesignWithItsFiguresAndNoNaN) {
  DesignStudy study = example();
  study.best[1].figures.ripple_mm = std::numeric_limits<double>::quiet_NaN();
  const auto parsed = nlohmann::json::parse(design_json(study));
  ASSERT_EQ(parsed["best"].size(), 2U);
  EXPECT_EQ(parsed["best"][0]["stroke_mm"], 6.0);
  EXPECT_TRUE(parsed["best"][1]["ripple_mm"].is_null());
  EXPECT_EQ(parsed["paper"]["film_um"], 50.0);
}

TEST(DesignReport, LeavesAPageAndAJsonFile) {
  const ScratchFolder folder;
  save_design(example(), folder / "out");
  EXPECT_TRUE(file_content(folder / "out/report.html").ends_with("</html>\n"));
  EXPECT_TRUE(nlohmann::json::accept(file_content(folder / "out/design.json")));
}

}  // namespace
}  // namespace biopsy::report
