// biopsy effects: the library for people and for programs, and names typed wrong.
#include "tests/robot/cli/command.hpp"

namespace biopsy::cli_tests {
namespace {

TEST(EffectsCommand, ListsEveryEffectWithWhereItAttachesAndItsSentence) {
  const std::string list = biopsy("effects").text;
  const nlohmann::json library = nlohmann::json::parse(biopsy("effects --json").text);
  ASSERT_GE(library.size(), 24U);
  for (const auto& effect : library) {
    const std::string name = effect["name"], attaches = effect["attaches"], sentence = effect["sentence"];
    const std::size_t row = list.find("\n" + name + " ");
    ASSERT_TRUE(row != std::string::npos || list.starts_with(name + " ")) << name;
    const std::size_t from = row == std::string::npos ? 0 : row + 1;
    const std::string line = list.substr(from, list.find('\n', from) - from);
    EXPECT_NE(line.find(" " + attaches + " "), std::string::npos) << line;
    EXPECT_TRUE(line.ends_with(sentence)) << line;
  }
}

TEST(EffectsCommand, SaysAllAboutOne) {
  const Outcome answer = biopsy("effects stribeck_friction");
  EXPECT_EQ(answer.code, 0);
  for (const char* word : {"stage", "exp(-(v/speed)^2)", "slow_triangle", "Armstrong", "sliding_N",
                           "breakaway_N", "speed_mm_s", "strength", "shape"})
    EXPECT_NE(answer.text.find(word), std::string::npos) << word << "\n" << answer.text;
  const nlohmann::json one = nlohmann::json::parse(biopsy("effects stribeck_friction --json").text);
  EXPECT_EQ(one["name"], "stribeck_friction");
  ASSERT_EQ(one["parameters"].size(), 3U);
  EXPECT_EQ(one["parameters"][2]["unit"], "mm/s");
  EXPECT_EQ(one["parameters"][2]["role"], "shape");
}

TEST(EffectsCommand, GivesEveryParameterAPlaceInItsRangeAndAUnitOrNone) {
  for (const auto& effect : nlohmann::json::parse(biopsy("effects --json").text)) {
    int strengths = 0, levels = 0;
    ASSERT_FALSE(effect["parameters"].empty());
    for (const auto& p : effect["parameters"]) {
      EXPECT_TRUE(p["low"] <= p["typical"] && p["typical"] <= p["high"]) << effect["name"] << p;
      EXPECT_FALSE(p["meaning"].get<std::string>().empty()) << effect["name"] << p;
      strengths += static_cast<int>(p["role"] == "strength");
      levels += static_cast<int>(p["role"] == "level");
    }
    EXPECT_GT(strengths + levels, 0) << effect["name"] << " cannot be made to vanish";
  }
}

TEST(EffectsCommand, AnUnknownNameIsRefusedWithThoseThatAreClose) {
  const Outcome typing = biopsy("effects coulom_frction"), part = biopsy("effects friction"),
                nothing = biopsy("effects xyzzy");
  for (const Outcome& answer : {typing, part, nothing}) {
    EXPECT_EQ(answer.code, 2) << answer.text;
    EXPECT_NE(answer.text.find("to do: "), std::string::npos) << answer.text;
  }
  EXPECT_NE(typing.text.find("close: coulomb_friction;"), std::string::npos) << typing.text;
  for (const char* name : {"coulomb_friction", "stribeck_friction", "shaft_friction", "lugre_friction",
                           "load_dependent_friction"})
    EXPECT_NE(part.text.find(name), std::string::npos) << part.text;
  EXPECT_EQ(nothing.text.find("close"), std::string::npos) << nothing.text;
}

TEST(EffectsCommand, AnswersInOneForm) {
  EXPECT_EQ(biopsy("effects --json --markdown").code, 2);
}

}  // namespace
}  // namespace biopsy::cli_tests
