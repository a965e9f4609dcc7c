#include "planner/plan/seal.hpp"

#include <openssl/evp.h>

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace biopsy::planner {
namespace {

class Serialiser {
 public:
  void byte(std::uint8_t value) { bytes_.push_back(value); }
  void integer(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) byte(static_cast<std::uint8_t>(value >> shift));
  }
  void number(double value) { integer(std::bit_cast<std::uint64_t>(value == 0.0 ? 0.0 : value)); }
  void text(std::string_view value) {
    integer(value.size());
    bytes_.insert(bytes_.end(), value.begin(), value.end());
  }
  void point(const Point& p) {
    for (const double coordinate : p) number(coordinate);
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

void write(Serialiser& to, const Target& target) {
  to.text(target.patient_id);
  to.text(target.series_uid);
  to.point(target.p_SE);
  to.point(target.p_ST);
}

void write(Serialiser& to, const RigidTransform& X) {
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) to.number(X.matrix()(row, column));
}

void write(Serialiser& to, const Layer& layer) {
  to.text(layer.name);
  to.number(layer.from.value);
  to.number(layer.to.value);
}

void write(Serialiser& to, const InsertionStep& stage) {
  to.byte(static_cast<std::uint8_t>(stage.kind));
  to.number(stage.depth.value);
  to.number(stage.speed.value);
  to.number(stage.v_max.value);
  to.number(stage.dwell.count());
  to.byte(stage.image_confirms ? 1 : 0);
  to.text(stage.why);
}

void write(Serialiser& to, const DepthBand& band) {
  to.number(band.drive.value);
  to.number(band.low.value);
  to.number(band.high.value);
}

template <class Item>
void write(Serialiser& to, const std::vector<Item>& items) {
  to.integer(items.size());
  for (const Item& item : items) write(to, item);
}

Sha256 sha256(const std::vector<std::uint8_t>& bytes) {
  Sha256 digest{};
  unsigned int length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1 ||
      length != digest.size()) {
    std::fputs("SHA-256 is not available in this build of OpenSSL\n", stderr);
    std::abort();
  }
  return digest;
}

}  // namespace

std::vector<std::uint8_t> canonical_bytes(const Plan& plan) {
  Serialiser to;
  to.text("biopsy-plan-1");
  write(to, plan.target);
  write(to, plan.X_SR);
  to.number(plan.registration_fre_mm);
  to.number(plan.registration_tre_mm);
  to.number(plan.target_depth.value);
  to.number(plan.axis_offset.value);
  write(to, plan.layers);
  write(to, plan.stages);
  to.number(plan.limits.depth_max.value);
  to.number(plan.limits.v_max.value);
  write(to, plan.limits.plausible);
  if (plan.bench) {
    to.text("bench");
    to.number(plan.bench->half_period.count());
  }
  return to.take();
}

void seal(Plan& plan) {
  plan.seal = sha256(canonical_bytes(plan));
}

bool seal_holds(const Plan& plan) {
  return plan.seal == sha256(canonical_bytes(plan));
}

std::uint64_t plan_tag(const Plan& plan) {
  std::uint64_t tag = 0;
  for (std::size_t n = 0; n < 8; ++n) tag = tag << 8 | plan.seal[n];
  return tag;
}

std::string hex(const Sha256& digest) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : digest) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

}  // namespace biopsy::planner
