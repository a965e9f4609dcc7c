#include "robot/live/live_settings.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "robot/common/config_error.hpp"
#include "robot/live/config_watch.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::live {
namespace {

LiveSettings example() {
  LiveSettings settings;
  settings.domain = 12;
  settings.robot = 3;
  settings.keys = "/etc/biopsy/keys";
  settings.network = "eth0";
  settings.log = "procedure.sqlite";
  settings.log_key = "recorder.pem";
  settings.lines = "/run/biopsy";
  settings.fifo_priority = 60;
  settings.weight_g = 51.5;
  settings.seed = 99;
  settings.layers = {{"muscle", Millimetres(0), Millimetres(2)}, {"gap", Millimetres(2), Millimetres(3)}};
  return settings;
}

TEST(LiveSettings, ComeBackAsTheyWereWritten) {
  const std::string text = to_json(example());
  EXPECT_EQ(to_json(parse_settings(text, "live.json")), text);
  EXPECT_EQ(parse_settings(text, "live.json").layers[1].name, "gap");
}

TEST(LiveSettings, RefuseWhatIsMissingUnknownOrOutOfRange) {
  const std::string text = to_json(example());
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return changed;
  };
  for (const std::string& bad :
       {std::string(), std::string("[]"), std::string("{}"), with("\"domain\": 12", "\"domain\": 231"),
        with("\"domain\": 12", "\"domain\": 1.5"), with("\"domain\": 12", "\"dolmain\": 12"),
        with("\"robot\": 3", "\"robot\": 0"), with("\"device\": \"sim\"", "\"device\": \"magic\""),
        with("\"weight_g\": 51.5", "\"weight_g\": -1"), with("\"weight_g\": 51.5", "\"weight_g\": 1e999"),
        with("\"fifo_priority\": 60", "\"fifo_priority\": 99"),
        with("\"seed\": 99", "\"seed\": 18446744073709551615"),
        with("\"seed\": 99", "\"seed\": 99, \"more\": 1"), with("\"name\": \"gap\"", "\"name\": 5")}) {
    EXPECT_THROW(parse_settings(bad, "live.json"), ConfigError) << bad;
  }
}

TEST(LiveSettings, SurviveAnyBytes) {
  std::mt19937 random(5);
  for (int round = 0; round < 5'000; ++round) {
    std::string text = to_json(example());
    for (int change = 0; change < 3; ++change) text[random() % text.size()] = static_cast<char>(random());
    try {
      const LiveSettings read = parse_settings(text, "live.json");
      EXPECT_LE(read.domain, 230U);
      EXPECT_GE(read.weight_g, 0.0);
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.where, "live.json");
    }
  }
}

TEST(LiveSettings, TheTagChangesWithEveryFileThatCounts) {
  const ScratchFolder folder;
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder.path() / name) << text;
    return folder.path() / name;
  };
  LiveSettings settings = example();
  settings.model = write("model.toml", "a = 1");
  settings.tissues = write("tissues.toml", "b = 2");
  write("live.json", to_json(settings));
  const std::uint64_t tag = config_tag(folder.path(), settings);
  EXPECT_NE(tag, 0U);
  EXPECT_EQ(config_tag(folder.path(), settings), tag);
  write("model.toml", "a = 2");
  EXPECT_NE(config_tag(folder.path(), settings), tag);
  write("model.toml", "a = 1");
  write("live.json", to_json(settings) + " ");
  EXPECT_NE(config_tag(folder.path(), settings), tag);
  std::filesystem::remove(settings.tissues);
  EXPECT_THROW(config_tag(folder.path(), settings), ConfigError);
}

TEST(ConfigWatch, SeesAFileThatWasEditedRemovedAndPutBack) {
  const ScratchFolder folder;
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder.path() / name) << text;
    return folder.path() / name;
  };
  LiveSettings settings = example();
  settings.model = write("model.toml", "v_max = 6000");
  settings.tissues = write("tissues.toml", "b = 2");
  write("live.json", to_json(settings));
  const std::uint64_t started = config_tag(folder.path(), settings);
  constexpr std::int64_t kFuture_us = std::int64_t{1} << 60;  // its own thread reads at earlier times
  ConfigWatch watch(folder.path(), settings);
  const auto seen = [&] {
    watch.read(kFuture_us);
    return watch.files().at(kFuture_us);
  };
  EXPECT_NE(watch.files().at(0), 0U) << "read before the first tick";
  EXPECT_EQ(seen(), started);
  write("model.toml", "v_max = 8000");
  EXPECT_NE(seen(), started);
  EXPECT_NE(seen(), 0U);
  std::filesystem::remove(settings.model);
  EXPECT_EQ(seen(), 0U);
  write("model.toml", "v_max = 6000");
  EXPECT_EQ(seen(), started);
}

}  // namespace
}  // namespace biopsy::live
