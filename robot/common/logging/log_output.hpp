// The outputs of a log session: a rotating file and stderr, written by the session's one background thread.
#pragma once

#include <spdlog/async.h>
#include <spdlog/sinks/base_sink.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "robot/common/logging/log_session.hpp"

namespace biopsy::logging {

spdlog::level::level_enum to_spdlog(Level level);

// A terminal, pipe or file that is already open. A reader that does not read costs 100 ms once and nothing
// after that; the lines it missed are counted and reported when it reads again.
class StreamOutput {
 public:
  explicit StreamOutput(int descriptor);

  // `line` ends with a line break.
  void write(spdlog::level::level_enum level, std::string_view line);
  // journald reads it: the lines need no time, and get the priority prefix "<3>" (sd-daemon(3)).
  bool is_journal() const { return is_journal_; }

 private:
  bool write_all(std::string_view bytes, int patience_ms);

  int descriptor_;
  bool is_terminal_, is_journal_;
  std::size_t missed_ = 0;
};

class LogOutput final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit LogOutput(const LogSettings& settings);

  // Whose overruns are reported.
  void set_queue(const std::shared_ptr<spdlog::details::thread_pool>& queue) { queue_ = queue; }
  // In place of the file so far.
  void set_file(const std::filesystem::path& file);
  bool takes(Level level);

  std::size_t flushes();  // carried out so far
  // Until more than `count` were carried out: then everything queued before is written. False: not in time.
  bool wait_for_flush(std::size_t count, std::chrono::milliseconds patience);

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override;

 private:
  void deliver(const spdlog::details::log_msg& message);
  void write_file(const spdlog::details::log_msg& message);
  void report(spdlog::log_clock::time_point time, const std::string& text);

  const LogSettings settings_;
  const spdlog::level::level_enum file_level_, stream_level_;
  StreamOutput stream_;
  std::filesystem::path file_;
  std::unique_ptr<spdlog::sinks::sink> opened_;  // none: not opened, or it failed and is tried again
  spdlog::log_clock::time_point retry_;
  std::size_t unwritten_ = 0;  // messages that the file did not take
  std::weak_ptr<spdlog::details::thread_pool> queue_;
  std::size_t dropped_ = 0;  // by the queue, as reported
  std::mutex flush_mutex_;
  std::condition_variable flushed_;
  std::size_t flushes_ = 0;
};

}  // namespace biopsy::logging
