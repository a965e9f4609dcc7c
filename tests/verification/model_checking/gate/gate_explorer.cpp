#include "tests/verification/model_checking/gate/gate_explorer.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tests/verification/model_checking/supervisor/state_index.hpp"

namespace biopsy::model_checking {
namespace {

class GateExplorer {
 public:
  GateExplorer(const Subject& subject, bool quick) : subject_(subject), space_(quick) {}

  GateExploration run(std::uint64_t enough) {
    go(safety::GateState{}, 0, 0);
    for (std::uint32_t from = 0; from < keys_.size() && (enough == 0 || broken_ < enough); ++from) {
      const safety::GateState before = space_.state_of(keys_[from]);
      for (std::uint32_t index = 0; index < space_.size(); ++index) {
        const GateInput input = space_.at(index, before);
        check(take(before, input), from, index);
        go(after_, from, index);
      }
    }
    result_.states = keys_.size();
    return result_;
  }

 private:
  GateStep take(const safety::GateState& before, const GateInput& input) {
    const std::int64_t now_us = before.now_us + input.dt_us;
    GateStep step{before, input, now_us, after_, 0, false, false, GateVerdict::Refused};
    subject_.gate(&before, input.request ? &*input.request : nullptr, input.permit ? &*input.permit : nullptr,
                  now_us, input.writers, &after_, &step.mV, &step.hv_enabled, &step.brake_on, &step.verdict);
    ++result_.transitions;
    return step;
  }

  void check(const GateStep& step, std::uint32_t from, std::uint32_t index) {
    for (std::size_t i = 0; i < kGateInvariants; ++i) {
      const Finding finding = kGateInvariantTable[i].check(step);
      if (!finding.applies) continue;
      GateTally& tally = result_.claims[i];
      ++tally.checked;
      if (finding.holds) continue;
      ++broken_;
      if (++tally.broken == 1) tally.counterexample = counterexample(from, index, i);
    }
  }

  void go(const safety::GateState& to, std::uint32_t from, std::uint32_t index) {
    const std::uint64_t key = space_.key_of(to);
    if (!index_.number_of(key, static_cast<std::uint32_t>(keys_.size())).second) return;
    keys_.push_back(key);
    parents_.push_back(from);
    via_.push_back(index);
  }

  static std::string input_text(const safety::GateState& state, const GateInput& input) {
    std::string words = fmt::format("after {} us", input.dt_us);
    if (input.writers != 1) words += fmt::format(", {} writers", input.writers);
    if (input.permit)
      words += fmt::format(", permit (session {:+}, epoch {:+}, seq {:+}) mode {} stop {} {} up to {} V",
                           static_cast<std::int32_t>(input.permit->session - state.permit.session),
                           static_cast<std::int32_t>(input.permit->epoch - state.permit.epoch),
                           static_cast<std::int32_t>(input.permit->seq - state.permit.seq),
                           safety::name_of(input.permit->mode), static_cast<int>(input.permit->stop),
                           input.permit->hv_enable ? "enabled" : "off", input.permit->v_max_mV / 1'000);
    if (input.request)
      words += fmt::format(", request (seq {:+}) for {} V{}",
                           static_cast<std::int32_t>(input.request->seq - state.request_seq),
                           input.request->wanted_mV / 1'000, input.request->brake ? " and the brake" : "");
    return words;
  }

  // From the start, on the real function.
  std::string counterexample(std::uint32_t state, std::uint32_t last, std::size_t claim) {
    std::vector<std::uint32_t> way{last};
    for (; state != 0; state = parents_[state]) way.push_back(via_[state]);
    const safety::GateState kept = after_;
    safety::GateState before;
    std::string text;
    for (auto index = way.rbegin(); index != way.rend(); ++index) {
      const GateInput input = space_.at(*index, before);
      const GateStep step = take(before, input);
      text += fmt::format("  {} -> {} V, {}\n", input_text(before, input), step.mV / 1'000,
                          step.hv_enabled ? "enabled" : "off");
      before = after_;
    }
    after_ = kept;
    result_.transitions -= way.size();
    return fmt::format("{}  broken:    {}: {}\n", text, kGateInvariantTable[claim].name,
                       kGateInvariantTable[claim].sentence);
  }

  Subject subject_;
  GateSpace space_;
  GateExploration result_;
  StateIndex index_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> parents_, via_;
  safety::GateState after_;
  std::uint64_t broken_ = 0;
};

}  // namespace

std::uint64_t GateExploration::violations() const {
  std::uint64_t sum = 0;
  for (const GateTally& claim : claims) sum += claim.broken;
  return sum;
}

GateExploration explore_gate(const Subject& subject, bool quick, std::uint64_t enough) {
  return GateExplorer(subject, quick).run(enough);
}

}  // namespace biopsy::model_checking
