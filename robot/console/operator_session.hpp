// The operator at the console, as the robot's side sees them: what the page asked for becomes the World of
// the next tick, what the robot answers becomes what the page is told. Decides nothing about motion: that is
// the supervisor's.
#pragma once

#include <array>
#include <console_messages.hpp>  // generated from robot/msg/console.idl
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
#include "robot/procedure/confirmation_image.hpp"
#include "robot/procedure/run_notes.hpp"

namespace biopsy::robot {

class OperatorSession {
 public:
  using SendPlan = std::function<void(const Plan&, const std::array<std::uint64_t, 2>& confirmed)>;

  // `opened`: the case with its image. `folder` gets a folder for each run. Keys are turned here only where
  // the stage is `simulated`. `first_token`: above that of every console before.
  OperatorSession(PreparedCase opened, bool simulated, std::filesystem::path folder,
                  std::uint32_t first_token, SendPlan send_plan);
  ~OperatorSession();

  // Pages. Who comes first controls, all others watch.
  void came(console::Client client) { lease_.take(client); }
  void left(console::Client client);
  // The answer; none to beats and releases.
  std::optional<console::events::Answer> ask(console::Client client, const console::commands::Any& asked,
                                             std::int64_t now_us);

  // Robot
  World world(std::int64_t now_us);
  void see(const CycleSample& beat, std::int64_t now_us);
  void miss() { silent_ = true; }  // no tick for a second

  // What pages are told
  console::events::State state(console::Client client, std::int64_t now_us);
  std::optional<console::events::Opened> opened() const;
  console::events::Planned planned() const;
  // Of every stage whose image was checked in this run.
  std::vector<console::events::Checked> checked() const;
  // Rises with each change of one of the three above.
  std::uint32_t version() const { return version_; }
  const ConsoleSeries& series() const { return series_; }
  const PreparedCase& prepared() const { return prepared_; }
  // Of the last run that ended; empty: none yet.
  const std::filesystem::path& report() const { return report_; }

 private:
  struct Run;
  using Answer = std::optional<console::events::Answer>;

  // One for each message of module `commands`, in clinician_asks.cpp.
  Answer on(console::Client client, const console::commands::TakeControl& asked);
  Answer on(const console::commands::OpenSeries& asked);
  Answer on(const console::commands::SetPoint& asked);
  Answer on(const console::commands::ConfirmPlan& asked);
  Answer on(const console::commands::SetTick& asked);
  Answer on(const console::commands::Press& asked);
  Answer on(const console::commands::Stop& asked);
  Answer on(const console::commands::Retract& asked);
  Answer on(const console::commands::Reset& asked);
  Answer on(const console::commands::Judge& asked);

  const Plan* plan() const;
  bool is_shown(const std::string& seal) const;
  void unconfirm();
  void send_confirmations();
  bool all_ticked() const { return ticks_ == std::array{true, true, true}; }
  void show_series();
  void follow_run(const CycleSample& beat, Mode before);
  void follow_image();
  void let_back();
  void end_run();
  console::Step step() const;
  console::events::Disabled disabled() const;
  std::string why_no_arm() const;
  std::string why_no_insert() const;
  std::string why_no_judgement() const;
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
  Target proposed_;  // what the case names
  bool opened_ = false, confirmed_ = false, announced_ = false, confirmations_due_ = false;
  std::optional<Point> p_SE_, p_ST_;
  std::array<bool, 3> ticks_{};
  std::int64_t ticked_us_ = 0;

  World world_;
  CycleRecord seen_;
  bool measured_ = false, silent_ = false;
  std::int64_t now_us_ = 0, mode_since_us_ = 0;
  std::int64_t arm_until_us_ = 0, reset_until_us_ = 0, stop_until_us_ = 0, retract_until_us_ = 0;
  bool stopped_ = false, finish_ = false, adjusts_ = false;
  std::shared_ptr<Run> run_;  // the present one or the last
  std::uint32_t version_ = 1, seq_ = 0, runs_ = 0;
  std::filesystem::path report_;
  std::future<void> reporting_;
};

}  // namespace biopsy::robot
