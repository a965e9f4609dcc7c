#include "robot/live/live_settings.hpp"

#include <gtest/gtest.h>
#include <openssl/sha.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "robot/common/config_error.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::live {
namespace {

LiveSettings example() {
  LiveSettings settings;
  settings.domain = 12;
  settings.robot = 3;
  settings.keys = "/etc/biopsy/keys";
  settings.network = "eth0";
  settings.device_config = "device.toml";
  settings.commissioning = "commissioning";
  settings.commissioning_key = "commissioning.pem";
  settings.log = "procedure.sqlite";
  settings.log_key = "recorder.pem";
  settings.lines = "/run/biopsy";
  settings.fifo_priority = 60;
  settings.model = "model.toml";
  settings.tissues = "tissues.toml";
  settings.faults = "faults.toml";
  settings.weight_g = 51.5;
  settings.seed = 99;
  settings.layers = {{"muscle", Millimetres(0), Millimetres(2)}, {"gap", Millimetres(2), Millimetres(3)}};
  return settings;
}

TEST(LiveSettings, ComeBackAsTheyWereWritten) {
  const LiveSettings in = example(), out = parse_settings(to_json(in), "live.json");
  EXPECT_EQ(out.domain, in.domain);
  EXPECT_EQ(out.robot, in.robot);
  EXPECT_EQ(out.keys, in.keys);
  EXPECT_EQ(out.network, in.network);
  EXPECT_EQ(out.device, "sim");
  EXPECT_EQ(out.device_config, in.device_config);
  EXPECT_EQ(out.commissioning, in.commissioning);
  EXPECT_EQ(out.commissioning_key, in.commissioning_key);
  EXPECT_EQ(out.log, in.log);
  EXPECT_EQ(out.log_key, in.log_key);
  EXPECT_EQ(out.lines, in.lines);
  EXPECT_EQ(out.fifo_priority, in.fifo_priority);
  EXPECT_EQ(out.model, in.model);
  EXPECT_EQ(out.tissues, in.tissues);
  EXPECT_EQ(out.faults, in.faults);
  EXPECT_EQ(out.weight_g, in.weight_g);
  EXPECT_EQ(out.seed, in.seed);
  ASSERT_EQ(out.layers.size(), 2U);
  EXPECT_EQ(out.layers[1].name, "gap");
  EXPECT_EQ(out.layers[1].from.value, 2.0);
  EXPECT_EQ(out.layers[1].to.value, 3.0);
  const std::string text = to_json(in);
  EXPECT_TRUE(text.starts_with("{\n  \"commissioning\": ") && text.ends_with("}\n"))
      << "for a person to read";
}

// "what; remedy" of the refusal of these settings, "" where they are read.
std::string refusal(const std::string& text) {
  try {
    (void)parse_settings(text, "run/live.json");
    return "";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.where, "run/live.json");
    EXPECT_EQ(error.remedy, "start the robot with `biopsy up`, which writes it");
    return error.what_is_wrong;
  }
}

using Json = nlohmann::json;
const Json::json_pointer kFrom("/layers/1/from_mm"), kTo("/layers/1/to_mm");

// The example with one value changed.
std::string with(const Json::json_pointer& place, const Json& value) {
  Json changed = Json::parse(to_json(example()));
  changed[place] = value;
  return refusal(changed.dump());
}

TEST(LiveSettings, AreReadWithinTheirRangesAndRefusedBeyond) {
  const auto whole = [](const char* name, const Json& low, const Json& high, const Json& below,
                        const Json& above) {
    const Json::json_pointer place("/" + std::string(name));
    const std::string said =
        "\"" + std::string(name) + "\" is not a whole number from " + low.dump() + " to " + high.dump();
    for (const Json& good : {low, high}) EXPECT_EQ(with(place, good), "") << good;
    for (const Json& bad : {below, above, Json(1.5), Json("1"), Json(nullptr), Json(true), Json(UINT64_MAX)})
      EXPECT_EQ(with(place, bad), said) << bad;
  };
  whole("domain", 0, 230, -1, 231);
  whole("robot", 1, 4294967295, 0, 4294967296);
  whole("fifo_priority", 0, 90, -1, 91);
  whole("seed", 0, 9223372036854775807, -1, 9223372036854775808U);
  const auto number = [](const Json::json_pointer& place, const std::string& said) {
    const bool is_weight = place.back() == "weight_g";
    for (const Json& good : {Json(0), Json(0.0), Json(0.5), Json(1000.0)})
      EXPECT_EQ(with(place, good), "") << is_weight;
    for (const Json& bad : {Json(-0.001), Json(1000.001), Json("1"), Json(nullptr), Json(true)})
      EXPECT_EQ(with(place, bad), said) << bad;
  };
  number(Json::json_pointer("/weight_g"), "\"weight_g\" is not a number from 0 to 1000");
  number(kFrom, "\"from_mm\" is not a number from 0 to 1000");
  number(kTo, "\"to_mm\" is not a number from 0 to 1000");
}

TEST(LiveSettings, NameWhatIsMissingUnknownOrOfAnotherKind) {
  const Json good = Json::parse(to_json(example()));
  for (const auto& [name, value] : good.items()) {
    Json changed = good;
    changed.erase(name);
    EXPECT_EQ(refusal(changed.dump()), name == "faults" ? "" : "\"" + name + "\" is missing");
    if (value.is_string()) {
      EXPECT_EQ(with(Json::json_pointer("/" + name), 5), "\"" + name + "\" is not a text");
    }
  }
  for (const char* name : {"name", "from_mm", "to_mm"}) {
    Json changed = good;
    changed["layers"][0].erase(name);
    EXPECT_EQ(refusal(changed.dump()), "\"" + std::string(name) + "\" is missing");
  }
  EXPECT_EQ(with(Json::json_pointer("/layers/0/name"), 5), "\"name\" is not a text");
  EXPECT_EQ(with(Json::json_pointer("/layers/0/more"), 5), "\"more\" is not known");
  EXPECT_EQ(with(Json::json_pointer("/more"), 5), "\"more\" is not known");
  EXPECT_EQ(with(Json::json_pointer("/layers"), "gap"), "\"layers\" is not a list");
  EXPECT_EQ(with(Json::json_pointer("/layers/0"), "gap"), "\"\" is not an object");
  EXPECT_EQ(refusal("[]"), "\"\" is not an object");
  EXPECT_EQ(refusal(""), "the file is not JSON");
  EXPECT_THROW(parse_settings(
                   std::string(to_json(example())).replace(to_json(example()).find("51.5"), 4, "1e999"), "x"),
               ConfigError);
  Json magic = good;
  magic["device"] = "magic";
  EXPECT_THROW(parse_settings(magic.dump(), "x"), ConfigError);
}

TEST(LiveSettings, LieInTheRunFolderAndWhatAProcessWritesInItsOwn) {
  EXPECT_EQ(settings_file("/run/biopsy"), "/run/biopsy/live.json");
  ::unsetenv("STATE_DIRECTORY");
  EXPECT_EQ(own_folder("/run/biopsy"), "/run/biopsy");
  ::setenv("STATE_DIRECTORY", "", 1);
  EXPECT_EQ(own_folder("/run/biopsy"), "/run/biopsy");
  ::setenv("STATE_DIRECTORY", "/var/lib/biopsy", 1);
  EXPECT_EQ(own_folder("/run/biopsy"), "/var/lib/biopsy");
  ::unsetenv("STATE_DIRECTORY");
  const ScratchFolder folder;
  folder.write("live.json", to_json(example()));
  EXPECT_EQ(read_settings(folder.path()).domain, 12U);
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

// By OpenSSL's own SHA-256.
TEST(LiveSettings, TheTagChangesWithEveryFileThatCounts) {
  const ScratchFolder folder;
  LiveSettings settings = example();
  settings.model = folder / "model.toml";
  settings.tissues = folder / "tissues.toml";
  settings.faults = folder / "faults.toml";
  settings.device_config = folder / "device.toml";
  const auto expect_tag_of = [&](const std::string& bytes) {
    unsigned char digest[SHA256_DIGEST_LENGTH];
    SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest);
    std::uint64_t first = 0;
    for (int n = 0; n < 8; ++n) first = first << 8U | digest[n];
    EXPECT_EQ(config_tag(folder.path(), settings), first) << bytes;
  };
  folder.write("live.json", "{}");
  folder.write("model.toml", "a");
  folder.write("tissues.toml", "b");
  folder.write("faults.toml", "c");
  folder.write("device.toml", "d");
  expect_tag_of("{}abcd");
  settings.faults.clear();
  expect_tag_of("{}abd");
  for (const char* name : {"live.json", "model.toml", "tissues.toml", "device.toml"}) {
    const std::string content = file_content(folder / name);
    std::filesystem::remove(folder / name);
    try {
      (void)config_tag(folder.path(), settings);
      FAIL() << name;
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.where, folder / name);
      EXPECT_EQ(error.remedy, "start the robot with `biopsy up`, which writes it");
    }
    folder.write(name, content);
  }
}

}  // namespace
}  // namespace biopsy::live
