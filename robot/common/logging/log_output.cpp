#include "robot/common/logging/log_output.hpp"

#include <fmt/chrono.h>
#include <poll.h>
#include <spdlog/sinks/rotating_file_sink.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "robot/common/text/sanitize_text.hpp"

namespace biopsy::logging {
namespace {

using spdlog::details::log_msg;
using SpdlogLevel = spdlog::level::level_enum;

constexpr std::size_t kFileSize_bytes = 5'000'000, kOlderFiles = 2;
constexpr std::chrono::seconds kRetry{1};  // for a file that cannot be opened or written
constexpr int kPatience_ms = 100;

// sd-daemon(3), in the order of spdlog's levels.
constexpr std::array<const char*, 6> kPriorities{"<7>", "<7>", "<6>", "<4>", "<3>", "<2>"};

bool is_journal(int descriptor) {
  const char* stream = std::getenv("JOURNAL_STREAM");  // "device:inode", systemd.exec(5)
  struct stat status {};
  return stream != nullptr && ::fstat(descriptor, &status) == 0 &&
         fmt::format("{}:{}", status.st_dev, status.st_ino) == stream;
}

std::string_view view(spdlog::string_view_t text) {
  return {text.data(), text.size()};
}

// "2026-11-21T18:10:23.123Z", UTC as in the procedure log.
std::string time_text(spdlog::log_clock::time_point time) {
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch());
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(spdlog::log_clock::to_time_t(time)),
                     milliseconds.count() % 1000);
}

// One line, whatever the message holds.
std::string line_of(const log_msg& message, const LogSettings& settings, bool with_time) {
  const char* level = kLevelNames[std::min<std::size_t>(message.level, kLevelNames.size() - 1)];
  std::string text = plain(view(message.payload));
  while (text.ends_with(' ')) text.pop_back();  // libraries end their messages with a line break
  const std::string time = time_text(message.time);
  if (settings.format == Format::Json)
    return nlohmann::ordered_json{{"time", time},
                                  {"level", level},
                                  {"program", settings.program},
                                  {"pid", ::getpid()},
                                  {"component", view(message.logger_name)},
                                  {"message", text}}
               .dump() +
           '\n';
  return fmt::format("{}{}{:<7} {:<10} {}\n", with_time ? time : "", with_time ? " " : "", level,
                     view(message.logger_name), text);
}

class LineFormatter final : public spdlog::formatter {
 public:
  explicit LineFormatter(LogSettings settings) : settings_(std::move(settings)) {}
  void format(const log_msg& message, spdlog::memory_buf_t& to) override {
    const std::string line = line_of(message, settings_, true);
    to.append(line.data(), line.data() + line.size());
  }
  std::unique_ptr<formatter> clone() const override { return std::make_unique<LineFormatter>(settings_); }

 private:
  LogSettings settings_;
};

// Unbuffered: a message that does not fit on the disk is refused at once, not with a later one.
std::unique_ptr<spdlog::sinks::sink> open_file(const std::filesystem::path& file,
                                               const LogSettings& settings) {
  if (!std::filesystem::is_directory(file.parent_path()))  // spdlog would make it
    throw spdlog::spdlog_ex("there is no folder for the log " + file.string());
  spdlog::file_event_handlers handlers;
  handlers.after_open = [](const std::string&, std::FILE* opened) {
    std::setvbuf(opened, nullptr, _IONBF, 0);
    ::fchmod(::fileno(opened), 0600);
  };
  auto sink = std::make_unique<spdlog::sinks::rotating_file_sink_st>(file.string(), kFileSize_bytes,
                                                                     kOlderFiles, false, handlers);
  sink->set_formatter(std::make_unique<LineFormatter>(settings));
  return sink;
}

}  // namespace

SpdlogLevel to_spdlog(Level level) {
  return level == Level::Off ? SpdlogLevel::off : static_cast<SpdlogLevel>(level);
}

StreamOutput::StreamOutput(int descriptor)
    : descriptor_(descriptor),
      is_terminal_(::isatty(descriptor) == 1),
      is_journal_(logging::is_journal(descriptor)) {}

// In pieces of PIPE_BUF: so many a pipe that is ready takes without waiting (POSIX).
bool StreamOutput::write_all(std::string_view bytes, int patience_ms) {
  while (!bytes.empty()) {
    pollfd ready{descriptor_, POLLOUT, 0};
    if (::poll(&ready, 1, patience_ms) != 1 || (ready.revents & POLLOUT) == 0) return false;
    const ssize_t written = ::write(descriptor_, bytes.data(), std::min<std::size_t>(bytes.size(), PIPE_BUF));
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

void StreamOutput::write(SpdlogLevel level, std::string_view line) {
  std::string bytes = is_terminal_ ? "\r\033[K" : "";  // over a progress line
  if (is_journal_) bytes += kPriorities[std::min<std::size_t>(level, kPriorities.size() - 1)];
  const int patience_ms = missed_ == 0 ? kPatience_ms : 0;
  if (missed_ > 0) bytes += fmt::format("{} messages were not shown: the terminal was blocked\n", missed_);
  if (write_all(bytes.append(line), patience_ms))
    missed_ = 0;
  else
    ++missed_;
}

LogOutput::LogOutput(const LogSettings& settings)
    : settings_(settings),
      file_level_(to_spdlog(settings.level.value_or(Level::Info))),
      stream_level_(to_spdlog(settings.level.value_or(Level::Warning))),
      stream_(settings.stream),
      file_(settings.file) {}

void LogOutput::set_file(const std::filesystem::path& file) {
  const std::lock_guard lock(mutex_);
  file_ = file;
  opened_.reset();
  retry_ = {};
}

bool LogOutput::takes(Level level) {
  const std::lock_guard lock(mutex_);
  return to_spdlog(level) >= std::min(stream_level_, file_.empty() ? SpdlogLevel::off : file_level_);
}

std::size_t LogOutput::flushes() {
  const std::lock_guard lock(flush_mutex_);
  return flushes_;
}

bool LogOutput::wait_for_flush(std::size_t count, std::chrono::milliseconds patience) {
  std::unique_lock lock(flush_mutex_);
  return flushed_.wait_for(lock, patience, [&] { return flushes_ > count; });
}

void LogOutput::flush_() {
  {
    const std::lock_guard lock(flush_mutex_);
    ++flushes_;
  }
  flushed_.notify_all();
}

void LogOutput::sink_it_(const log_msg& message) {
  const auto queue = queue_.lock();
  const std::size_t dropped = queue ? queue->overrun_counter() : dropped_;
  if (const std::size_t more = dropped - dropped_; more > 0) {
    dropped_ = dropped;
    report(message.time, fmt::format("{} messages were dropped before this one: the queue was full", more));
  }
  deliver(message);
}

void LogOutput::report(spdlog::log_clock::time_point time, const std::string& text) {
  deliver(log_msg(time, {}, "log", SpdlogLevel::warn, text));
}

void LogOutput::deliver(const log_msg& message) {
  if (message.level >= file_level_ && !file_.empty()) write_file(message);
  if (message.level >= stream_level_)
    stream_.write(message.level, line_of(message, settings_, !stream_.is_journal()));
}

void LogOutput::write_file(const log_msg& message) {
  if (!opened_ && message.time < retry_) {
    ++unwritten_;
    return;
  }
  try {
    if (!opened_) opened_ = open_file(file_, settings_);
    if (unwritten_ > 0)
      opened_->log(log_msg(message.time, {}, "log", SpdlogLevel::warn,
                           fmt::format("{} messages could not be written to this file", unwritten_)));
    opened_->log(message);
    unwritten_ = 0;
  } catch (const std::exception& error) {
    opened_.reset();
    retry_ = message.time + kRetry;
    if (unwritten_++ == 0 && stream_level_ <= SpdlogLevel::warn) {
      const std::string text = error.what();
      const log_msg notice(message.time, {}, "log", SpdlogLevel::warn, text);
      stream_.write(notice.level, line_of(notice, settings_, !stream_.is_journal()));
    }
  }
}

}  // namespace biopsy::logging
