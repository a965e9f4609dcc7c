// Names of the figures; results do not depend on how they are run.
#include "sim/paper/reproduce.hpp"

#include <gtest/gtest.h>

#include <set>

#include "robot/common/config_error.hpp"
#include "tests/sim/paper/paper_stage.hpp"

namespace biopsy::sim::paper {
namespace {

TEST(Reproduce, AFigureIsFoundByItsNumberAndAllItsPartsByTheirs) {
  EXPECT_EQ(figures_named("7a").size(), 1u);
  EXPECT_EQ(figures_named("9").size(), 4u);
  EXPECT_EQ(figures_named("4").size(), 1u);
}

TEST(Reproduce, RefusesAFigureThatThePaperLacksAndNamesThoseItHas) {
  for (const char* word : {"3", "1", "7c", "x", "7aa"}) {
    try {
      figures_named(word);
      ADD_FAILURE() << word;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos);
    }
  }
}

TEST(Reproduce, ReportsEachFigureOnceAndGivesThemInThePapersOrder) {
  std::set<std::string> seen;
  std::size_t last = 0;
  const Reproduction out =
      reproduce(bare_paper_model(), "6", [&](std::size_t done, std::size_t of, auto number) {
        EXPECT_EQ(done, ++last);
        EXPECT_EQ(of, 1u);
        seen.emplace(number);
      });
  EXPECT_EQ(seen, std::set<std::string>{"6"});
  EXPECT_EQ(out.figures.at(0).number, "6");
  EXPECT_GT(out.seconds, 0.0);
}

// Without those that are only shown: a brief experiment leaves some of them out.
std::vector<PaperRow> judged_rows(const PaperModel& model, const char* figure) {
  std::vector<PaperRow> rows = reproduce(model, figure).figures.at(0).rows;
  std::erase_if(rows, [](const PaperRow& row) { return row.kind == RowKind::Shown; });
  return rows;
}

TEST(Reproduce, BriefExperimentsGiveTheRowsOfFullOnes) {
  PaperModel model = bare_paper_model();
  model.stage.baseline.c_s = 3.0;
  PaperModel brief = model;
  brief.brief = true;
  for (const char* figure : {"6", "7a", "7b", "8a", "8b"}) {
    const std::vector<PaperRow> a = judged_rows(model, figure), b = judged_rows(brief, figure);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      const PaperRow &full = a[i], &soon = b[i];
      EXPECT_EQ(full.quantity, soon.quantity);
      EXPECT_NEAR(soon.ours, full.ours, 0.01 * std::abs(full.ours) + 0.02) << full.quantity;
    }
  }
}

}  // namespace
}  // namespace biopsy::sim::paper
