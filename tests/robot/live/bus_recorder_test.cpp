// What a process says of itself is in the procedure log.
#include "robot/live/bus_recorder.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "robot/live/heartbeat.hpp"
#include "robot/security/cyclone_xml.hpp"
#include "tests/robot/recorder/log_for_tests.hpp"

namespace biopsy::robot {
namespace {

using recorder::LogFolder;
using recorder::Record;

constexpr std::uint32_t kRecorderDomain = 77;  // of this test alone

TEST(BusRecorder, WritesDownWhatAProcessSaysWhateverTheBytes) {
  const transport::Participant bus({kRecorderDomain, security::cyclone_xml({}), 1});
  const LogFolder folder;
  recorder::Recorder log(folder.log, folder.key());
  BusRecorder bus_recorder(bus, log, 1, nullptr);
  live::Heartbeat stage(bus, Process::Stage, 1);
  const std::string said = "NI-DAQmx -200279: device is gone";
  stage.note(said);
  std::int64_t now_us = 1'000'000;
  const auto told = [&](const std::string& part) {
    for (int turns = 0; turns < 1000; ++turns) {  // each asks once more; bounded, never waits for a time
      now_us += live::kHealthEvery_us;
      stage.beat(now_us);
      bus_recorder.turn(now_us);
      for (const Record& record : recorder::records_of(folder.log, folder.public_key()))
        if (record.source == "stage" && record.body.find(part) != std::string::npos) return true;
      std::this_thread::yield();
    }
    return false;
  };
  EXPECT_TRUE(told(said));
  std::string long_note(119, 'x');
  long_note += "\xC3\xA4";  // cut in the middle of a letter
  stage.note(long_note);
  EXPECT_TRUE(told(std::string(119, 'x')));
  EXPECT_EQ(log.last_error(), "");
}

}  // namespace
}  // namespace biopsy::robot
