// Records every topic of the bus in an MCAP file while the robot runs, for viewers. It only reads, as the
// role Mcap: the procedure log, which stops the robot where it cannot be written, does not depend on it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "robot/transport/bus.hpp"

namespace biopsy::robot {

class McapRecorder {
 public:
  // Makes `file`; one that is there is refused. `rate_Hz`: at most so many messages a second of each cyclic
  // topic, beside those in which more than numbers changed. Throws ConfigError where it cannot be written.
  McapRecorder(const transport::Participant& bus, const std::filesystem::path& file, double rate_Hz,
               const std::string& library);
  ~McapRecorder();

  // Takes all messages, with `utc_ns` as their time; every 2 ms. Once a second what was taken is written and
  // brought to the disk, as a chunk of its own: a recorder that is killed leaves a file without its summary,
  // in which readers find all but the last second. Throws ConfigError where writing fails.
  void turn(std::int64_t now_us, std::int64_t utc_ns);

  // Writes the rest and the summary.
  void finish();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// bus.mcap in the folder, or the first of bus-2.mcap, bus-3.mcap ... that is not there.
std::filesystem::path free_mcap_name(const std::filesystem::path& folder);

}  // namespace biopsy::robot
