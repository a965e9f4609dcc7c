#include "robot/console/kept_points.hpp"

#include <sstream>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/console/server/command_from_json.hpp"

namespace biopsy::robot {

namespace {

template <class Command>
std::string line_of(const Command& command) {
  nlohmann::json json = command;
  json["type"] = Command::kType;
  return json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace

void KeptPoints::restore(OperatorSession& session) {
  kept_ = read_file_if_present(file_);
  std::istringstream lines(kept_);
  std::vector<console::commands::Any> commands;
  try {
    for (std::string line; std::getline(lines, line);) commands.push_back(console::command_from_json(line));
  } catch (const console::MessageFault&) {
    return;
  }
  session.restore(commands);
}

void KeptPoints::update(const OperatorSession& session) {
  std::string lines;
  if (const auto series = session.chosen_series()) lines += line_of(*series);
  for (const console::commands::SetPoint& point : session.chosen_points()) lines += line_of(point);
  if (session.stop_stands()) lines += line_of(console::commands::Stop{});
  if (lines == kept_) return;
  atomic_write(file_, lines);
  kept_ = std::move(lines);
}

}  // namespace biopsy::robot
