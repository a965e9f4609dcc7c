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

}  // namespace

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
  }
  fmt::print(stderr, "\r\033[K{}{}", bar, what);
  std::fflush(stderr);
}

}  // namespace biopsy
