// The image at the end of a step, and the depth check that reads it: from the simulated scanner, which takes
// it of the needle where it truly is and sends it as DICOM; or from the folder into which a real scanner
// exports.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <span>

#include "planner/imaging/io/watched_folder.hpp"
#include "robot/procedure/case/prepared_case.hpp"
#include "robot/report/procedure/run_record.hpp"

namespace biopsy::robot {

class ConfirmationImages {
 public:
  // Simulated images go to `folder`/images. With a folder to watch, what lies in it now is not looked at.
  // `prepared` and `plan` must outlive this. Throws ConfigError where that folder does not exist.
  ConfirmationImages(const PreparedCase& prepared, const Plan& plan, std::filesystem::path folder);

  // Whether images come from a scanner: then take() waits for one.
  bool from_scanner() const { return watched_.has_value(); }

  // Ends a wait for an image, from any thread: it becomes an unsure check.
  void cancel() { cancelled_ = true; }

  // At the end of `step`, with the needle at `tip` (known of a simulated stage only) for at least `held`:
  // fills the check and the pictures of `result`. Each image of a step, a repeated one too, gets a folder and
  // a noise of its own. A simulated image takes about a second. From a scanner the first image is taken that
  // arrives whole; one of which a series cannot be the confirmation (image_objection), and none within the
  // time of the case, are an unsure check with the reason.
  void take(std::size_t step, Millimetres tip, std::chrono::milliseconds held, report::StepResult& result);

 private:
  void simulate(std::size_t step, Millimetres tip, report::StepResult& result);
  void receive(std::size_t step, std::chrono::milliseconds held, report::StepResult& result);
  void check(std::size_t step, std::span<const Volume> after, report::StepResult& result) const;

  const PreparedCase& prepared_;
  const Plan& plan_;
  std::filesystem::path folder_;
  std::map<std::size_t, std::size_t> repeats_;  // images of each step so far
  std::optional<imaging::WatchedFolder> watched_;
  std::optional<std::chrono::system_clock::time_point> last_acquired_;
  std::atomic<bool> cancelled_ = false;
};

}  // namespace biopsy::robot
