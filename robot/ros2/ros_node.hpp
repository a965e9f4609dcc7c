// A node of ROS 2 on DDS, without ROS 2: topics, types, quality of service, type hashes and
// ros_discovery_info as rmw_cyclonedds_cpp has them (Jazzy and later), so that `ros2 topic` and `ros2 node`
// find it. It can only publish: it makes no reader.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "robot/transport/bus.hpp"

namespace biopsy::ros2 {

struct RosSettings {
  std::uint32_t domain = 0;  // ROS_DOMAIN_ID, 0 to 230; not that of another participant of this process
  std::string interface;     // of the network; empty: this machine only
  std::filesystem::path
      enclave;  // of a keystore of ROS 2 (`ros2 security create_enclave`); empty: without security
};

class RosNode {
 public:
  // /name. Throws ConfigError for keys that are missing or not accepted, and for a network interface that is
  // not there.
  RosNode(const RosSettings& settings, const std::string& name);

  // `topic` as ROS 2 names it, such as /joint_states. Throws ConfigError.
  std::size_t advertise(const std::string& topic, const dds_topic_descriptor_t& type);
  // Tells other nodes of what was advertised; to be called once, after the last advertise().
  void announce();
  // `sample` is of the type that was advertised. False: not sent.
  bool publish(std::size_t publisher, const void* sample);

 private:
  std::string name_;
  transport::Entity domain_, participant_, graph_topic_, graph_;
  std::vector<transport::Entity> topics_, writers_;
};

// "enclave=/biopsy;" of .../enclaves/biopsy, as other nodes read it from a participant; "enclave=/;" of no
// folder.
std::string enclave_user_data(const std::filesystem::path& enclave);

}  // namespace biopsy::ros2
