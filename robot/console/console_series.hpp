// The image series that can be opened at the console: that of the case, and all others of its folder. Reading
// one takes seconds, so it is done in another thread.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "robot/msg/console_messages.hpp"
#include "robot/procedure/case/prepared_case.hpp"

namespace biopsy::robot {

class ConsoleSeries {
 public:
  // Reads the headers of all files in the folder of `opened`.
  explicit ConsoleSeries(const PreparedCase& opened);

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

  static Outcome read(const std::filesystem::path& folder, const std::string& series_uid,
                      const SeriesIdentity& of_case);
  console::events::Series* find(const std::string& series_uid);

  std::filesystem::path folder_;
  SeriesIdentity of_case_;
  std::vector<console::events::Series> all_;
  std::string reading_;
  std::future<Outcome> outcome_;
  std::shared_ptr<const std::string> file_, labels_;
  std::uint32_t version_ = 0, files_ = 0;
};

}  // namespace biopsy::robot
