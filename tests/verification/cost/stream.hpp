// What a supervisor and its gate are given, tick by tick: recorded from procedures with every class of fault,
// and made up at random where no procedure leads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "robot/cycle/run_cycle.hpp"
#include "tests/safety/situation.hpp"
#include "tests/verification/fault_injection/campaign.hpp"

namespace biopsy::fault_injection {

struct TickInput {
  safety::SupervisorInputs seen;
  safety::Situation asked;  // without the evidence
  Permit permit;            // as it arrives at the gate
  DriveRequest request;
  bool permit_arrives = true;
  std::int64_t gate_us = 0;
  std::int32_t writers = 1;
};

struct Stream {
  safety::PlanFacts facts;
  std::vector<TickInput> ticks;
};

// One corrupted procedure of every class, from its beginning to the end of its reaction.
std::vector<Stream> recorded_streams(const NominalModels& models, std::size_t classes);
// The largest plan the supervisor holds, and everything it can be shown changing from tick to tick.
Stream random_stream(std::uint64_t seed, std::size_t ticks);

// Raw, for another process of the same build.
bool write_streams(const std::filesystem::path& file, const std::vector<Stream>& streams);
std::vector<Stream> read_streams(const std::filesystem::path& file);

}  // namespace biopsy::fault_injection
