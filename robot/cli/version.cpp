#include "robot/cli/version.hpp"

#include <ceres/version.h>
#include <dcmtk/config/osconfig.h>
#include <dds/version.h>
#include <fmt/format.h>
#include <openssl/crypto.h>
#include <spdlog/version.h>
#include <sqlite3.h>

#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <opencv2/core/version.hpp>

#include "robot/cli/commit.hpp"  // generated at each build

namespace biopsy::robot {

std::string version_text() {
  return fmt::format(
      "biopsy {}\ncommit {}\nlibraries: Ceres {}, CLI11 {}, Cyclone DDS {}, DCMTK {}, Eigen {}.{}.{}, fmt "
      "{}.{}.{}, "
      "OpenCV {}, OpenSSL {}, spdlog {}.{}.{}, SQLite {}\n",
      BIOPSY_VERSION, BIOPSY_COMMIT, CERES_VERSION_STRING, CLI11_VERSION, DDS_VERSION, PACKAGE_VERSION,
      EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION, FMT_VERSION / 10000,
      FMT_VERSION / 100 % 100, FMT_VERSION % 100, CV_VERSION, OpenSSL_version(OPENSSL_VERSION_STRING),
      SPDLOG_VER_MAJOR, SPDLOG_VER_MINOR, SPDLOG_VER_PATCH, sqlite3_libversion());
}

}  // namespace biopsy::robot
