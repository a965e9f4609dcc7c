#include "planner/plan/open_plan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "planner/plan/seal.hpp"

namespace biopsy::planner {
namespace {

// Reads what the serialiser of seal.cpp wrote. After the first thing that cannot be, it fails and reads
// zeros.
class Parser {
 public:
  explicit Parser(std::span<const std::uint8_t> bytes) : left_(bytes) {}

  bool failed() const { return failed_; }
  bool at_end() const { return left_.empty(); }

  std::uint8_t byte() {
    if (left_.empty()) return fail();
    const std::uint8_t value = left_.front();
    left_ = left_.subspan(1);
    return value;
  }
  std::uint64_t integer() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 8) value |= std::uint64_t{byte()} << shift;
    return value;
  }
  double number() {
    const double value = std::bit_cast<double>(integer());
    return std::isfinite(value) ? value : fail();
  }
  std::string text() {
    const std::size_t length = count(1);
    std::string value(left_.begin(), left_.begin() + static_cast<std::ptrdiff_t>(length));
    left_ = left_.subspan(length);
    return value;
  }
  // A number of items of at least `least_bytes` each; 0 where there is no room for them.
  std::size_t count(std::size_t least_bytes) {
    const std::uint64_t value = integer();
    return value <= left_.size() / least_bytes ? static_cast<std::size_t>(value) : fail();
  }
  bool flag() {
    const std::uint8_t value = byte();
    return value <= 1 ? value == 1 : fail() != 0;
  }
  std::uint8_t fail() {
    failed_ = true;
    left_ = {};
    return 0;
  }

 private:
  std::span<const std::uint8_t> left_;
  bool failed_ = false;
};

void read(Parser& from, Millimetres& value) {
  value = Millimetres(from.number());
}

void read(Parser& from, Point& p) {
  for (double& coordinate : p) coordinate = from.number();
}

void read(Parser& from, RigidTransform& X) {
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) X.matrix()(row, column) = from.number();
}

void read(Parser& from, Target& target) {
  target.patient_id = from.text();
  target.series_uid = from.text();
  read(from, target.p_SE);
  read(from, target.p_ST);
}

void read(Parser& from, Layer& layer) {
  layer.name = from.text();
  read(from, layer.from);
  read(from, layer.to);
}

void read(Parser& from, InsertionStep& step) {
  const std::uint8_t kind = from.byte();
  step.kind = kind <= static_cast<std::uint8_t>(StepKind::Target) ? static_cast<StepKind>(kind)
                                                                  : static_cast<StepKind>(from.fail());
  read(from, step.depth);
  step.speed = MillimetresPerSecond(from.number());
  step.v_max = Volts(from.number());
  step.dwell = Seconds(from.number());
  step.image_confirms = from.flag();
  step.why = from.text();
}

void read(Parser& from, DepthBand& band) {
  band.drive = Volts(from.number());
  read(from, band.low);
  read(from, band.high);
}

template <class Item>
void read(Parser& from, std::vector<Item>& items) {
  constexpr std::size_t kLeast_bytes = 24;  // every item has at least three numbers or lengths
  items.resize(from.count(kLeast_bytes));
  for (Item& item : items) read(from, item);
}

Plan read_plan(Parser& from) {
  Plan plan;
  if (from.text() != "biopsy-plan-1") from.fail();
  read(from, plan.target);
  read(from, plan.X_SR);
  plan.registration_fre_mm = from.number();
  plan.registration_tre_mm = from.number();
  read(from, plan.target_depth);
  read(from, plan.axis_offset);
  read(from, plan.layers);
  read(from, plan.steps);
  read(from, plan.limits.depth_max);
  plan.limits.v_max = Volts(from.number());
  read(from, plan.limits.plausible);
  std::string part = from.at_end() ? "" : from.text();
  if (part == "controller") {
    plan.gains.proportional_V_per_mm = from.number();
    plan.gains.integral_V_per_mm_per_tick = from.number();
    if (!is_permitted(plan.gains)) from.fail();
    part = from.at_end() ? "" : from.text();
  }
  if (part == "bench") {
    plan.bench = BenchDrive{Seconds(from.number())};
    part = from.at_end() ? "" : from.text();
  }
  if (part == "tip offset") {
    TipOffset& offset = plan.tip_offset.emplace();
    offset.needle = from.text();
    offset.sequence = from.text();
    read(from, offset.value);
    read(from, offset.sigma);
    part.clear();
  }
  if (!part.empty()) from.fail();
  return plan;
}

}  // namespace

std::optional<Plan> open_plan(std::span<const std::uint8_t> bytes, const Sha256& seal) {
  Parser from(bytes);
  Plan plan = read_plan(from);
  if (from.failed() || !from.at_end()) return std::nullopt;
  // Written anew, so that no other bytes can stand for the same plan.
  if (!std::ranges::equal(canonical_bytes(plan), bytes)) return std::nullopt;
  plan.seal = seal;
  if (!seal_holds(plan)) return std::nullopt;
  return plan;
}

}  // namespace biopsy::planner
