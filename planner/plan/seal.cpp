#include "planner/plan/seal.hpp"

#include <span>

#include "robot/common/byte_writer.hpp"

namespace biopsy::planner {
namespace {

void write(ByteWriter& to, const Target& target) {
  to.text(target.patient_id);
  to.text(target.series_uid);
  for (const Point& point : {target.p_SE, target.p_ST})
    for (const double coordinate : point) to.number(coordinate);
}

void write(ByteWriter& to, const RigidTransform& X) {
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) to.number(X.matrix()(row, column));
}

void write(ByteWriter& to, const Layer& layer) {
  to.text(layer.name);
  to.number(layer.from.value);
  to.number(layer.to.value);
}

void write(ByteWriter& to, const InsertionStep& step) {
  to.byte(static_cast<std::uint8_t>(step.kind));
  to.number(step.depth.value);
  to.number(step.speed.value);
  to.number(step.v_max.value);
  to.number(step.dwell.count());
  to.byte(step.image_confirms ? 1 : 0);
  to.text(step.why);
}

void write(ByteWriter& to, const DepthBand& band) {
  to.number(band.drive.value);
  to.number(band.low.value);
  to.number(band.high.value);
}

template <class Item>
void write(ByteWriter& to, const std::vector<Item>& items) {
  to.integer(items.size());
  for (const Item& item : items) write(to, item);
}

}  // namespace

std::vector<std::uint8_t> canonical_bytes(const Plan& plan) {
  ByteWriter to;
  to.text("biopsy-plan-1");
  write(to, plan.target);
  write(to, plan.X_SR);
  to.number(plan.registration_fre_mm);
  to.number(plan.registration_tre_mm);
  to.number(plan.target_depth.value);
  to.number(plan.axis_offset.value);
  write(to, plan.layers);
  write(to, plan.steps);
  to.number(plan.limits.depth_max.value);
  to.number(plan.limits.v_max.value);
  write(to, plan.limits.plausible);
  if (plan.gains != PiGains{}) {  // a plan with the paper's gains has the seal that it always had
    to.text("controller");
    to.number(plan.gains.proportional_V_per_mm);
    to.number(plan.gains.integral_V_per_mm_per_tick);
  }
  if (plan.bench) {
    to.text("bench");
    to.number(plan.bench->half_period.count());
  }
  if (plan.tip_offset) {
    to.text("tip offset");
    to.text(plan.tip_offset->needle);
    to.text(plan.tip_offset->sequence);
    to.number(plan.tip_offset->value.value);
    to.number(plan.tip_offset->sigma.value);
  }
  return to.bytes();
}

Sha256 seal_of(const Plan& plan) {
  const std::vector<std::uint8_t> bytes = canonical_bytes(plan);
  return sha256(std::as_bytes(std::span(bytes)));
}

void seal(Plan& plan) {
  plan.seal = seal_of(plan);
}

bool seal_holds(const Plan& plan) {
  return plan.seal == seal_of(plan);
}

std::uint64_t plan_tag(const Plan& plan) {
  return first_64_bits(plan.seal);
}

}  // namespace biopsy::planner
