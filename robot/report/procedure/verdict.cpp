#include "robot/report/procedure/verdict.hpp"

#include <fmt/format.h>

#include <cmath>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::report {
namespace {

// Refusals are written by many hands; the sentence ends with exactly one full stop.
std::string ended(std::string text) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\n')) text.pop_back();
  if (!text.empty() && text.back() != '.' && text.back() != '!' && text.back() != '?') text += '.';
  return text;
}

std::string needle_and_image(const RunRecord& record) {
  std::string text;
  if (std::isfinite(record.final_depth_mm)) {
    text = "needle tip at " + fixed(record.final_depth_mm, 2, "mm");
    if (!record.layer_at_tip.empty()) text += " in " + record.layer_at_tip;
  } else {
    text = "needle depth unknown";
  }
  if (std::isfinite(record.image_depth_mm)) {
    text += "; image says " + fixed(record.image_depth_mm, 2);
    if (std::isfinite(record.image_depth_sigma_mm)) text += " ± " + fixed(record.image_depth_sigma_mm, 2);
    text += " mm";
  } else {
    text += "; no depth from an image";
  }
  if (record.plan) text += "; target " + fixed(record.plan->target_depth.value, 2, "mm");
  return text;
}

// At 0 V only weight withdraws the needle; what friction holds, a person withdraws.
std::string needle_left(const RunRecord& record) {
  constexpr double kReturned_mm = 0.1;
  if (record.left_unmeasured)
    return " It is not known where the needle is at 0 V, since it is not measured: look at it before "
           "anything else.";
  if (!(record.left_depth_mm > kReturned_mm)) return {};
  return " At 0 V friction holds the needle " + fixed(record.left_depth_mm, 2, "mm") +
         " deep: draw the stage back along its guide by hand before anything else.";
}

// A longer step of the stage's clock is a jump to the supervisor.
constexpr double kLongGap_ms = safety::kClockStepMax_us * 1e-3;

// A run in real time of which a share is not known says so.
std::string time_kept(const RunRecord& record) {
  std::string text;
  const std::uint64_t ticks = record.lost_ticks + record.samples.size() + record.ticks_left_out;
  if (record.lost_ticks > 0)
    text += fmt::format(" {} of {} ticks were not received ({:.1f} %), the longest gap is {:.0f} ms.",
                        record.lost_ticks, ticks,
                        100.0 * static_cast<double>(record.lost_ticks) / static_cast<double>(ticks),
                        record.longest_gap_ms);
  else if (record.longest_gap_ms > kLongGap_ms)
    text += fmt::format(" The longest gap between two ticks is {:.0f} ms; {:.0f} ms are allowed.",
                        record.longest_gap_ms, kLongGap_ms);
  if (record.ticks_left_out > 0)
    text += fmt::format(
        " Depths, drive and curves are those of the first {:.0f} min: the last {:.0f} s were not kept; stops "
        "and "
        "lost ticks were counted to the end.",
        record.samples.back().time_ms / 60e3, static_cast<double>(record.ticks_left_out) * 1e-3);
  if (record.unasked_holds > 0)
    text += fmt::format(" Held {} without being asked.", counted(record.unasked_holds, "time"));
  return text;
}

// A rehearsal of a stage without a brake goes on after such an image; nobody may with a patient.
std::string disturbed_images(const RunRecord& record) {
  std::size_t images = 0, disturbed = 0;
  for (const StepResult& result : record.steps)
    if (result.check) ++images, disturbed += result.hv_switching_during_image ? 1 : 0;
  if (disturbed == 0) return {};
  return fmt::format(
      " The drive switched, or the needle slipped, in {} of {}: with a patient such an image confirms no "
      "depth.",
      disturbed, counted(images, "image"));
}

// What the robot was shown was not what was there.
std::string faults_put_in(const RunRecord& record) {
  std::string text;
  for (const FaultResult& fault : record.faults)
    text += (text.empty() ? " Put in: " : ", ") + fault.signal + " " + fault.kind +
            (std::isnan(fault.began_s) ? " (never began)" : "");
  return text.empty() ? text : text + ".";
}

std::string with_remedy(const RunRecord& record, const std::string& fallback) {
  std::string text = ended(record.refusal.empty() ? fallback : record.refusal);
  if (!record.remedy.empty()) text += " What to do: " + ended(record.remedy);
  return text;
}

std::string planned_only(const Plan& plan) {
  return "Planned, not run: target " + fixed(plan.target_depth.value, 2, "mm") + " in " +
         plan.layer_at(plan.target_depth) + ", " + counted(plan.steps.size(), "step") + ". Nothing moved.";
}

}  // namespace

std::string verdict_sentence(const RunRecord& record) {
  if (record.outcome == Outcome::Completed && record.samples.empty() && record.plan)
    return planned_only(*record.plan);
  switch (record.outcome) {
    case Outcome::Completed:
      return "Completed: " + needle_and_image(record) + "." + needle_left(record) + disturbed_images(record) +
             time_kept(record) + faults_put_in(record);
    case Outcome::Refused:
      return "Refused: " + with_remedy(record, "no reason was given");
    case Outcome::Stopped:
      return "Stopped: " + with_remedy(record, "no reason was given") +
             " At the end: " + needle_and_image(record) + "." + needle_left(record) +
             disturbed_images(record) + time_kept(record) + faults_put_in(record);
  }
  return "";
}

const DepthCheck* last_check(const RunRecord& record) {
  for (auto result = record.steps.rbegin(); result != record.steps.rend(); ++result)
    if (result->check) return &*result->check;
  return nullptr;
}

std::vector<StepResult> driven_or_planned_steps(const RunRecord& record) {
  std::vector<StepResult> steps = record.steps;
  if (steps.empty() && record.plan)
    for (const InsertionStep& step : record.plan->steps) steps.emplace_back().step = step;
  return steps;
}

double used_percent(const LimitUse& use) {
  return use.limit > 0 ? 100.0 * use.used / use.limit : kUnknown;
}

}  // namespace biopsy::report
