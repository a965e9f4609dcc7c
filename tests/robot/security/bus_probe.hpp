// One participant with one reader or writer, on the real Cyclone DDS, and bounded waits.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "robot/security/cyclone_xml.hpp"

namespace biopsy::security {

class BusProbe {
 public:
  // Every probe has a domain of its own in this process; probes with the same number communicate.
  BusProbe(int domain_on_wire, std::optional<Security> security);
  ~BusProbe();
  BusProbe(const BusProbe&) = delete;
  BusProbe& operator=(const BusProbe&) = delete;

  bool is_up() const { return participant_ > 0; }
  dds_return_t participant_error() const { return participant_; }
  // The entity, or the error of Cyclone DDS.
  dds_return_t open_writer(std::string_view topic);
  dds_return_t open_reader(std::string_view topic);

  // Whether a counterpart was matched within ten seconds.
  bool matches_a_reader();
  bool matches_a_writer();
  bool write(std::int32_t value);
  // GUID of the writer: 12 bytes of its participant, 4 of its own.
  dds_guid_t writer_guid() const;
  // The next value, within `patience`.
  std::optional<std::int32_t> next(dds_duration_t patience = DDS_SECS(10));
  int matched_readers() const;
  int matched_writers() const;

 private:
  dds_entity_t make_topic(std::string_view name);
  bool wait_for(dds_entity_t entity, std::uint32_t status, dds_duration_t patience);

  dds_entity_t domain_ = 0, participant_ = 0, writer_ = 0, reader_ = 0;
};

}  // namespace biopsy::security
