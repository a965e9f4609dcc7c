// The recorder's loop on a fake bus, with a log of its own.
#pragma once

#include <chrono>
#include <nlohmann/json.hpp>

#include "drivers/digital_io/shared_io.hpp"
#include "planner/plan/seal.hpp"
#include "robot/live/bus_recorder.hpp"
#include "robot/transport/participant_monitor.hpp"
#include "safety/types/hazards.hpp"
#include "tests/robot/live/loops/bench.hpp"
#include "tests/robot/recorder/log_for_tests.hpp"

namespace biopsy::loops_tests {

using nlohmann::json;
using recorder::Record;

struct RecorderLoopBench : LoopBench {
  // Its own start, and the writers that it finds, are written.
  RecorderLoopBench() {
    turn(), turn();
    began = news();
    fake_bus::written<LogHealth>();
  }
  void turn() { loop.turn(now_us += 10'000); }
  // What was written since the last call.
  std::vector<Record> news() {
    log.flush(now_us);
    std::vector<Record> all = recorder::records_of(folder_of_log.log, folder_of_log.public_key());
    all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::exchange(seen, all.size())));
    return all;
  }
  template <class Message>
  std::vector<Record> after(const Message& message) {
    fake_bus::put(message);
    turn();
    return news();
  }
  static std::string kinds(const std::vector<Record>& records) {
    std::string text;
    for (const Record& record : records) text += (text.empty() ? "" : ", ") + record.kind;
    return text;
  }

  const recorder::LogFolder folder_of_log;
  recorder::Recorder log{folder_of_log.log, folder_of_log.key()};
  const transport::ParticipantMonitor participants{transport::BusSettings{}, bus};
  robot::BusRecorder loop{bus, log, kConfig, &participants};
  std::int64_t now_us = kStart_us;
  std::size_t seen = 0;
  std::vector<Record> began;
};

}  // namespace biopsy::loops_tests
