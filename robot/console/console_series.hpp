// The image series that can be opened at the console: that of the case, all others of its folder, and those
// that came into the watched folder since. Reading one takes seconds, so it is done in another thread.
#pragma once

#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "planner/imaging/io/watched_folder.hpp"
#include "robot/msg/console_messages.hpp"
#include "robot/procedure/case/prepared_case.hpp"

namespace biopsy::robot {

class ConsoleSeries {
 public:
  // Reads the headers of all files in the folder of `opened`. Throws ConfigError where its watched folder
  // does not exist.
  explicit ConsoleSeries(const PreparedCase& opened);

  // Call often: lists what came into the watched folder, once it is whole. One that names another patient,
  // or none while no person answers for such images, cannot be opened.
  void look(std::int64_t now_us);

  // The case's own first. One that cannot be opened has the reason.
  const std::vector<console::events::Series>& all() const { return all_; }
  // Starts to read; otherwise the reason why not.
  std::optional<std::string> begin(const std::string& series_uid);
  // The series being read; empty: none.
  const std::string& reading() const { return reading_; }
  // The image that was read, once; an unsuitable series has its reason in all() instead.
  std::optional<Volume> take();
  // Increases with every change of all().
  std::uint32_t version() const { return version_; }

  // The open volume for the page: a file, and a name that is never reused.
  const std::shared_ptr<const std::string>& file() const { return file_; }
  std::string file_name() const;
  // The case's label map in the same way; no file: it has none.
  const std::shared_ptr<const std::string>& labels() const { return labels_; }
  static constexpr const char* kLabelsName = "/labels.nii";

 private:
  struct Read {
    Volume image;
    std::shared_ptr<const std::string> file;
  };
  using Outcome = std::variant<Read, std::string>;  // or the reason for refusing it

  struct Received {
    imaging::IncomingSeries files;
    console::events::Series series;
  };

  static Outcome read(const std::function<Volume()>& load, const std::string& series_uid,
                      const SeriesIdentity& of_case);
  std::optional<Received> poll();  // in another thread
  void add(Received received);
  console::events::Series* find(const std::string& series_uid);

  std::filesystem::path folder_;
  SeriesIdentity of_case_;
  std::string patient_id_, confirmed_by_;  // of the case; who answers for images without a patient
  std::optional<imaging::WatchedFolder> watched_;
  std::future<std::optional<Received>> coming_;
  std::map<std::string, imaging::IncomingSeries> received_;  // by their series_uid in all_
  std::int64_t looked_us_ = 0;
  std::vector<console::events::Series> all_;
  std::string reading_;
  std::future<Outcome> outcome_;
  std::shared_ptr<const std::string> file_, labels_;
  std::uint32_t version_ = 0, files_ = 0;
};

}  // namespace biopsy::robot
