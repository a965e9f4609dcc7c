// The file of held-out rows, and what it puts beside a reproduction.
#include "sim/paper/held_out.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robot/common/config_error.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::sim::paper {
namespace {

HeldOut example() {
  return {{std::string(64, 'a'), std::string(64, 'b')},
          "biopsy calibrate --leave-one-out",
          3,
          2,
          1,
          {{"9a", "RMSE \"settled\"", 0.0712, true},
           {"9b", "RMSE", std::numeric_limits<double>::quiet_NaN(), false}}};
}

TEST(HeldOut, ReadsBackAsWritten) {
  const ScratchFolder folder;
  folder.write("held_out.toml", held_out_toml(example()));
  const HeldOut back = read_held_out(folder / "held_out.toml");
  EXPECT_TRUE(back.model == example().model);
  EXPECT_EQ(back.command, example().command);
  EXPECT_EQ(back.unknowns, 3U);
  EXPECT_EQ(back.numbers, 2U);
  EXPECT_EQ(back.statements, 1U);
  ASSERT_EQ(back.rows.size(), 2U);
  EXPECT_EQ(back.rows[0].quantity, "RMSE \"settled\"");
  EXPECT_DOUBLE_EQ(back.rows[0].ours, 0.0712);
  EXPECT_TRUE(std::isnan(back.rows[1].ours));
}

TEST(HeldOut, RefusesUnknownNames) {
  const ScratchFolder folder;
  folder.write("held_out.toml", held_out_toml(example()) + "colour = 1\n");
  EXPECT_THROW(read_held_out(folder / "held_out.toml"), ConfigError);
}

TEST(HeldOut, ADigestChangesWithEitherFile) {
  const ScratchFolder folder;
  folder.write("a", "1");
  folder.write("b", "2");
  const ModelDigests before = digests_of(folder / "a", folder / "b");
  folder.write("b", "3");
  EXPECT_EQ(digests_of(folder / "a", folder / "b").stage, before.stage);
  EXPECT_FALSE(digests_of(folder / "a", folder / "b") == before);
}

TEST(HeldOut, RowsAreMatchedByFigureAndQuantity) {
  Reproduction r;
  r.figures.resize(1);
  for (const char* figure : {"9a", "9b", "9c"}) {
    PaperRow row;
    row.figure = figure;
    row.quantity = figure == std::string("9a") ? "RMSE \"settled\"" : "RMSE";
    r.figures[0].rows.push_back(row);
  }
  add_held_out(r, example());
  EXPECT_TRUE(r.figures[0].rows[0].held_out->ok);
  EXPECT_FALSE(r.figures[0].rows[1].held_out->ok);
  EXPECT_FALSE(r.figures[0].rows[2].held_out.has_value());
  EXPECT_EQ(r.fitted->unknowns, 3U);
  Reproduction leakage = r;
  leakage.figures[0].rows[2].ok = true;
  add_leakage_model(r, leakage);
  EXPECT_TRUE(*r.figures[0].rows[2].leakage_ok);
  EXPECT_FALSE(*r.figures[0].rows[1].leakage_ok);
}

}  // namespace
}  // namespace biopsy::sim::paper
