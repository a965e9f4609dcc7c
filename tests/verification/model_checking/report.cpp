#include "report.hpp"

#include <fstream>

#include "robot/common/config_error.hpp"

namespace biopsy::explore {

void write(const Report& report, std::string_view tool, const std::filesystem::path& file) {
  const nlohmann::ordered_json whole{
      {"tool", tool}, {"passed", report.passed}, {"figures", report.figures}, {"tables", report.tables}};
  const std::filesystem::path part = file.string() + ".part";
  std::ofstream stream(part);
  stream << whole.dump(2) << '\n';
  stream.close();
  std::error_code failed;
  if (stream) std::filesystem::rename(part, file, failed);
  if (!stream || failed)
    throw ConfigError("cannot be written", file.string(),
                      "name a file in a folder that exists and may be written");
}

}  // namespace biopsy::explore
