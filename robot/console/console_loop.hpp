// Connects the console pages to the robot: one thread follows the robot tick by tick, the web server's thread
// the pages.
#pragma once

#include <map>
#include <mutex>
#include <set>
#include <string>

#include "robot/console/kept_points.hpp"
#include "robot/console/navigation_link.hpp"
#include "robot/console/operator_session.hpp"
#include "robot/console/server/alarm_history.hpp"
#include "robot/console/server/http_server.hpp"
#include "robot/console/server/telemetry_batch.hpp"
#include "robot/console/shown_state.hpp"
#include "robot/live/session/live_robot.hpp"

namespace biopsy::robot {

class ConsoleLoop {
 public:
  struct Settings {
    std::filesystem::path page, folder;  // the built page; for commands, images and reports
    std::uint16_t port = 0;              // 0: any that is free
    bool simulated = true;
    std::uint32_t first_token = 1;
    std::string token;                // of the address; empty: a new one
    std::filesystem::path kept = {};  // folder of what outlives this start of the console
  };
  // `robot` and `navigation` must outlive this. Throws ConfigError.
  ConsoleLoop(LiveRobot& robot, NavigationLink& navigation, PreparedCase opened, const Settings& settings);

  std::string url() const { return server_->url(); }
  // Processes one tick of the robot, or a second without one.
  void step();

 private:
  void on_connect(console::Client client);
  void on_message(console::Client client, const std::string& text);
  void on_disconnect(console::Client client);
  std::optional<console::Document> document(const std::string& path);
  void send_states(std::int64_t now_us);
  void send_changes();
  void send_alarms();
  void keep_points();
  void log_command(console::Client client, const std::string& text, const std::string& answer);

  LiveRobot& robot_;
  NavigationLink& navigation_;
  Settings settings_;
  std::mutex mutex_;  // of the session and the record of what was sent
  OperatorSession session_;
  console::AlarmHistory alarms_;
  KeptPoints points_;
  std::map<console::Client, ShownState> sent_;  // to each page
  std::set<console::Client> new_clients_;
  std::uint32_t sent_version_ = 0, sent_series_ = 0, sent_alarms_ = 0;
  console::TelemetryBatch batch_;
  std::int64_t ticks_ = 0;
  std::unique_ptr<console::HttpServer> server_;  // last: it calls into all the others
};

}  // namespace biopsy::robot
