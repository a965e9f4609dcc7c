// The record of a run while it goes on: what every tick adds to it.
#pragma once

#include "robot/procedure/rehearsal.hpp"

namespace biopsy::robot {

class RunNotes {
 public:
  // Samples of an hour, 48 octets each: 170 MB. Five images of 180 s and their steps take half of it.
  static constexpr std::size_t kSamplesMax = 3'600'000;

  // `prepared` must hold a plan and outlive this.
  explicit RunNotes(const PreparedCase& prepared, std::size_t samples_max = kSamplesMax);

  // The next tick, and what people did in it. Beyond the last sample it is still counted.
  void add(const CycleSample& cycle, const OperatorInputs& inputs);

  // Mean of where the tip was while the image was taken, for the scanner of a rehearsal; the next image
  // starts anew.
  Millimetres take_imaged_tip();

  report::RunRecord& record() { return record_; }
  const report::RunRecord& record() const { return record_; }

 private:
  void note_trip(const CycleRecord& tick, double now_ms);
  void note_image(const CycleSample& cycle, double now_ms, bool acquiring);
  bool spoils_image(const CycleRecord& tick);

  const Plan& plan_;
  const std::size_t samples_max_;
  report::RunRecord record_;
  double time_ms(const Measurement& measurement);

  Mode mode_ = Mode::Boot;
  bool reached_ = false;   // the end of a step
  std::uint32_t seq_ = 0;  // of the last tick
  std::int64_t first_us_ = 0, last_us_ = 0;
  bool imaging_ = false;
  std::int32_t flagged_ticks_ = 0;  // in a row: the supervisor calls the image disturbed
  double tip_sum_mm_ = 0.0, tip_low_mm_ = 0.0, tip_high_mm_ = 0.0;
  std::int64_t tip_count_ = 0;
};

}  // namespace biopsy::robot
