// ros2_reader DOMAIN PATIENCE_S [ENCLAVE]: a subscriber as rmw_cyclonedds_cpp makes one, with nothing of the
// product in it. Prints what discovery tells of every writer and one sample of each topic, a line each, and
// ends when it has all.
#include <dds/dds.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>

#include "ros2_types.h"

namespace {

// As ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST configures it.
const char* kLocalhost =
    "<CycloneDDS><Domain Id='any'><General><Interfaces><NetworkInterface name='lo' "
    "multicast='false'/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers><Peer "
    "Address='localhost'/></Peers></Discovery></Domain></CycloneDDS>";

std::set<std::string> samples;

std::string hex(const unsigned char* octets) {
  std::string text;
  for (int i = 0; i < 16; ++i) {
    char two[3];
    std::snprintf(two, sizeof two, "%02x", octets[i]);
    text += two;
  }
  return text;
}

std::string user_data(const dds_qos_t* qos) {
  void* value = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &value, &size)) return {};
  std::string text(static_cast<const char*>(value), size);
  dds_free(value);
  return text;
}

void print(const dds_builtintopic_endpoint_t& endpoint, const char* what) {
  dds_reliability_kind_t reliability{};
  dds_durability_kind_t durability{};
  dds_history_kind_t history{};
  int depth = 0;
  dds_duration_t blocking = 0, deadline = 0, lifespan = 0, lease = 0;
  dds_liveliness_kind_t liveliness{};
  dds_ownership_kind_t ownership{};
  dds_qget_reliability(endpoint.qos, &reliability, &blocking);
  dds_qget_durability(endpoint.qos, &durability);
  dds_qget_history(endpoint.qos, &history, &depth);
  dds_qget_deadline(endpoint.qos, &deadline);
  dds_qget_lifespan(endpoint.qos, &lifespan);
  dds_qget_liveliness(endpoint.qos, &liveliness, &lease);
  dds_qget_ownership(endpoint.qos, &ownership);
  const dds_typeinfo_t* types = nullptr;
  const bool typed = dds_builtintopic_get_endpoint_type_info(
                         const_cast<dds_builtintopic_endpoint_t*>(&endpoint), &types) == 0 &&
                     types != nullptr;
  std::printf("%s %s %s %s %s deadline=%d lifespan=%d liveliness=%d,%d ownership=%d xtypes=%d %s %s\n", what,
              endpoint.topic_name, endpoint.type_name,
              reliability == DDS_RELIABILITY_RELIABLE ? "reliable" : "best_effort",
              durability == DDS_DURABILITY_VOLATILE          ? "volatile"
              : durability == DDS_DURABILITY_TRANSIENT_LOCAL ? "transient_local"
                                                             : "persistent",
              deadline != DDS_INFINITY, lifespan != DDS_INFINITY, liveliness, lease != DDS_INFINITY,
              ownership, typed, user_data(endpoint.qos).c_str(), hex(endpoint.key.v).c_str());
}

void show(const sensor_msgs_msg_dds__JointState_& m) {
  std::printf(
      "joint_states frame='%s' sec=%d names=%u name=%s positions=%u position=%.9f velocities=%u efforts=%u\n",
      m.header_.frame_id_, m.header_.stamp_.sec_, m.name_._length, m.name_._buffer[0], m.position_._length,
      m.position_._buffer[0], m.velocity_._length, m.effort_._length);
}
void show(const std_msgs_msg_dds__Float64_& m) {
  std::printf("depth %.9f\n", m.data_);
}
void show(const std_msgs_msg_dds__String_& m) {
  std::printf("state %s\n", m.data_);
}
void show(const geometry_msgs_msg_dds__PoseStamped_& m) {
  const auto& [x, y, z] = m.pose_.position_;
  const auto& turn = m.pose_.orientation_;
  std::printf("pose frame='%s' at %.6f %.6f %.6f turn %.6f %.6f %.6f %.6f\n", m.header_.frame_id_, x, y, z,
              turn.x_, turn.y_, turn.z_, turn.w_);
}
void show(const diagnostic_msgs_msg_dds__DiagnosticArray_& m) {
  for (unsigned i = 0; i < m.status_._length; ++i) {
    const auto& status = m.status_._buffer[i];
    std::printf("diagnostic %d '%s' '%s' '%s'", status.level_, status.name_, status.message_,
                status.hardware_id_);
    for (unsigned k = 0; k < status.values_._length; ++k)
      std::printf(" %s=%s;", status.values_._buffer[k].key_, status.values_._buffer[k].value_);
    std::printf("\n");
  }
}
void show(const rmw_dds_common_msg_dds__ParticipantEntitiesInfo_& m) {
  std::printf("participant_info %s\n", hex(m.gid_.data_).c_str());
  for (unsigned i = 0; i < m.node_entities_info_seq_._length; ++i) {
    const auto& node = m.node_entities_info_seq_._buffer[i];
    std::printf("node %s %s readers=%u", node.node_namespace_, node.node_name_, node.reader_gid_seq_._length);
    for (unsigned k = 0; k < node.writer_gid_seq_._length; ++k)
      std::printf(" %s", hex(node.writer_gid_seq_._buffer[k].data_).c_str());
    std::printf("\n");
  }
}

template <class Message>
class Subscription {
 public:
  Subscription(dds_entity_t participant, const char* topic, const dds_topic_descriptor_t& type,
               bool late_joiner = false)
      : name_(topic) {
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_INFINITY);
    dds_qset_durability(qos, late_joiner ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
    reader_ = dds_create_reader(participant, dds_create_topic(participant, &type, topic, nullptr, nullptr),
                                qos, nullptr);
    dds_delete_qos(qos);
  }
  void poll() {
    void* sample = nullptr;
    dds_sample_info_t info{};
    if (samples.count(name_) > 0 || dds_take(reader_, &sample, &info, 1, 1) <= 0) return;
    if (info.valid_data) {
      samples.insert(name_);
      show(*static_cast<const Message*>(sample));
    }
    dds_return_loan(reader_, &sample, 1);
  }

 private:
  std::string name_;
  dds_entity_t reader_ = 0;
};

// As rmw_cyclonedds_cpp does it with an enclave.
void use(dds_qos_t* qos, const std::string& enclave) {
  const auto file = [&](const char* property, const char* name) {
    dds_qset_prop(qos, property, ("file:" + enclave + "/" + name).c_str());
  };
  file("dds.sec.auth.identity_ca", "identity_ca.cert.pem");
  file("dds.sec.auth.private_key", "key.pem");
  file("dds.sec.auth.identity_certificate", "cert.pem");
  file("dds.sec.access.permissions_ca", "permissions_ca.cert.pem");
  file("dds.sec.access.governance", "governance.p7s");
  file("dds.sec.access.permissions", "permissions.p7s");
  const char* folder = std::getenv("DDS_SECURITY_PLUGINS");
  const std::string at = folder ? std::string(folder) + "/lib" : "", end = folder ? ".so" : "";
  const auto plugin = [&](const std::string& kind, const std::string& library, const std::string& subject) {
    dds_qset_prop(qos, ("dds.sec." + kind + ".library.path").c_str(), (at + library + end).c_str());
    dds_qset_prop(qos, ("dds.sec." + kind + ".library.init").c_str(), ("init_" + subject).c_str());
    dds_qset_prop(qos, ("dds.sec." + kind + ".library.finalize").c_str(), ("finalize_" + subject).c_str());
  };
  plugin("auth", "dds_security_auth", "authentication");
  plugin("crypto", "dds_security_crypto", "crypto");
  plugin("access", "dds_security_ac", "access_control");
}

void print_discovered(dds_entity_t reader, const char* what) {
  void* sample = nullptr;
  dds_sample_info_t info{};
  while (dds_take(reader, &sample, &info, 1, 1) > 0) {
    const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(sample);
    if (info.valid_data && info.instance_state == DDS_ALIVE_INSTANCE_STATE) print(endpoint, what);
    dds_return_loan(reader, &sample, 1);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const auto domain = static_cast<dds_domainid_t>(std::atoi(argv[1]));
  dds_create_domain(domain, kLocalhost);
  dds_qos_t* qos = dds_create_qos();
  if (argc > 3) use(qos, argv[3]);
  const dds_entity_t participant = dds_create_participant(domain, qos, nullptr);
  dds_delete_qos(qos);
  if (participant < 0) return std::printf("no participant: %s\n", dds_strretcode(participant)), 1;
  const dds_entity_t writers =
      dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
  const dds_entity_t readers =
      dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr);
  const dds_entity_t participants =
      dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr);
  Subscription<sensor_msgs_msg_dds__JointState_> joints(participant, "rt/joint_states",
                                                        sensor_msgs_msg_dds__JointState__desc);
  Subscription<std_msgs_msg_dds__Float64_> depth(participant, "rt/needle/depth",
                                                 std_msgs_msg_dds__Float64__desc);
  Subscription<std_msgs_msg_dds__String_> state(participant, "rt/supervisor/state",
                                                std_msgs_msg_dds__String__desc);
  Subscription<geometry_msgs_msg_dds__PoseStamped_> pose(participant, "rt/needle/state/pose",
                                                         geometry_msgs_msg_dds__PoseStamped__desc);
  Subscription<diagnostic_msgs_msg_dds__DiagnosticArray_> diagnostics(
      participant, "rt/diagnostics", diagnostic_msgs_msg_dds__DiagnosticArray__desc);
  Subscription<rmw_dds_common_msg_dds__ParticipantEntitiesInfo_> graph(
      participant, "ros_discovery_info", rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc, true);
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(std::atoi(argv[2]));
  while (samples.size() < 6 && std::chrono::steady_clock::now() < until) {
    joints.poll();
    depth.poll();
    state.poll();
    pose.poll();
    diagnostics.poll();
    graph.poll();
    dds_sleepfor(DDS_MSECS(5));
  }
  print_discovered(writers, "writer");
  print_discovered(readers, "reader");
  void* sample = nullptr;
  dds_sample_info_t info{};
  while (dds_take(participants, &sample, &info, 1, 1) > 0) {
    const auto& found = *static_cast<const dds_builtintopic_participant_t*>(sample);
    if (info.valid_data)
      std::printf("participant %s %s\n", hex(found.key.v).c_str(), user_data(found.qos).c_str());
    dds_return_loan(participants, &sample, 1);
  }
  // Without Cyclone DDS's own end: with security 0.10.2 crashes in it now and then, after all was read.
  std::fflush(stdout);
  std::_Exit(samples.size() == 6 ? 0 : 1);
}
