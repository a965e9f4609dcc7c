#include "robot/ros2/ros_node.hpp"

#include <fmt/format.h>
#include <ros2_messages.h>

#include <cstring>
#include <memory>

#include "robot/common/config_error.hpp"
#include "robot/ros2/type_hashes.hpp"
#include "robot/security/cyclone_xml.hpp"

namespace biopsy::ros2 {
namespace {

namespace fs = std::filesystem;
using transport::Entity;

constexpr int kDepth = 10;  // of ROS 2's default profile

struct QosFree {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosFree>;

// sensor_msgs/msg/JointState of sensor_msgs::msg::dds_::JointState_
std::string ros_type_name(std::string dds_name) {
  for (const std::string_view part : {"::dds_::", "::"})
    for (std::size_t at = dds_name.find(part); at != std::string::npos; at = dds_name.find(part))
      dds_name.replace(at, part.size(), "/");
  return dds_name.substr(0, dds_name.size() - 1);
}

// Blocking time 0: never waits for a slow reader.
Qos qos_of(const dds_topic_descriptor_t& type, bool late_joiners_too) {
  Qos qos(dds_create_qos());
  const dds_data_representation_id_t representation = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &representation);
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, 0);
  dds_qset_durability(qos.get(), late_joiners_too ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, late_joiners_too ? 1 : kDepth);
  dds_qset_writer_data_lifecycle(qos.get(), false);
  const std::string hash = fmt::format("typehash={};", type_hash(ros_type_name(type.m_typename)));
  dds_qset_userdata(qos.get(), hash.data(), hash.size());
  return qos;
}

security::RoleFiles files_of(const fs::path& enclave) {
  const security::RoleFiles files{enclave / "identity_ca.cert.pem",
                                  enclave / "permissions_ca.cert.pem",
                                  enclave / "cert.pem",
                                  enclave / "key.pem",
                                  enclave / "governance.p7s",
                                  enclave / "permissions.p7s"};
  for (const fs::path& file : {files.identity_ca, files.permissions_ca, files.identity, files.private_key,
                               files.governance, files.permissions})
    if (!fs::is_regular_file(file))
      throw ConfigError("is missing in the enclave", file.string(),
                        "make it: ros2 security create_enclave KEYSTORE /biopsy");
  return files;
}

rmw_dds_common_msg_dds__Gid_ gid_of(const Entity& entity) {
  dds_guid_t guid{};
  dds_get_guid(entity.handle(), &guid);
  rmw_dds_common_msg_dds__Gid_ gid{};
  static_assert(sizeof gid.data == sizeof guid.v);
  std::memcpy(gid.data, guid.v, sizeof gid.data);
  return gid;
}

}  // namespace

std::string enclave_user_data(const fs::path& enclave) {
  if (enclave.empty()) return "enclave=/;";
  std::string name;
  bool inside = false;
  for (const fs::path& part : fs::absolute(enclave).lexically_normal()) {
    if (inside && !part.empty()) name += "/" + part.string();
    inside = inside || part == "enclaves";
  }
  return fmt::format("enclave={};", name.empty() ? "/" : name);
}

RosNode::RosNode(const RosSettings& settings, const std::string& name) : name_(name) {
  security::CycloneOptions options;
  options.interface = settings.interface;
  if (!settings.enclave.empty()) options.enclave = files_of(settings.enclave);
  domain_ =
      Entity(dds_create_domain(settings.domain, security::cyclone_xml(options).c_str()), "domain of ROS 2");
  const std::string enclave = enclave_user_data(settings.enclave);
  const Qos qos(dds_create_qos());
  dds_qset_userdata(qos.get(), enclave.data(), enclave.size());
  participant_ = Entity(dds_create_participant(settings.domain, qos.get(), nullptr), "participant of ROS 2");
  const dds_topic_descriptor_t& graph = rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc;
  graph_topic_ =
      Entity(dds_create_topic(participant_.handle(), &graph, "ros_discovery_info", nullptr, nullptr),
             "ros_discovery_info");
  graph_ = Entity(
      dds_create_writer(participant_.handle(), graph_topic_.handle(), qos_of(graph, true).get(), nullptr),
      "writer of ros_discovery_info");
}

std::size_t RosNode::advertise(const std::string& topic, const dds_topic_descriptor_t& type) {
  topics_.emplace_back(
      dds_create_topic(participant_.handle(), &type, ("rt" + topic).c_str(), nullptr, nullptr),
      topic.c_str());
  writers_.emplace_back(
      dds_create_writer(participant_.handle(), topics_.back().handle(), qos_of(type, false).get(), nullptr),
      topic.c_str());
  return writers_.size() - 1;
}

void RosNode::announce() {
  std::vector<rmw_dds_common_msg_dds__Gid_> writers;
  for (const Entity& writer : writers_) writers.push_back(gid_of(writer));
  rmw_dds_common_msg_dds__NodeEntitiesInfo_ node{};
  std::strcpy(node.node_namespace, "/");
  name_.copy(node.node_name, sizeof node.node_name - 1);
  const auto count = static_cast<std::uint32_t>(writers.size());
  node.writer_gid_seq = {count, count, writers.data(), false};
  rmw_dds_common_msg_dds__ParticipantEntitiesInfo_ info{};
  info.gid = gid_of(participant_);
  info.node_entities_info_seq = {1, 1, &node, false};
  dds_write(graph_.handle(), &info);
}

bool RosNode::publish(std::size_t publisher, const void* sample) {
  return dds_write(writers_.at(publisher).handle(), sample) == DDS_RETCODE_OK;
}

}  // namespace biopsy::ros2
