#include "robot/igtl/image_writer.hpp"

#include <utility>

namespace biopsy::igtl {
namespace {

constexpr std::size_t kWaitingMax_bytes = 268'435'456;

}  // namespace

ImageWriter::ImageWriter(const std::filesystem::path& folder)
    : folder_(folder), thread_([this](const std::stop_token& stop) { write_all(stop); }) {}

std::optional<Refused> ImageWriter::submit(Client client, const std::string& device, Image image) {
  const std::lock_guard guard(mutex_);
  const std::size_t bytes = image.voxels.size();
  if (job_bytes_ + bytes > kWaitingMax_bytes)
    return Refused{"other images are still being written: send it again"};
  job_bytes_ += bytes;
  jobs_.push_back({client, device, std::move(image)});
  came_.notify_one();
  return std::nullopt;
}

std::vector<ImageWriter::Written> ImageWriter::take_written() {
  const std::lock_guard guard(mutex_);
  return std::exchange(written_, {});
}

void ImageWriter::write_all(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (came_.wait(lock, stop, [this] { return !jobs_.empty(); })) {
    const Job& job = jobs_.front();  // stays where it is while others are added
    lock.unlock();
    Written written{job.client, job.device, folder_.store(job.device, job.image)};
    lock.lock();
    job_bytes_ -= job.image.voxels.size();
    jobs_.pop_front();
    written_.push_back(std::move(written));
  }
}

}  // namespace biopsy::igtl
