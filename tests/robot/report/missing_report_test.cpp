// The words for what the paper's figures lack. Results made up by hand.
#include "robot/report/study/missing_report.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace biopsy::report {
namespace {

using sim::missing::CandidateResult, sim::missing::MissingInPaper;

MissingInPaper example(std::size_t won) {
  MissingInPaper found;
  found.left_out = {"9", "7"};
  found.missed = {"9d 0.5 Hz: attenuated", "11 back"};
  found.rows = 20;
  found.met = 18;
  found.rows_held_out = 12;
  found.met_held_out = 4;
  CandidateResult creep{"creep", "creeps <slowly>", {{"pouch_creep.share", 0.25}}, {}, {}, 1.0};
  creep.fitted = {19, {"9d 0.5 Hz: attenuated"}, {}};
  for (std::size_t i = 0; i < won; ++i) creep.held_out.won.push_back("9d row " + std::to_string(i));
  creep.held_out.met = 4 + won;
  creep.chance = sim::missing::chance_of(won, 0);
  found.candidates = {creep, {"spring", "hardens", {}, {18, {}, {}}, {4, {}, {}}, 1.0}};
  return found;
}

TEST(MissingReport, NamesWhatWinsMoreThanChanceGives) {
  EXPECT_NE(missing_sentence(example(7)).find("The figures lack creep"), std::string::npos);
  const std::string few = missing_sentence(example(3));
  EXPECT_NE(few.find("No candidate is named"), std::string::npos) << few;
  EXPECT_NE(few.find("wins 3 of 12"), std::string::npos) << few;
  EXPECT_NE(missing_sentence(example(0)).find("none meets more than 4 of 12"), std::string::npos);
  EXPECT_NE(missing_sentence({}).find("No figure was left out"), std::string::npos);
}

TEST(MissingReport, SaysOfEachMissedRowWhatMeetsIt) {
  const std::string text = missing_text(example(3));
  EXPECT_NE(text.find("9d 0.5 Hz: attenuated: fitted creep; held out none"), std::string::npos) << text;
  EXPECT_NE(text.find("11 back: fitted none; held out none"), std::string::npos) << text;
  EXPECT_NE(text.find("pouch_creep.share 0.25"), std::string::npos) << text;
}

TEST(MissingReport, JsonAndPageHoldTheSame) {
  MissingInPaper found = example(3);
  found.interrupted = true;
  const auto json = nlohmann::json::parse(missing_json(found, 2.0));
  EXPECT_EQ(json["candidates"][0]["held_out"]["won"].size(), 3U);
  EXPECT_EQ(json["candidates"][0]["values"][0]["value"], 0.25);
  EXPECT_EQ(json["rows_held_out"], 12);
  EXPECT_TRUE(json["interrupted"]);
  EXPECT_EQ(json["sentence"], missing_sentence(found));
  const std::string page = missing_html(found);
  EXPECT_NE(page.find("creeps &lt;slowly&gt;"), std::string::npos);
  EXPECT_NE(page.find("only figures 9, 7 were left out"), std::string::npos);
}

}  // namespace
}  // namespace biopsy::report
