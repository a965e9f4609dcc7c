// Writes images into the folder in a thread of its own: a large one takes a second, and no STOP waits for it.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "robot/igtl/image_folder.hpp"
#include "robot/igtl/server.hpp"

namespace biopsy::igtl {

class ImageWriter {
 public:
  struct Written {
    Client client = 0;
    std::string device;
    std::variant<std::string, Refused> result;  // of ImageFolder::store
  };

  // Empty: images are refused. Throws ConfigError where the folder does not exist.
  explicit ImageWriter(const std::filesystem::path& folder);

  // Refused at once where too many wait already.
  std::optional<Refused> submit(Client client, const std::string& device, Image image);
  // What became of them since the last call.
  std::vector<Written> take_written();

 private:
  struct Job {
    Client client;
    std::string device;
    Image image;
  };
  void write_all(const std::stop_token& stop);

  ImageFolder folder_;  // of the thread alone
  std::mutex mutex_;
  std::condition_variable_any came_;
  std::deque<Job> jobs_;       // the first is being written
  std::size_t job_bytes_ = 0;  // of all of them
  std::vector<Written> written_;
  std::jthread thread_;  // last
};

}  // namespace biopsy::igtl
