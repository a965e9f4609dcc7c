#include "robot/common/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace biopsy {
namespace {

using namespace std::chrono_literals;

constexpr auto kQuiet = 500ms;  // shorter work needs no bar
constexpr auto kBetween = 100ms;
constexpr int kBar = 24;
constexpr double kFirstEstimate_s = 2.0, kFirstShare = 0.01;

}  // namespace

std::string time_left_text(double share, double elapsed_s) {
  if (elapsed_s < kFirstEstimate_s || share < kFirstShare || share > 1.0) return {};
  const double left_s = elapsed_s * (1.0 - share) / share;
  if (left_s < 90.0) return fmt::format("{:.0f} s left", left_s);
  return left_s < 5400.0 ? fmt::format("{:.0f} min left", left_s / 60.0)
                         : fmt::format("{:.1f} h left", left_s / 3600.0);
}

ProgressLine::ProgressLine()
    : terminal_(isatty(STDERR_FILENO) == 1), started_(std::chrono::steady_clock::now()), last_(started_) {}

ProgressLine::~ProgressLine() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void ProgressLine::show(double share, const std::string& what) {
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || now - started_ < kQuiet || now - last_ < kBetween) return;
  last_ = now;
  drawn_ = true;
  std::string bar;
  if (share >= 0.0) {
    const int full = static_cast<int>(std::clamp(share, 0.0, 1.0) * kBar);
    bar = fmt::format("[{:=<{}}{: <{}}] {:3.0f} % ", "", full, "", kBar - full,
                      std::clamp(share, 0.0, 1.0) * 100.0);
    const std::string left = time_left_text(share, std::chrono::duration<double>(now - started_).count());
    if (!left.empty()) bar += left + "  ";
  }
  fmt::print(stderr, "\r\033[K{}{}", bar, what);
  std::fflush(stderr);
}

}  // namespace biopsy
