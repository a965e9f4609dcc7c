// A line that says what is going on, on a terminal only and only once something takes longer than a moment.
#pragma once

#include <chrono>
#include <string>

namespace biopsy {

class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();  // wipes the line
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // `share` in [0, 1] draws a bar; below 0 there is none. Draws at most ten times a second.
  void show(double share, const std::string& what);

 private:
  bool terminal_, drawn_ = false;
  std::chrono::steady_clock::time_point started_, last_;
};

}  // namespace biopsy
