// The page of a study: what it was given, escaped, and nothing that a browser would load.
#include "robot/report/study/study_html.hpp"

#include <gtest/gtest.h>

namespace biopsy::report {
namespace {

StudyPage example() {
  StudyPage page;
  page.title = "Gains & margins";
  page.sentence = "a < b";
  page.remarks = {"<script>alert(1)</script>"};
  page.tables = {{"Scores", {"Name", ">Value"}, {{"one", "1.5 mm"}, {"<two>", "2.5 mm"}}}};
  FigurePanel panel;
  panel.title = "steps";
  panel.curves = {{"curve", {0.0, 1.0}, {0.0, 1.0}}};
  page.panels = {panel};
  return page;
}

TEST(StudyHtml, ShowsTablesAndPicturesEscaped) {
  const std::string html = study_html(example());
  EXPECT_NE(html.find("<h1>Gains &amp; margins</h1>"), std::string::npos);
  EXPECT_NE(html.find("a &lt; b"), std::string::npos);
  EXPECT_NE(html.find("&lt;two&gt;"), std::string::npos);
  EXPECT_NE(html.find("<td class=\"n\">2.5 mm</td>"), std::string::npos);
  EXPECT_NE(html.find("<svg"), std::string::npos);
  EXPECT_EQ(html.find("<script"), std::string::npos);
}

TEST(StudyHtml, IsMarkedWhereItsAnswerIsDoubted) {
  StudyPage page = example();
  EXPECT_EQ(study_html(page).find("verdict doubted"), std::string::npos);
  page.doubted = true;
  EXPECT_NE(study_html(page).find("verdict doubted"), std::string::npos);
}

TEST(StudyHtml, LeavesOutWhatIsNotThere) {
  StudyPage page = example();
  page.tables.clear();
  page.panels.clear();
  const std::string html = study_html(page);
  EXPECT_EQ(html.find("<svg"), std::string::npos);
  EXPECT_EQ(html.find("<table"), std::string::npos);
  EXPECT_EQ(html, study_html(page));
}

}  // namespace
}  // namespace biopsy::report
