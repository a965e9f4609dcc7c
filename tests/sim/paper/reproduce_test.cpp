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

TEST(Reproduce, BriefExperimentsGiveTheRowsOfFullOnes) {
  PaperModel model = bare_paper_model();
  model.stage.baseline.c_s = 3.0;
  PaperModel brief = model;
  brief.brief = true;
  for (const char* figure : {"6", "7a", "7b", "8a", "8b"}) {
    const Reproduction a = reproduce(model, figure), b = reproduce(brief, figure);
    ASSERT_EQ(a.figures.at(0).rows.size(), b.figures.at(0).rows.size());
    for (std::size_t i = 0; i < a.figures[0].rows.size(); ++i) {
      const PaperRow &full = a.figures[0].rows[i], &soon = b.figures[0].rows[i];
      EXPECT_EQ(full.quantity, soon.quantity);
      EXPECT_NEAR(soon.ours, full.ours, 0.01 * std::abs(full.ours) + 0.02) << full.quantity;
    }
  }
}

}  // namespace
}  // namespace biopsy::sim::paper
