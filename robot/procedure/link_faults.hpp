// Faults of a file on the robot's links and panel contacts, in lockstep: what the supervisor and the gate get
// instead of what was sent. The controller and the gate get their measurement and voltage from the stage
// itself.
#pragma once

#include <cstdint>
#include <deque>
#include <map>

#include "robot/cycle/actuate.hpp"
#include "robot/cycle/fault_hooks.hpp"
#include "sim/faults/faulty_stage.hpp"

namespace biopsy::robot {

// Messages of one link on their way to one receiver.
template <class Message>
class FaultyLink {
 public:
  // What arrives now in place of `sent`. `lost`: this one does not.
  Message arriving(const sim::Fault& fault, bool active, bool lost, const Message& sent) {
    past_.push_back(sent);
    if (past_.size() > kPast_ticks) past_.pop_front();
    const bool stands = active && (fault.kind == sim::FaultKind::Frozen || lost);
    if (!stands) arrived_ = sent;
    if (active && fault.kind == sim::FaultKind::Lag) {
      const auto late = static_cast<std::size_t>(fault.value);
      if (late < past_.size()) arrived_ = past_[past_.size() - 1 - late];
    }
    return arrived_;
  }

 private:
  static constexpr std::size_t kPast_ticks = 1001;  // the longest lag, 1 s
  std::deque<Message> past_;
  Message arrived_{};
};

class LinkFaults final : public FaultHooks {
 public:
  // `stage` must outlive this; it says which fault shows.
  LinkFaults(const sim::FaultyStage& stage, std::uint64_t seed) : stage_(stage), seed_(seed) {}

  void before_monitors(safety::SupervisorInputs& inputs) override;
  void before_gate(GateInputs& inputs) override;

 private:
  bool is_lost(std::size_t i);
  void corrupt_contact(std::size_t i, bool& closed);

  const sim::FaultyStage& stage_;
  std::uint64_t seed_, draws_ = 0;
  // By the fault's number; a request goes to two receivers.
  std::map<std::size_t, FaultyLink<Measurement>> measurements_;
  std::map<std::size_t, FaultyLink<DriveRequest>> requests_, gate_requests_;
  std::map<std::size_t, FaultyLink<Permit>> permits_;
  std::map<std::size_t, bool> contacts_;  // last level before the fault
};

}  // namespace biopsy::robot
