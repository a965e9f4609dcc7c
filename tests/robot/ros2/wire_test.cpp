// A robot's bus with known samples on one side, ros2_reader on the other: a process of its own that has
// nothing of the product in it. What it is told is compared field by field with what a ROS 2 node
// (rmw_cyclonedds_cpp, Jazzy) tells.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>
#include <sstream>

#include "planner/plan/seal.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/subprocess.hpp"
#include "robot/ros2/bus_observer.hpp"
#include "robot/ros2/state_publisher.hpp"
#include "robot/ros2/type_hashes.hpp"
#include "robot/security/cyclone_xml.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::ros2 {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kBusDomain = 92;
constexpr std::int64_t kWall_ns = 1'700'000'000'123'456'789;

// Stands at (10, 20, 30) mm LPS and inserts along +x of the patient's left.
Plan known_plan() {
  Plan plan;
  plan.X_SR = RigidTransform::Identity();
  plan.X_SR.translation() = Point(10.0, 20.0, 30.0);
  plan.X_SR.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  planner::seal(plan);
  return plan;
}

class Robot {
 public:
  explicit Robot(std::uint32_t domain) : bus_({domain, security::cyclone_xml({}), 7}) {}

  RobotState tick(const Measurement& measured, std::int64_t now_us) {
    Measurement next = measured;
    next.seq = ++seq_;
    const Plan plan = known_plan();
    plans_.write({1, planner::canonical_bytes(plan), seal_, {}});
    measurements_.write(next);
    decisions_.write({.seq = seq_, .mode = Mode::Active, .step = 2});
    health_.write({.process = Process::Stage,
                   .seq = seq_,
                   .ready = true,
                   .overruns = 4,
                   .late_p99_us = 31,
                   .note = {}});
    return observer_.state(now_us);
  }
  Sha256 seal_ = known_plan().seal;

 private:
  transport::Participant bus_;
  transport::Writer<SealedPlan> plans_{bus_};
  transport::Writer<Measurement> measurements_{bus_};
  transport::Writer<Decision> decisions_{bus_};
  transport::Writer<Health> health_{bus_};
  BusObserver observer_{bus_};
  std::uint32_t seq_ = 0;
};

std::string program() {
  return (fs::read_symlink("/proc/self/exe").parent_path() / "ros2_reader").string();
}

// The lines that begin with `what`.
std::vector<std::string> lines(const std::string& text, const std::string& what) {
  std::vector<std::string> found;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with(what + " ")) found.push_back(line);
  return found;
}

ProcessResult read_all(const RosSettings& settings, Robot& robot, const Measurement& measured, int patience_s,
                       const std::string& readers_enclave = {}) {
  StatePublisher publisher(settings, 7);
  std::vector<std::string> words{program(), std::to_string(settings.domain), std::to_string(patience_s)};
  if (!readers_enclave.empty()) words.push_back(readers_enclave);
  std::int64_t now_us = 1'000'000;
  return run_subprocess(words, {}, true, [&] {
    now_us += 100'000;
    publisher.publish(robot.tick(measured, now_us), now_us, kWall_ns);
  });
}

constexpr Measurement kMeasured{
    .depth_um = 12'345, .laser_valid = true, .monitor_mV = 2'500'000, .current_nA = 1'500};

TEST(Ros2Wire, AReaderOfRos2sOwnTypesGetsEveryTopicWithItsValues) {
  Robot robot(kBusDomain);
  const ProcessResult got = read_all({.domain = 93, .interface = {}, .enclave = {}}, robot, kMeasured, 20);
  ASSERT_EQ(got.exit_code, 0) << got.text;
  EXPECT_EQ(lines(got.text, "joint_states"),
            std::vector<std::string>{"joint_states frame='' sec=1700000000 names=1 name=needle positions=1 "
                                     "position=0.012345000 velocities=0 efforts=0"});
  EXPECT_EQ(lines(got.text, "depth"), std::vector<std::string>{"depth 0.012345000"});
  EXPECT_EQ(lines(got.text, "state"), std::vector<std::string>{"state active"});
  // By hand: the tip is at LPS (22.345, 20, 30) mm. Half a turn about z, then a quarter about y.
  EXPECT_EQ(
      lines(got.text, "pose"),
      std::vector<std::string>{"pose frame='scanner_ras' at -0.022345 -0.020000 0.030000 turn -0.707107 "
                               "0.000000 0.707107 0.000000"});
  EXPECT_NE(
      got.text.find("diagnostic 0 'biopsy: needle' 'measured' 'robot 7' depth [mm]=12.345; voltage monitor "
                    "[kV]=2.500; current monitor [uA]=1.500;"),
      std::string::npos)
      << got.text;
  EXPECT_NE(got.text.find("diagnostic 0 'biopsy: process stage' 'ready'"), std::string::npos) << got.text;
  EXPECT_NE(got.text.find("diagnostic 3 'biopsy: process controller' 'silent'"), std::string::npos)
      << got.text;
}

TEST(Ros2Wire, DiscoveryTellsWhatANodeOfRos2Tells) {
  Robot robot(kBusDomain);
  const ProcessResult got = read_all({.domain = 94, .interface = {}, .enclave = {}}, robot, kMeasured, 20);
  ASSERT_EQ(got.exit_code, 0) << got.text;
  const std::vector<std::pair<std::string, std::string>> topics{
      {"rt/joint_states", "sensor_msgs/JointState"},
      {"rt/needle/depth", "std_msgs/Float64"},
      {"rt/needle/state/pose", "geometry_msgs/PoseStamped"},
      {"rt/supervisor/state", "std_msgs/String"},
      {"rt/diagnostics", "diagnostic_msgs/DiagnosticArray"}};
  std::vector<std::string> gids;
  for (const auto& [topic, type] : topics) {
    const std::string package = type.substr(0, type.find('/')), name = type.substr(type.find('/') + 1);
    const auto writers = lines(got.text, "writer " + topic);
    ASSERT_EQ(writers.size(), 1U) << topic << "\n" << got.text;
    EXPECT_TRUE(writers[0].starts_with(fmt::format(
        "writer {} {}::msg::dds_::{}_ reliable volatile deadline=0 lifespan=0 liveliness=0,0 ownership=0 "
        "xtypes=0 typehash={}; ",
        topic, package, name, type_hash(package + "/msg/" + name))))
        << writers[0];
    gids.push_back(writers[0].substr(writers[0].rfind(' ') + 1));
  }
  const auto graph = lines(got.text, "writer ros_discovery_info");
  ASSERT_EQ(graph.size(), 1U);
  EXPECT_NE(graph[0].find("rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_ reliable transient_local"),
            std::string::npos);
  // The node owns these writers and no reader; its participant is one that was discovered, in the root
  // enclave.
  EXPECT_EQ(lines(got.text, "node"),
            std::vector<std::string>{fmt::format("node / biopsy readers=0 {}", fmt::join(gids, " "))});
  const auto info = lines(got.text, "participant_info");
  ASSERT_EQ(info.size(), 1U);
  const std::string participant = info[0].substr(info[0].find(' ') + 1);
  EXPECT_NE(got.text.find(fmt::format("participant {} enclave=/;", participant)), std::string::npos)
      << got.text;
}

TEST(Ros2Wire, TheProductSubscribesToNothing) {
  Robot robot(kBusDomain);
  const ProcessResult got = read_all({.domain = 95, .interface = {}, .enclave = {}}, robot, kMeasured, 20);
  ASSERT_EQ(got.exit_code, 0) << got.text;
  const std::string whole = lines(got.text, "participant_info").at(0);
  constexpr std::size_t kPrefix = 24;  // of a GUID, of its participant
  const std::string product = whole.substr(whole.find(' ') + 1, kPrefix);
  int readers = 0;  // ros2_reader's own
  for (const std::string& line : lines(got.text, "reader")) {
    ++readers;
    EXPECT_NE(line.substr(line.rfind(' ') + 1, kPrefix), product) << line;
  }
  EXPECT_GE(readers, 6);
}

TEST(Ros2Wire, WhatIsNotMeasuredIsNotPublished) {
  Robot robot(kBusDomain);
  Measurement invalid = kMeasured;
  invalid.laser_valid = false;
  const ProcessResult got = read_all({.domain = 93, .interface = {}, .enclave = {}}, robot, invalid, 4);
  EXPECT_EQ(got.exit_code, 1);
  EXPECT_EQ(lines(got.text, "joint_states").size() + lines(got.text, "depth").size() +
                lines(got.text, "pose").size(),
            0U);
  EXPECT_NE(got.text.find("diagnostic 2 'biopsy: needle'"), std::string::npos) << got.text;
}

TEST(Ros2Wire, APlanWhoseSealDoesNotHoldGivesNoPose) {
  Robot robot(kBusDomain);
  robot.seal_[3] ^= 1;
  const ProcessResult got = read_all({.domain = 94, .interface = {}, .enclave = {}}, robot, kMeasured, 4);
  EXPECT_TRUE(lines(got.text, "pose").empty()) << got.text;
  EXPECT_EQ(lines(got.text, "depth").size(), 1U) << got.text;
}

// Files as `ros2 security create_keystore` and `create_enclave` (SROS 2) lay them out and sign them, made
// with openssl.
class Keystore {
 public:
  Keystore() {
    scratch_.write("governance.xml", R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
<domain_access_rules><domain_rule><domains><id_range><min>0</min><max>230</max></id_range></domains>
<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>ENCRYPT</discovery_protection_kind><liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
<rtps_protection_kind>SIGN</rtps_protection_kind><topic_access_rules><topic_rule><topic_expression>*</topic_expression>
<enable_discovery_protection>true</enable_discovery_protection><enable_liveliness_protection>true</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control><enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>ENCRYPT</metadata_protection_kind><data_protection_kind>ENCRYPT</data_protection_kind>
</topic_rule></topic_access_rules></domain_rule></domain_access_rules></dds>
)");
    openssl("ecparam -name prime256v1 -genkey -noout -out {0}/ca.key.pem");
    openssl("req -x509 -new -key {0}/ca.key.pem -days 30 -sha256 -subj /CN=sros2CA -out {0}/ca.cert.pem");
    sign("governance.xml", "governance.p7s");
    make("biopsy");
    make("rviz");
  }
  fs::path enclave(const std::string& name) const { return scratch_ / "enclaves" / name; }

 private:
  static void openssl(const std::string& arguments, const fs::path& folder) {
    const std::string command =
        "openssl " + fmt::format(fmt::runtime(arguments), folder.string()) + " 2>/dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }
  void openssl(const std::string& arguments) const { openssl(arguments, scratch_.path()); }
  void sign(const std::string& document, const std::string& to) const {
    openssl("smime -sign -text -in {0}/" + document +
            " -signer {0}/ca.cert.pem -inkey {0}/ca.key.pem -out {0}/" + to);
  }
  void make(const std::string& name) const {
    const fs::path folder = enclave(name);
    fs::create_directories(folder);
    scratch_.write("permissions.xml", fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
<permissions><grant name="/{0}"><subject_name>CN=/{0}</subject_name>
<validity><not_before>2020-01-01T00:00:00</not_before><not_after>2060-01-01T00:00:00</not_after></validity>
<allow_rule><domains><id_range><min>0</min><max>230</max></id_range></domains>
<publish><topics><topic>*</topic></topics></publish><subscribe><topics><topic>*</topic></topics></subscribe></allow_rule>
<default>DENY</default></grant></permissions></dds>
)",
                                                  name));
    sign("permissions.xml", "enclaves/" + name + "/permissions.p7s");
    openssl("ecparam -name prime256v1 -genkey -noout -out {0}/key.pem", folder);
    openssl("req -new -key {0}/key.pem -subj '/CN=\\/" + name + "' -out {0}/request.pem", folder);
    openssl(
        "x509 -req -days 30 -sha256 -in {0}/request.pem -CA {0}/../../ca.cert.pem -CAkey "
        "{0}/../../ca.key.pem "
        "-CAcreateserial -out {0}/cert.pem",
        folder);
    for (const char* ca : {"identity_ca.cert.pem", "permissions_ca.cert.pem"})
      fs::copy_file(scratch_ / "ca.cert.pem", folder / ca);
    fs::copy_file(scratch_ / "governance.p7s", folder / "governance.p7s");
  }
  ScratchFolder scratch_;
};

TEST(Ros2Wire, AKeystoreOfRos2LetsInWhoHasItsKeysOnly) {
  const Keystore keystore;
  for (const char* folder :
       {"/usr/lib/x86_64-linux-gnu/libddsc0debian", "/usr/lib/aarch64-linux-gnu/libddsc0debian"})
    if (fs::is_directory(folder)) setenv("DDS_SECURITY_PLUGINS", folder, 1);
  Robot robot(kBusDomain);
  const RosSettings settings{.domain = 95, .interface = {}, .enclave = keystore.enclave("biopsy")};
  const ProcessResult got = read_all(settings, robot, kMeasured, 20, keystore.enclave("rviz").string());
  ASSERT_EQ(got.exit_code, 0) << got.text;
  EXPECT_EQ(lines(got.text, "depth"), std::vector<std::string>{"depth 0.012345000"});
  EXPECT_NE(got.text.find(" enclave=/biopsy;"), std::string::npos) << got.text;
  const ProcessResult without = read_all(settings, robot, kMeasured, 4);
  EXPECT_EQ(without.exit_code, 1);
  for (const char* what : {"depth", "state", "joint_states", "node"})
    EXPECT_TRUE(lines(without.text, what).empty()) << what;
}

TEST(Ros2Enclave, IsNamedByItsPlaceInTheKeystore) {
  EXPECT_EQ(enclave_user_data(""), "enclave=/;");
  EXPECT_EQ(enclave_user_data("/home/a/keystore/enclaves/lab/biopsy"), "enclave=/lab/biopsy;");
  EXPECT_EQ(enclave_user_data("/home/a/keys/"), "enclave=/;");
}

TEST(Ros2Enclave, AMissingFileIsNamed) {
  const ScratchFolder empty;
  try {
    const RosNode node({.domain = 96, .interface = {}, .enclave = empty.path()}, "biopsy");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("identity_ca.cert.pem"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace biopsy::ros2
