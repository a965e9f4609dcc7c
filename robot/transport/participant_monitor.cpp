#include "robot/transport/participant_monitor.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

namespace biopsy::transport {
namespace {

constexpr std::size_t kMost = 256;  // samples of one read

using Guid = std::array<std::uint8_t, 16>;

Guid guid_of(const dds_guid_t& key) {
  Guid guid;
  static_assert(sizeof key.v == sizeof guid);
  std::memcpy(guid.data(), key.v, sizeof key.v);
  return guid;
}

Guid guid_of(const Entity& entity) {
  dds_guid_t key{};
  dds_get_guid(entity.handle(), &key);
  return guid_of(key);
}

// Member `key` of each alive sample of a built-in topic.
template <class Sample>
std::vector<Guid> alive(const Entity& reader, dds_guid_t Sample::*key) {
  std::array<void*, kMost> samples{};  // lent by the library
  std::array<dds_sample_info_t, kMost> infos;
  const int count = dds_read_mask(reader.handle(), samples.data(), infos.data(), kMost, kMost,
                                  DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE);
  std::vector<Guid> keys;
  for (int i = 0; i < count; ++i) keys.push_back(guid_of(static_cast<const Sample*>(samples[i])->*key));
  if (count > 0) dds_return_loan(reader.handle(), samples.data(), count);
  return keys;
}

}  // namespace

ParticipantMonitor::ParticipantMonitor(const BusSettings& plain, const Participant& secured)
    : domain_(dds_create_domain(plain.domain, plain.configuration.c_str()), "domain of the participants"),
      participant_(dds_create_participant(plain.domain, nullptr, nullptr), "participant of the participants"),
      writers_(dds_create_reader(participant_.handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
               "reader of writers"),
      readers_(dds_create_reader(participant_.handle(), DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr),
               "reader of readers"),
      present_(dds_create_reader(participant_.handle(), DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
               "reader of participants"),
      secured_writers_(
          dds_create_reader(secured.handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
          "reader of secured writers"),
      secured_readers_(
          dds_create_reader(secured.handle(), DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr),
          "reader of secured readers") {}

int ParticipantMonitor::unauthenticated_endpoints() const {
  const Guid own = guid_of(participant_);
  int count = 0;
  for (const Entity* reader : {&writers_, &readers_})
    for (const Guid& owner : alive(*reader, &dds_builtintopic_endpoint_t::participant_key))
      count += owner != own;
  return count;
}

// An authenticated participant has endpoints, which the secured bus announces only after the handshake;
// participants it announces before.
int ParticipantMonitor::unauthenticated_participants() const {
  std::vector<Guid> authenticated{guid_of(participant_)};
  for (const Entity* reader : {&secured_writers_, &secured_readers_})
    for (const Guid& owner : alive(*reader, &dds_builtintopic_endpoint_t::participant_key))
      authenticated.push_back(owner);
  int count = 0;
  for (const Guid& seen : alive(present_, &dds_builtintopic_participant_t::key))
    count += std::ranges::find(authenticated, seen) == authenticated.end();
  return count;
}

}  // namespace biopsy::transport
