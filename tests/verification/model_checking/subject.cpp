#include "tests/verification/model_checking/subject.hpp"

#include "tests/safety/situation.hpp"

namespace biopsy::model_checking {

Subject shipped() {
  return {[](const PlanFacts* plan, const SupervisorState* state, const Situation* input) {
            return safety::step(*plan, *state, *input);
          },
          [](const safety::GateState* state, const DriveRequest* request, const Permit* permit,
             std::int64_t now_us, std::int32_t writer_count, safety::GateState* next, std::int32_t* mV,
             bool* hv_enabled, bool* brake_on, GateVerdict* verdict) {
            const safety::GateResult result = safety::gate(*state, request, permit, now_us, writer_count);
            *next = result.state;
            *mV = result.voltage.mV();
            *hv_enabled = result.voltage.hv_enabled();
            *brake_on = result.voltage.brake_on();
            *verdict = result.verdict;
          }};
}

}  // namespace biopsy::model_checking
