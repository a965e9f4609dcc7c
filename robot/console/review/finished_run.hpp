// A folder with a finished run, opened for the review page: everything is read before the page is served.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "robot/console/server/http_server.hpp"

namespace biopsy::console {

inline constexpr std::size_t kReviewedRunsMax = 2;

// What a server with `folders` answers, by path: /runs, /run/N/samples, /run/N/report.html and the pictures,
// N from 0. Reads the folders and changes nothing in them. Throws ConfigError: no such folder, no finished
// run in it, a file that is not as the program writes it.
std::map<std::string, Document> review_documents(const std::vector<std::filesystem::path>& folders);

}  // namespace biopsy::console
