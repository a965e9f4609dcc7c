#include "robot/console/review/finished_run.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/console/review/run_log.hpp"
#include "robot/console/review/run_report.hpp"
#include "robot/console/review/run_table.hpp"
#include "robot/console/server/gzip.hpp"

namespace biopsy::console {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNoRun = "give the folder of a run that has ended: it holds report.json and run.csv";
constexpr const char* kPng = "\x89PNG\r\n\x1a\n";
constexpr std::size_t kName = 290;

static_assert(std::endian::native == std::endian::little, "the page reads little-endian numbers");

std::shared_ptr<const std::string> bytes_of(const std::vector<std::vector<double>>& columns) {
  auto bytes = std::make_shared<std::string>();
  for (const auto& column : columns)
    bytes->append(reinterpret_cast<const char*>(column.data()), column.size() * sizeof(double));
  return bytes;
}

// The slices along the needle that the report wrote beside itself.
void add_pictures(const fs::path& folder, const std::string& base, review::ConfirmationImage& image,
                  std::map<std::string, Document>& to) {
  for (const char* which : {"before", "after", "difference"}) {
    const std::string name = fmt::format("stage-{}-{}.png", image.step, which);
    if (!fs::is_regular_file(folder / name)) continue;
    const auto bytes = std::make_shared<const std::string>(read_file(folder / name));
    if (!bytes->starts_with(kPng))
      throw ConfigError("is not a PNG picture", (folder / name).string(), kNoRun);
    to[base + name] = {"image/png", bytes};
    image.pictures.push_back(name);
  }
}

review::FinishedRun add_run(const fs::path& given, const std::string& base,
                            std::map<std::string, Document>& to) {
  std::error_code trouble;
  const fs::path folder = fs::canonical(given, trouble);
  if (trouble || !fs::is_directory(folder))
    throw ConfigError("there is no such folder", given.string(), kNoRun);
  const fs::path report_file = folder / "report.json", table_file = folder / "run.csv";
  for (const fs::path& file : {report_file, table_file})  // a device may never end
    if (fs::exists(file) && !fs::is_regular_file(file))
      throw ConfigError("is not a file", file.string(), kNoRun);
  RunReport report = parse_run_report(read_file(report_file, kNoRun), report_file.string());
  RunTable table = parse_run_table(read_file(table_file, kNoRun), table_file.string());
  const double end_s = table.values.front().back();
  RunLog log = read_run_log(folder, table.spans, end_s);
  for (review::ConfirmationImage& image : report.images) add_pictures(folder, base, image, to);
  to[base + "samples"] = {"application/octet-stream", bytes_of(table.values)};
  if (fs::is_regular_file(folder / "report.html")) {
    Document document{"text/html; charset=utf-8",
                      std::make_shared<const std::string>(read_file(folder / "report.html"))};
    document.self_contained = true;
    to[base + "report.html"] = document;
  }
  review::FinishedRun run;
  run.folder = shortened(plain(given.string()), kName);
  run.title = std::move(report.title);
  run.outcome = std::move(report.outcome);
  run.verdict = std::move(report.verdict);
  run.simulated = report.simulated;
  run.seed = std::move(report.seed);
  run.rows = static_cast<std::uint32_t>(table.values.front().size());
  run.columns = std::move(table.columns);
  run.spans = std::move(table.spans);
  run.hazards = std::move(report.hazards);
  run.images = std::move(report.images);
  run.log_note = std::move(log.note);
  run.log = std::move(log.entries);
  return run;
}

}  // namespace

std::map<std::string, Document> review_documents(const std::vector<fs::path>& folders) {
  std::map<std::string, Document> documents;
  review::Runs all;
  for (const fs::path& folder : folders)
    all.runs.push_back(add_run(folder, fmt::format("/run/{}/", all.runs.size()), documents));
  const auto body = std::make_shared<const std::string>(nlohmann::json(all).dump());
  documents["/runs"] = {"application/json", body, false, std::make_shared<const std::string>(gzip(*body))};
  return documents;
}

}  // namespace biopsy::console
