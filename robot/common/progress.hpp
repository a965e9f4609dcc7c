// A line that shows what long work is doing: on a terminal only, and only once it takes longer than a moment.
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <thread>

namespace biopsy {

// "12 s left", "3 min left", "2.0 h left": at the same pace, after `elapsed_s` at `share` of the work. Empty
// where it is too early to say.
std::string time_left_text(double share, double elapsed_s);

class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();  // wipes the line
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // `share` in [0, 1] draws a bar and, from two seconds on, the time that is left at the pace until now;
  // below 0 there is neither. From any thread. A thread of its own draws five times a second.
  void show(double share, const std::string& what);

 private:
  void draw_until(const std::stop_token& over);

  std::chrono::steady_clock::time_point started_;
  std::mutex mutex_;  // of what is shown
  double share_ = -1.0;
  std::string what_;
  std::jthread drawing_;
};

}  // namespace biopsy
