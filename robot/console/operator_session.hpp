// The operator at the console: commands of the page become the operator inputs of the next tick, the robot's
// state becomes events for the page. Decides nothing about motion: the supervisor does.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot/console/console_series.hpp"
#include "robot/console/server/hold_to_run.hpp"
#include "robot/console/server/lease.hpp"
#include "robot/console/shown_depth.hpp"
#include "robot/msg/console_messages.hpp"
#include "robot/procedure/images/confirmation_image.hpp"
#include "robot/procedure/run_notes.hpp"

namespace biopsy::robot {

class OperatorSession {
 public:
  using SendPlan = std::function<void(const Plan&, const std::array<std::uint64_t, 2>& confirmed)>;

  // `opened`: the case with its image. `folder` gets a folder for each run. Keys are turned here only where
  // the stage is `simulated`. `first_token`: above that of every earlier console.
  OperatorSession(PreparedCase opened, bool simulated, std::filesystem::path folder,
                  std::uint32_t first_token, SendPlan send_plan);
  ~OperatorSession();

  // Pages. The first one controls, all others watch.
  void connect(console::Client client) { lease_.take(client); }
  void disconnect(console::Client client);
  // The answer; none to heartbeats and releases.
  std::optional<console::events::Answer> handle(console::Client client, const console::commands::Any& command,
                                                std::int64_t now_us);

  // A navigation program: its points are planned to and shown, for a person to confirm; its stop is one. Call
  // in every tick with its newest request, or with nothing where none is there. seq of the reply is the
  // sender's.
  NavigationReply navigate(const std::optional<NavigationRequest>& request, std::int64_t now_us);

  // Robot
  OperatorInputs inputs(std::int64_t now_us);
  void update(const CycleSample& sample, std::int64_t now_us);
  void mark_silent() { silent_ = true, undisturbed_ = false; }  // no tick for a second

  // Over a restart of the console. The series that a person opened and the points that are planned with the
  // case's own registration; what is restored is not confirmed.
  std::optional<console::commands::OpenSeries> chosen_series() const;
  std::vector<console::commands::SetPoint> chosen_points() const;
  // STOP was pressed without high voltage, and no Reset since.
  bool stop_stands() const { return standing_stop_; }
  void restore(const std::vector<console::commands::Any>& chosen);

  // Events for the pages
  std::vector<console::events::Alarm> alarms() const;
  bool is_controlled_by(console::Client client) const { return lease_.is_held_by(client); }
  console::events::State state(console::Client client, std::int64_t now_us);
  std::optional<console::events::Opened> opened() const;
  console::events::Planned planned() const;
  // Of every step whose image was checked in this run.
  std::vector<console::events::Checked> checked() const;
  // Increases with each change of one of the three above.
  std::uint32_t version() const { return version_; }
  const ConsoleSeries& series() const { return series_; }
  const PreparedCase& prepared() const { return prepared_; }
  // Of the last run that ended; empty: none yet.
  // Returns once no image is being checked and no report written; the next update() or state() has the
  // result.
  void wait_for_results() const;
  const std::filesystem::path& report() const { return report_; }

 private:
  struct Run;
  using Answer = std::optional<console::events::Answer>;

  // One for each command, in operator_commands.cpp.
  Answer on(console::Client client, const console::commands::TakeControl& command);
  Answer on(const console::commands::OpenSeries& command);
  Answer on(const console::commands::SetPoint& command);
  Answer on(const console::commands::ConfirmPlan& command);
  Answer on(const console::commands::SetTick& command);
  Answer on(const console::commands::RenewChecks& command);
  Answer on(const console::commands::Press& command);
  Answer on(const console::commands::Stop& command);
  Answer on(const console::commands::Retract& command);
  Answer on(const console::commands::Reset& command);
  Answer on(const console::commands::Judge& command);

  void take_stop(const NavigationRequest& request);
  void take_proposal(const NavigationRequest& request);
  std::string plan_proposal(const NavigationRequest& request);
  void restore_pose();
  bool shows_proposal() const;
  std::vector<console::events::Alarm> navigation_alarms() const;

  const Plan* plan() const;
  bool is_displayed(const std::string& seal) const;
  void unconfirm();
  void send_confirmations();
  bool all_ticked() const { return ticks_ == std::array{true, true, true}; }
  Answer why_no_check(std::uint32_t id, const std::string& seal) const;
  bool carries_checks() const;
  void show_series();
  void update_run(const CycleSample& sample, Mode before);
  void note_end_of_hold(Mode before);
  bool is_patient_moving() const;
  void begin_image(std::size_t step);
  void begin_scan();
  void take_image(std::size_t step);
  void update_image();
  void retract();
  void end_run();
  console::Step step() const;
  console::events::Disabled disabled() const;
  std::string why_second_person() const;
  std::string why_no_arm() const;
  std::string why_no_insert() const;
  std::string why_no_judgement() const;
  std::string why_no_acceptance() const;
  std::string why_no_reset() const;
  bool hv_permitted() const;

  bool simulated_;
  std::filesystem::path folder_;
  SendPlan send_plan_;
  console::Lease lease_;
  console::HoldToRun hold_;
  console::Button button_ = console::Button::Insert;  // of the present press
  std::uint32_t last_token_ = 0;                      // of the last press to insert

  PreparedCase prepared_;
  ConsoleSeries series_;
  Target proposed_;  // of the case
  bool opened_ = false, confirmed_ = false, announced_ = false, confirmations_due_ = false;
  std::optional<Point> p_SE_, p_ST_;
  std::vector<console::commands::SetPoint> restored_;  // for the series that is being read
  std::array<bool, 3> ticks_{};
  std::int64_t ticked_us_ = 0;  // the last of the three
  // Since the last arming nothing happened after which Patient or Risks, as ticked for it, might no longer
  // hold: another series, another page in control, a stop, a trip, silence.
  bool undisturbed_ = false;

  std::optional<NavigationRequest> navigation_;  // newest, of a program that is there
  std::uint32_t proposal_ = 0;                   // of it, taken last
  std::string proposal_refused_;                 // why there is no plan to it
  Sha256 proposal_seal_{};
  struct Pose {
    std::filesystem::path fiducials;
    std::optional<std::vector<double>> transform;
  };
  std::optional<Pose> own_pose_;  // of the case, while the navigation program's is in its place

  OperatorInputs inputs_ = OperatorInputs::idle();
  CycleRecord seen_;
  ShownDepth shown_depth_;
  bool measured_ = false, silent_ = false;
  bool held_too_long_ = false;  // in the tick before, by this clock
  std::int64_t now_us_ = 0, mode_since_us_ = 0;
  std::int64_t arm_until_us_ = 0, reset_until_us_ = 0, stop_until_us_ = 0, retract_until_us_ = 0;
  std::int32_t patient_motion_um_ = 0;  // since the plan's image, by the newest image that tells
  bool stopped_ = false, finish_ = false, adjusts_ = false;
  // STOP while no high voltage was on: a request that stands until Reset takes it back. (Under voltage the
  // supervisor itself latches, as Trip.)
  bool standing_stop_ = false;
  std::shared_ptr<Run> run_;  // the present one or the last
  std::uint32_t version_ = 1, seq_ = 0, runs_ = 0;
  std::filesystem::path report_;
  std::future<void> reporting_;
};

}  // namespace biopsy::robot
