#include "robot/common/logging/log_session.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "robot/common/config_error.hpp"
#include "robot/common/logging/log_output.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/common/logging/signal_mask.hpp"

namespace biopsy::logging {
namespace {

constexpr std::array<const char*, 2> kFormatNames{"text", "json"};

struct State {
  explicit State(const LogSettings& settings)
      : patience(settings.patience), output(std::make_shared<LogOutput>(settings)) {
    const SignalsBlocked blocked;
    queue = std::make_shared<spdlog::details::thread_pool>(settings.queue_length, 1);
    output->set_queue(queue);
    for (std::size_t i = 0; i < loggers.size(); ++i) {
      loggers[i] = std::make_shared<spdlog::async_logger>(kComponentNames[i], output, queue,
                                                          spdlog::async_overflow_policy::overrun_oldest);
      loggers[i]->set_level(spdlog::level::trace);
      loggers[i]->set_error_handler([](const std::string&) {});  // its default waits for stderr
    }
  }
  bool flush() {
    const std::size_t before = output->flushes();
    loggers.front()->flush();
    return output->wait_for_flush(before, patience);
  }

  std::chrono::milliseconds patience;
  std::shared_ptr<LogOutput> output;
  std::array<std::shared_ptr<spdlog::async_logger>, kComponentNames.size()> loggers;
  std::atomic<Level> lowest{Level::Off};
  std::shared_ptr<spdlog::details::thread_pool> queue;  // last: its thread ends before what it uses
};

std::atomic<State*> active{nullptr};

void set_lowest_level(State& state) {
  auto level = Level::Trace;
  while (level != Level::Off && !state.output->takes(level))
    level = static_cast<Level>(static_cast<int>(level) + 1);
  state.lowest = level;
}

template <std::size_t N>
std::size_t index_of(const std::string& word, const std::array<const char*, N>& words,
                     const std::string& where) {
  const auto* found = std::find(words.begin(), words.end(), word);
  if (found == words.end())
    throw ConfigError(fmt::format("\"{}\" is not one of {}", word, fmt::join(words, ", ")), where,
                      fmt::format("choose from {}", fmt::join(words, ", ")));
  return static_cast<std::size_t>(found - words.begin());
}

}  // namespace

Level level_of(const std::string& word, const std::string& where) {
  return static_cast<Level>(index_of(word, kLevelNames, where));
}

Format format_of(const std::string& word, const std::string& where) {
  return static_cast<Format>(index_of(word, kFormatNames, where));
}

LogSettings settings_from_environment(std::string program) {
  LogSettings settings;
  settings.program = std::move(program);
  if (const char* level = std::getenv(kLevelVariable); level != nullptr && *level != '\0')
    settings.level = level_of(level, std::string("$") + kLevelVariable);
  if (const char* format = std::getenv(kFormatVariable); format != nullptr && *format != '\0')
    settings.format = format_of(format, std::string("$") + kFormatVariable);
  return settings;
}

LogSession::LogSession(const LogSettings& settings) {
  auto state = std::make_unique<State>(settings);
  set_lowest_level(*state);
  active = state.release();
}

LogSession::~LogSession() {
  State* const state = active.exchange(nullptr);
  static std::atomic<State*>
      abandoned;  // its thread still waits for an output: not joined, ends with the process
  if (state->flush())
    delete state;
  else
    abandoned = state;
}

bool LogSession::flush() {
  return active.load()->flush();
}

void log_to_file(const std::filesystem::path& file) {
  State* const state = active;
  if (state == nullptr) return;
  state->output->set_file(file);
  set_lowest_level(*state);
}

bool is_enabled(Level level) noexcept {
  const State* const state = active;
  return level >= (state == nullptr ? Level::Warning : state->lowest.load(std::memory_order_relaxed));
}

void write(Component component, Level level, std::string_view text) noexcept {
  write(component, level, text, std::chrono::system_clock::now());
}

void write(Component component, Level level, std::string_view text,
           std::chrono::system_clock::time_point time) noexcept {
  if (!is_enabled(level)) return;
  try {
    if (State* const state = active; state != nullptr)
      state->loggers[static_cast<std::size_t>(component)]->log(
          time, spdlog::source_loc{}, to_spdlog(level), spdlog::string_view_t(text.data(), text.size()));
    else
      fmt::print(stderr, "{}: {}: {}\n", kLevelNames[static_cast<std::size_t>(level)], name_of(component),
                 text);
  } catch (...) {  // out of memory, or stderr is closed: a diagnostic message stops nothing
  }
}

void fatal(Component component, std::string_view text) noexcept {
  write(component, Level::Error, text);
  if (State* const state = active; state != nullptr) state->flush();
  std::abort();
}

void Logger::log(Level level, fmt::string_view format, fmt::format_args values) const {
  if (is_enabled(level)) write(component_, level, fmt::vformat(format, values));
}

}  // namespace biopsy::logging
