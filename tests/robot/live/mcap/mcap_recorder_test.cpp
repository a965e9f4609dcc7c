// What is said on a bus is in the file, as @mcap/core reads it: also where the recorder did not come to its
// end.
#include "robot/live/mcap_recorder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "robot/common/config_error.hpp"
#include "robot/msg/topics.hpp"
#include "robot/security/cyclone_xml.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::robot {
namespace {

constexpr std::uint32_t kMcapDomain = 76;  // of these tests alone
constexpr std::int64_t kUtc_ns = 1'795'285'292'123'456'789;

struct McapRecording : testing::Test {
  ScratchFolder folder;
  transport::Participant bus{{kMcapDomain, security::cyclone_xml({}), 1}};
  transport::Writer<Measurement> measurements{bus};
  transport::Writer<Decision> decisions{bus};
  transport::Writer<SealedPlan> plans{bus};
  transport::Reader<Decision> heard{bus};
  std::int64_t now_us = 1'000'000;

  void turn(McapRecorder& recorder) {
    now_us += 1'000;
    recorder.turn(now_us, kUtc_ns + now_us * 1'000);
  }
  // Until the readers are matched, which takes as long as it takes; bounded.
  void wait_for_readers() {
    for (int n = 0;
         n < 2'000 && (measurements.readers() == 0 || decisions.readers() < 2 || plans.readers() == 0); ++n)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  // A measurement and a decision a tick; in tick 123 the supervisor trips for one tick. No faster than the
  // bus delivers, which keeps the newest only for a reader that comes late: on a machine that stands still, a
  // few.
  void say(McapRecorder& recorder, std::uint32_t ticks) {
    for (std::uint32_t tick = 1; tick <= ticks; ++tick) {
      measurements.write(
          {.seq = tick, .depth_um = static_cast<std::int32_t>(tick * 7), .verdict = GateVerdict::Granted});
      decisions.write({.seq = tick, .mode = tick == 123 ? Mode::Trip : Mode::Active});
      Decision told;
      for (int n = 0; n < 2'000 && told.seq != tick; ++n)
        if (!heard.take(told)) std::this_thread::sleep_for(std::chrono::microseconds(100));
      turn(recorder);
    }
  }
  nlohmann::json read(const std::filesystem::path& file) {
    const std::string command =
        fmt::format("cd {} && node recover.mjs {} > {} 2>&1", (binary_dir() / "mcap_reader").string(),
                    file.string(), (folder / "told").string());
    EXPECT_EQ(std::system(command.c_str()), 0) << file_content(folder / "told");
    return nlohmann::json::parse(file_content(folder / "told"));
  }
  void SetUp() override {
    if (!std::filesystem::exists(binary_dir() / "mcap_reader/node_modules"))
      GTEST_SKIP() << "without npm and its registry";
  }
};

TEST_F(McapRecording, HoldsWhatWasSaidAtItsRateAndEveryChange) {
  const std::filesystem::path file = free_mcap_name(folder.path());
  EXPECT_EQ(file.filename(), "bus.mcap");
  McapRecorder recorder(bus, file, 100.0, "test");
  wait_for_readers();
  plans.write({.seq = 1, .bytes = {1, 2, 3}, .confirmed_tag = {18'000'000'000'000'000'001U, 2}});
  say(recorder, 500);
  recorder.finish();
  const nlohmann::json found = read(file);
  EXPECT_TRUE(found["whole"]);
  EXPECT_EQ(found["disorder"], nlohmann::json::array());
  EXPECT_EQ(found["counts"]["/SealedPlan"], 1);
  // A tick is 1 ms here: one in ten. Loaded machines deliver some of them late, never more often.
  EXPECT_GE(found["counts"]["/Measurement"], 20);
  EXPECT_LE(found["counts"]["/Measurement"], 52);
  const std::string content = file_content(file);
  EXPECT_NE(content.find(R"("mode":"trip")"), std::string::npos) << "a state of one tick";
  EXPECT_NE(content.find(R"("confirmed_tag":["18000000000000000001","2"])"), std::string::npos);
  EXPECT_EQ(free_mcap_name(folder.path()).filename(), "bus-2.mcap");
  EXPECT_THROW(McapRecorder(bus, file, 100.0, "test"), ConfigError) << "a recording is not overwritten";
}

TEST_F(McapRecording, ThatIsCutOffHoldsAllButTheLastSecond) {
  const std::filesystem::path file = folder / "bus.mcap";
  McapRecorder recorder(bus, file, 1'000.0, "test");
  wait_for_readers();
  say(recorder, 3'500);  // 3.5 s of its clock
  const nlohmann::json found = read(file);
  EXPECT_FALSE(found["whole"]);
  EXPECT_EQ(found["disorder"], nlohmann::json::array());
  EXPECT_GT(found["counts"]["/Measurement"], 500);
  EXPECT_GE(std::stoll(found["last"].get<std::string>()), kUtc_ns + (now_us - 1'000'000) * 1'000);
}

TEST_F(McapRecording, WhereItCannotBeMadeIsRefused) {
  EXPECT_THROW(McapRecorder(bus, folder / "nowhere/bus.mcap", 100.0, "test"), ConfigError);
}

}  // namespace
}  // namespace biopsy::robot
