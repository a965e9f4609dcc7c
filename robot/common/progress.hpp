// A line that says what is going on, on a terminal only and only once something takes longer than a moment.
#pragma once

#include <chrono>
#include <string>

namespace biopsy {

// "12 s left", "3 min left", "2.0 h left": after `elapsed_s` at `share` of the work; empty where it is too
// early to say.
std::string time_left_text(double share, double elapsed_s);

class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();  // wipes the line
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // `share` in [0, 1] draws a bar and, from two seconds on, the time that is left at the pace until now;
  // below 0 there is neither. Draws at most ten times a second.
  void show(double share, const std::string& what);

 private:
  bool terminal_, drawn_ = false;
  std::chrono::steady_clock::time_point started_, last_;
};

}  // namespace biopsy
