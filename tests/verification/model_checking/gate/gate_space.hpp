// States and inputs of the gate: numbers and clocks only by relation, permits and voltages by
// representatives.
//
// Numbers are compared, never computed with: session, epoch and seq below, equal to and above the honoured
// one, renamed after each step. Time enters by the step of the clock (sound, longest sound, standing, back,
// jumped) and the permit's age, in whole milliseconds up to its end. A voltage is compared, negated and cut
// by minimum: it takes every value that climbing with the steepest slew reaches from 0 and from an envelope
// of 600 V.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "safety/gate.hpp"

namespace biopsy::model_checking {

struct GateInput {
  std::optional<Permit> permit;
  std::optional<DriveRequest> request;
  std::int64_t dt_us = 1'000;
  std::int32_t writers = 1;
};

class GateSpace {
 public:
  explicit GateSpace(bool quick);

  std::uint32_t size() const;
  GateInput at(std::uint32_t index, const safety::GateState& state) const;
  std::uint64_t key_of(const safety::GateState& state) const;
  safety::GateState state_of(std::uint64_t key) const;

 private:
  struct Arrival {  // of a permit, against the honoured one
    enum class Kind : std::uint8_t { None, Again, New } kind = Kind::None;
    int session = 0, epoch = 0, seq = 1;
    std::size_t content = 0;
  };
  struct Asked {  // a request, against the last one taken
    bool any = false;
    int seq = 0;
    std::int32_t wanted_mV = 0;
    bool brake = false;
  };
  struct Beat {
    std::int64_t dt_us;
    std::int32_t writers;
  };
  void set_arrivals();
  std::size_t content_of(const Permit& permit) const;

  std::vector<Permit> contents_;
  std::vector<Arrival> arrivals_;
  std::vector<Asked> asked_;
  std::vector<Beat> beats_;
};

}  // namespace biopsy::model_checking
