// The image at the end of a step: when it is taken, and what it tells.
#include <algorithm>
#include <utility>

#include "robot/console/operator_run.hpp"
#include "robot/console/operator_session.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/procedure/images/patient_motion.hpp"
#include "robot/procedure/operator.hpp"

namespace biopsy::robot {

// Locked first, where the stage can: then nothing drifts and nothing switches while the scanner works.
void OperatorSession::begin_image(std::size_t step) {
  run_->imaged = step;
  if (!run_->plan().steps[step].image_confirms)
    run_->accepted = step;
  else if (seen_.measurement.brake_fitted)
    run_->locking = true;
  else
    begin_scan();
}

void OperatorSession::begin_scan() {
  run_->acquiring_us = now_us_;
  run_->imaged_under = seen_.supervisor.permit;
}

// A simulated image is drawn once its time is over. A scanner's is waited for from the start, and counts as
// being taken until it is whole and judged, or refused, or the time of the case is over, however long it
// takes.
void OperatorSession::take_image(std::size_t step) {
  const Seconds scan = scan_time(seen_.measurement.brake_fitted, run_->prepared.given.rehearsal.scan);
  const std::chrono::microseconds held(now_us_ - *run_->acquiring_us);
  const bool scanned = run_->images.from_scanner();
  if (!scanned && held < scan) return;
  if (!scanned) run_->acquiring_us.reset();
  run_->check = std::async(std::launch::async, [run = run_, step, held, tip = run_->notes.take_imaged_tip()] {
    realtime::run_in_background();
    report::StepResult result;
    result.step = run->plan().steps[step];
    run->images.take(step, tip, std::chrono::round<std::chrono::milliseconds>(held), result);
    return result;
  });
}

void OperatorSession::update_image() {
  const std::size_t step = seen_.supervisor.step;
  const bool waits = seen_.supervisor.permit.mode == Mode::Hold && seen_.supervisor.step_done;
  if (waits && run_->imaged != step) begin_image(step);
  if (waits && run_->locking && is_quiet(seen_)) run_->locking = false, begin_scan();
  if (run_->acquiring_us && !waits) {  // the needle moved: this image is invalid
    run_->acquiring_us.reset();
    run_->notes.take_imaged_tip();
  }
  run_->locking = run_->locking && waits;
  if (run_->acquiring_us && !run_->check.valid()) take_image(step);
  using std::chrono::seconds;
  if (!run_->check.valid() || run_->check.wait_for(seconds(0)) != std::future_status::ready) return;
  run_->acquiring_us.reset();
  report::StepResult checked = run_->check.get();
  report::StepResult& noted = run_->notes.record().steps[*run_->imaged];
  noted.check = checked.check;
  if (checked.check) note_patient_motion(*checked.check, patient_motion_um_);
  adjusts_ = adjusts_ || patient_motion_um_ > 1e3 * kPatientMotionMax_mm;
  noted.image_path = checked.image_path;
  noted.before = std::move(checked.before);
  noted.after = std::move(checked.after);
  noted.geometry = checked.geometry;
  ++version_;
}

}  // namespace biopsy::robot
