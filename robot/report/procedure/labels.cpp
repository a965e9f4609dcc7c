#include "robot/report/procedure/labels.hpp"

namespace biopsy::report {

std::string_view word(Outcome outcome) {
  switch (outcome) {
    case Outcome::Completed:
      return "completed";
    case Outcome::Refused:
      return "refused";
    case Outcome::Stopped:
      return "stopped";
  }
  return "unknown";
}

std::string_view word(Mode mode) {
  switch (mode) {
    case Mode::Boot:
      return "boot";
    case Mode::Safe:
      return "safe";
    case Mode::Ready:
      return "ready";
    case Mode::Armed:
      return "armed";
    case Mode::Active:
      return "active";
    case Mode::Hold:
      return "hold";
    case Mode::Retract:
      return "retract";
    case Mode::Trip:
      return "trip";
    case Mode::Lock:
      return "lock";
  }
  return "unknown";
}

std::string_view word(StopCategory stop) {
  switch (stop) {
    case StopCategory::None:
      return "none";
    case StopCategory::C2Hold:
      return "C2 hold";
    case StopCategory::C1Ramp:
      return "C1 ramp";
    case StopCategory::C0Off:
      return "C0 off";
  }
  return "unknown";
}

std::string_view word(GateVerdict verdict) {
  switch (verdict) {
    case GateVerdict::Refused:
      return "refused";
    case GateVerdict::Granted:
      return "granted";
    case GateVerdict::NoPermit:
      return "no permit";
    case GateVerdict::WrongSession:
      return "wrong session";
    case GateVerdict::OldEpoch:
      return "old epoch";
    case GateVerdict::OldSequence:
      return "old sequence";
    case GateVerdict::Expired:
      return "expired";
    case GateVerdict::SecondWriter:
      return "second writer";
    case GateVerdict::ClockJump:
      return "clock jump";
    case GateVerdict::NoRequest:
      return "no request";
    case GateVerdict::Limited:
      return "limited";
  }
  return "unknown";
}

std::string_view word(StepKind kind) {
  switch (kind) {
    case StepKind::Approach:
      return "approach";
    case StepKind::Cross:
      return "cross";
    case StepKind::Waypoint:
      return "waypoint";
    case StepKind::Target:
      return "target";
  }
  return "unknown";
}

std::string_view word(DepthVerdict verdict) {
  switch (verdict) {
    case DepthVerdict::Unsure:
      return "unsure";
    case DepthVerdict::Accept:
      return "accept";
    case DepthVerdict::Reject:
      return "reject";
  }
  return "unknown";
}

}  // namespace biopsy::report
