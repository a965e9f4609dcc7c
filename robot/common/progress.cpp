#include "robot/common/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <cstdio>

namespace biopsy {
namespace {

using namespace std::chrono_literals;

constexpr auto kQuiet = 500ms;  // shorter work needs no bar
constexpr auto kBetween = 200ms;
constexpr int kBar = 24;
constexpr double kFirstEstimate_s = 2.0, kFirstShare = 0.01;

std::string bar_text(double share, double elapsed_s) {
  if (share < 0.0) return {};
  const double part = std::min(share, 1.0);
  const int full = static_cast<int>(part * kBar);
  const std::string left = time_left_text(share, elapsed_s);
  return fmt::format("[{:=<{}}{: <{}}] {:3.0f} % {}{}", "", full, "", kBar - full, part * 100.0, left,
                     left.empty() ? "" : "  ");
}

}  // namespace

std::string time_left_text(double share, double elapsed_s) {
  if (elapsed_s < kFirstEstimate_s || share < kFirstShare || share > 1.0) return {};
  const double left_s = elapsed_s * (1.0 - share) / share;
  if (left_s < 90.0) return fmt::format("{:.0f} s left", left_s);
  return left_s < 5400.0 ? fmt::format("{:.0f} min left", left_s / 60.0)
                         : fmt::format("{:.1f} h left", left_s / 3600.0);
}

ProgressLine::ProgressLine() : started_(std::chrono::steady_clock::now()) {
  if (isatty(STDERR_FILENO) == 1)
    drawing_ = std::jthread([this](const std::stop_token& over) { draw_until(over); });
}

ProgressLine::~ProgressLine() = default;

void ProgressLine::show(double share, const std::string& what) {
  const std::scoped_lock lock(mutex_);
  share_ = share;
  what_ = what;
}

void ProgressLine::draw_until(const std::stop_token& over) {
  std::condition_variable_any woken;
  std::unique_lock lock(mutex_);
  bool drawn = false;
  for (auto pause = kQuiet; !woken.wait_for(lock, over, pause, [&] { return over.stop_requested(); });
       pause = kBetween) {
    if (what_.empty()) continue;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - started_;
    fmt::print(stderr, "\r\033[K{}{}", bar_text(share_, elapsed.count()), what_);
    std::fflush(stderr);
    drawn = true;
  }
  if (drawn) fmt::print(stderr, "\r\033[K");
}

}  // namespace biopsy
