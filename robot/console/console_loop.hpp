// Joins the operator's console page to the robot: one thread follows the robot tick by tick, the web server's
// the pages.
#pragma once

#include <map>
#include <mutex>
#include <set>
#include <string>

#include "robot/console/operator_session.hpp"
#include "robot/console/server/http_server.hpp"
#include "robot/console/server/telemetry_batch.hpp"
#include "robot/live/session/live_robot.hpp"

namespace biopsy::robot {

class ConsoleLoop {
 public:
  struct Settings {
    std::filesystem::path page, folder;  // the built page; where acts, images and reports go
    std::uint16_t port = 0;              // 0: any that is free
    bool simulated = true;
    std::uint32_t first_token = 1;
  };
  // `robot` must outlive this. Throws ConfigError.
  ConsoleLoop(LiveRobot& robot, PreparedCase opened, const Settings& settings);

  std::string url() const { return server_->url(); }
  // One tick of the robot, or a second without.
  void turn();

 private:
  void came(console::Client client);
  void said(console::Client client, const std::string& text);
  void left(console::Client client);
  std::optional<console::Document> document(const std::string& path);
  void tell_states(std::int64_t now_us);
  void tell_news();
  void note_act(console::Client client, const std::string& text, const std::string& answer);

  LiveRobot& robot_;
  Settings settings_;
  std::mutex mutex_;  // over the session and what pages were told
  OperatorSession session_;
  std::map<console::Client, std::string> told_;  // last State of each page, without what always changes
  std::set<console::Client> newcomers_;
  std::uint32_t told_version_ = 0, told_series_ = 0;
  console::TelemetryBatch batch_;
  std::int64_t ticks_ = 0, states_us_ = 0;
  std::unique_ptr<console::HttpServer> server_;  // last: it calls into all the others
};

}  // namespace biopsy::robot
