#include "robot/cli/library_messages.hpp"

#include <dcmtk/oflog/appender.h>
#include <dcmtk/oflog/logger.h>
#include <dcmtk/oflog/oflog.h>
#include <dcmtk/oflog/spi/logevent.h>
#include <glog/logging.h>

#include <opencv2/core.hpp>

#include "robot/common/logging/logger.hpp"

namespace biopsy::robot {
namespace {

using logging::Component;
using logging::Level;

class GlogSink final : public google::LogSink {
 public:
  void send(google::LogSeverity severity, const char*, const char*, int, const struct ::tm*,
            const char* message, std::size_t size) override {
    // What it warns of is a step of a search that it repeats by itself.
    const Level level = severity >= google::ERROR     ? Level::Error
                        : severity == google::WARNING ? Level::Info
                                                      : Level::Debug;
    logging::write(Component::Ceres, level, {message, size});
  }
};

void log_ceres() {
  static GlogSink sink;
  google::InitGoogleLogging("biopsy");
  for (const auto severity : {google::INFO, google::WARNING, google::ERROR, google::FATAL})
    google::SetLogDestination(severity, "");  // no file
  FLAGS_stderrthreshold = google::NUM_SEVERITIES;
  google::AddLogSink(&sink);
}

class DcmtkAppender final : public dcmtk::log4cplus::Appender {
 public:
  ~DcmtkAppender() override { destructorImpl(); }
  void close() override {}

 protected:
  void append(const dcmtk::log4cplus::spi::InternalLoggingEvent& event) override {
    const auto severity = event.getLogLevel();
    const Level level = severity >= dcmtk::log4cplus::ERROR_LOG_LEVEL  ? Level::Error
                        : severity >= dcmtk::log4cplus::WARN_LOG_LEVEL ? Level::Warning
                                                                       : Level::Debug;
    const auto& message = event.getMessage();
    logging::write(Component::Dcmtk, level, {message.data(), message.size()});
  }
};

void log_dcmtk() {
  dcmtk::log4cplus::Logger root = dcmtk::log4cplus::Logger::getRoot();
  root.removeAllAppenders();
  root.addAppender(dcmtk::log4cplus::SharedAppenderPtr(new DcmtkAppender));
  root.setLogLevel(dcmtk::log4cplus::WARN_LOG_LEVEL);
}

// Called just before the exception is thrown, which holds the same text.
int log_opencv_error(int, const char* function, const char* message, const char*, int, void*) {
  logging::write(Component::Opencv, Level::Debug, fmt::format("{}: {}", function, message));
  return 0;
}

}  // namespace

void log_library_messages() {
  log_ceres();
  log_dcmtk();
  cv::redirectError(log_opencv_error);
}

}  // namespace biopsy::robot
