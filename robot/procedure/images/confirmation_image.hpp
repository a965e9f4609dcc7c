// The scanner's part of a rehearsal: takes an image of the needle where it truly is, sends it as DICOM, and
// has the depth check read what was sent.
#pragma once

#include <filesystem>
#include <map>

#include "robot/procedure/case/prepared_case.hpp"
#include "robot/report/procedure/run_record.hpp"

namespace biopsy::robot {

class ConfirmationImages {
 public:
  // Images go to `folder`/images. `prepared` and `plan` must outlive this.
  ConfirmationImages(const PreparedCase& prepared, const Plan& plan, std::filesystem::path folder)
      : prepared_(prepared), plan_(plan), folder_(std::move(folder)) {}

  // At the end of `step`, with the needle at `tip`: fills the check and the pictures of `result`. Each
  // image of a step, a repeated one too, gets a folder and a noise of its own. Takes about a second.
  void take(std::size_t step, Millimetres tip, report::StepResult& result);

 private:
  const PreparedCase& prepared_;
  const Plan& plan_;
  std::filesystem::path folder_;
  std::map<std::size_t, std::size_t> repeats_;  // images of each step so far
};

}  // namespace biopsy::robot
