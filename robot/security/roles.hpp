// Who may write what on the bus. The one table from which permissions are made and against which they are
// checked; everybody here may read every topic, nobody else may read or write anything.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace biopsy::security {

// One identity each. Planner is the program `biopsy`, which plans, starts and rehearses; an Observer only
// reads.
enum class Role : std::uint8_t { Stage, Controller, Supervisor, Recorder, Console, Planner, Observer };

inline constexpr std::array kRoles{Role::Stage,   Role::Controller, Role::Supervisor, Role::Recorder,
                                   Role::Console, Role::Planner,    Role::Observer};

// As in certificates and names of folders.
constexpr std::string_view name_of(Role role) {
  switch (role) {
    case Role::Stage:
      return "stage";
    case Role::Controller:
      return "controller";
    case Role::Supervisor:
      return "supervisor";
    case Role::Recorder:
      return "recorder";
    case Role::Console:
      return "console";
    case Role::Planner:
      return "planner";
    case Role::Observer:
      return "observer";
  }
  return {};
}

namespace topic {
inline constexpr std::string_view kMeasurement = "Measurement";
inline constexpr std::string_view kDriveRequest = "DriveRequest";
inline constexpr std::string_view kPermit = "Permit";
inline constexpr std::string_view kDecision = "Decision";
inline constexpr std::string_view kOperatorAct = "OperatorAct";
inline constexpr std::string_view kSealedPlan = "SealedPlan";
inline constexpr std::string_view kDepthVerdict = "DepthVerdict";
inline constexpr std::string_view kLogHealth = "LogHealth";
inline constexpr std::string_view kStageTruth = "StageTruth";
inline constexpr std::string_view kHealth = "Health";
}  // namespace topic

// A set of roles.
class Writers {
 public:
  template <class... Some>
  explicit constexpr Writers(Some... some) : bits_((bit(some) | ...)) {}
  constexpr bool contains(Role role) const { return (bits_ & bit(role)) != 0; }

 private:
  static constexpr unsigned bit(Role role) { return 1U << static_cast<unsigned>(role); }
  unsigned bits_;
};

// Nobody without keys may alter a sample, ever. Samples of a tick tell volts and millimetres of a needle,
// nothing of a person, and each costs every reader time that the next tick needs: they are not hidden too.
enum class Protection : std::uint8_t { Signed, SignedAndEncrypted };

struct TopicRule {
  std::string_view topic;
  Writers writers;
  Protection sample = Protection::SignedAndEncrypted;
};

inline constexpr std::array kTopicRules{
    TopicRule{topic::kMeasurement, Writers(Role::Stage), Protection::Signed},
    TopicRule{topic::kDriveRequest, Writers(Role::Controller), Protection::Signed},
    TopicRule{topic::kPermit, Writers(Role::Supervisor), Protection::Signed},
    TopicRule{topic::kDecision, Writers(Role::Supervisor), Protection::Signed},
    TopicRule{topic::kOperatorAct, Writers(Role::Console, Role::Planner)},
    TopicRule{topic::kSealedPlan, Writers(Role::Planner, Role::Console)},
    TopicRule{topic::kDepthVerdict, Writers(Role::Planner, Role::Console)},
    TopicRule{topic::kLogHealth, Writers(Role::Recorder)},
    TopicRule{topic::kStageTruth, Writers(Role::Stage), Protection::Signed},
    TopicRule{topic::kHealth, Writers(Role::Stage, Role::Controller, Role::Supervisor, Role::Recorder,
                                      Role::Console, Role::Planner)},
};

constexpr bool may_write(Role role, std::string_view topic) {
  for (const TopicRule& rule : kTopicRules)
    if (rule.topic == topic) return rule.writers.contains(role);
  return false;
}

}  // namespace biopsy::security
