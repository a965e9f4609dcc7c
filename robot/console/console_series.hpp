// The image series that a person may open at the console: that of the case, and whatever lies beside it.
// Another one takes seconds to read, so that it is read beside the loop.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "robot/msg/console_messages.hpp"
#include "robot/procedure/prepared_case.hpp"

namespace biopsy::robot {

class ConsoleSeries {
 public:
  // Looks at the headers of all that lies beside the image of `opened`.
  explicit ConsoleSeries(const PreparedCase& opened);

  // For a person to choose from; the case's own first. One that cannot be opened says why.
  const std::vector<console::events::Series>& all() const { return all_; }
  // Begins to read. Otherwise why not.
  std::optional<std::string> begin(const std::string& series_uid);
  // What is being read now; empty: nothing.
  const std::string& reading() const { return reading_; }
  // What has been read, once; a series that turned out unfit has its reason in all() instead.
  std::optional<Volume> take();
  // Rises with every change of all().
  std::uint32_t version() const { return version_; }

  // The volume that is open, for the page: a file, and a name that no other one had.
  const std::shared_ptr<const std::string>& file() const { return file_; }
  std::string file_name() const;

 private:
  struct Read {
    Volume image;
    std::shared_ptr<const std::string> file;
  };
  using Outcome = std::variant<Read, std::string>;  // or what is wrong with it

  static Outcome read(const std::filesystem::path& folder, const std::string& series_uid,
                      const SeriesIdentity& of_case);
  console::events::Series* find(const std::string& series_uid);

  std::filesystem::path folder_;
  SeriesIdentity of_case_;
  std::vector<console::events::Series> all_;
  std::string reading_;
  std::future<Outcome> outcome_;
  std::shared_ptr<const std::string> file_;
  std::uint32_t version_ = 0, files_ = 0;
};

}  // namespace biopsy::robot
