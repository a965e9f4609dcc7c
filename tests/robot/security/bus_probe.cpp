#include "tests/robot/security/bus_probe.hpp"

#include <atomic>
#include <cstddef>

namespace biopsy::security {
namespace {

struct Sample {
  std::int32_t value;
};

// What idlc writes for `@final struct Sample { long value; };`, without the type information.
constexpr std::uint32_t kOps[] = {
    std::uint32_t{DDS_OP_ADR} | std::uint32_t{DDS_OP_TYPE_4BY} | DDS_OP_FLAG_SGN, offsetof(Sample, value),
    DDS_OP_RTS};
const dds_topic_descriptor_t kSample{.m_size = sizeof(Sample),
                                     .m_align = alignof(Sample),
                                     .m_flagset = DDS_TOPIC_FIXED_SIZE,
                                     .m_nkeys = 0,
                                     .m_typename = "Sample",
                                     .m_keys = nullptr,
                                     .m_nops = 2,
                                     .m_ops = kOps,
                                     .m_meta = "",
                                     .type_information = {},
                                     .type_mapping = {},
                                     .restrict_data_representation = 0};

// Reliable and kept, so that a reader found late still gets what was written.
dds_qos_t* reliable() {
  static dds_qos_t* const qos = [] {
    dds_qos_t* made = dds_create_qos();
    dds_qset_reliability(made, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_durability(made, DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_history(made, DDS_HISTORY_KEEP_ALL, 0);
    return made;
  }();
  return qos;
}

}  // namespace

BusProbe::BusProbe(int domain_on_wire, std::optional<Security> security) {
  static std::atomic<dds_domainid_t> next_id{1};
  const dds_domainid_t id = next_id++;
  const std::string xml =
      cyclone_xml({.interface = {}, .security = std::move(security), .domain_on_wire = domain_on_wire});
  domain_ = dds_create_domain(id, xml.c_str());
  participant_ = domain_ < 0 ? domain_ : dds_create_participant(id, nullptr, nullptr);
}

BusProbe::~BusProbe() {
  if (domain_ > 0) dds_delete(domain_);
}

dds_entity_t BusProbe::make_topic(std::string_view name) {
  return dds_create_topic(participant_, &kSample, std::string(name).c_str(), nullptr, nullptr);
}

dds_return_t BusProbe::open_writer(std::string_view topic) {
  const dds_entity_t made = make_topic(topic);
  return writer_ = made < 0 ? made : dds_create_writer(participant_, made, reliable(), nullptr);
}

dds_return_t BusProbe::open_reader(std::string_view topic) {
  const dds_entity_t made = make_topic(topic);
  return reader_ = made < 0 ? made : dds_create_reader(participant_, made, reliable(), nullptr);
}

bool BusProbe::wait_for(dds_entity_t entity, std::uint32_t status, dds_duration_t patience) {
  dds_set_status_mask(entity, status);
  const dds_entity_t waitset = dds_create_waitset(participant_);
  dds_waitset_attach(waitset, entity, 0);
  const bool happened = dds_waitset_wait(waitset, nullptr, 0, patience) > 0;
  dds_delete(waitset);
  return happened;
}

bool BusProbe::matches_a_reader() {
  return matched_readers() > 0 || wait_for(writer_, DDS_PUBLICATION_MATCHED_STATUS, DDS_SECS(10));
}

bool BusProbe::matches_a_writer() {
  return matched_writers() > 0 || wait_for(reader_, DDS_SUBSCRIPTION_MATCHED_STATUS, DDS_SECS(10));
}

bool BusProbe::write(std::int32_t value) {
  const Sample sample{value};
  return dds_write(writer_, &sample) == DDS_RETCODE_OK;
}

dds_guid_t BusProbe::writer_guid() const {
  dds_guid_t guid{};
  dds_get_guid(writer_, &guid);
  return guid;
}

std::optional<std::int32_t> BusProbe::next(dds_duration_t patience) {
  Sample sample{};
  void* place = &sample;
  dds_sample_info_t info;
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (dds_take(reader_, &place, &info, 1, 1) == 1 && info.valid_data) return sample.value;
    if (attempt == 0) wait_for(reader_, DDS_DATA_AVAILABLE_STATUS, patience);
  }
  return std::nullopt;
}

int BusProbe::matched_readers() const {
  dds_publication_matched_status_t status{};
  dds_get_publication_matched_status(writer_, &status);
  return static_cast<int>(status.current_count);
}

int BusProbe::matched_writers() const {
  dds_subscription_matched_status_t status{};
  dds_get_subscription_matched_status(reader_, &status);
  return static_cast<int>(status.current_count);
}

}  // namespace biopsy::security
