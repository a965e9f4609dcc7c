// The record of a run while it goes on: what every tick adds to it.
#pragma once

#include "robot/procedure/rehearsal.hpp"

namespace biopsy::robot {

class RunNotes {
 public:
  // `prepared` must hold a plan and outlive this.
  explicit RunNotes(const PreparedCase& prepared);

  // The next tick, and what people did in it.
  void add(const CycleSample& cycle, const OperatorInputs& inputs);

  // Mean of where the tip was while the image was taken, for the scanner of a rehearsal; the next image
  // starts anew.
  Millimetres take_imaged_tip();

  report::RunRecord& record() { return record_; }
  const report::RunRecord& record() const { return record_; }

 private:
  void note_trip(const CycleRecord& tick);

  const Plan& plan_;
  report::RunRecord record_;
  double time_ms(const Measurement& measurement);

  Mode mode_ = Mode::Boot;
  bool reached_ = false;   // the end of a step
  std::uint32_t seq_ = 0;  // of the last tick
  std::int64_t first_us_ = 0, last_us_ = 0;
  double tip_sum_mm_ = 0.0, tip_low_mm_ = 0.0, tip_high_mm_ = 0.0;
  std::int64_t tip_count_ = 0;
};

}  // namespace biopsy::robot
