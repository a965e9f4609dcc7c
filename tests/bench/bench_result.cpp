#include "tests/bench/bench_result.hpp"

#include <fmt/format.h>
#include <stdlib.h>
#include <time.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"

namespace biopsy::bench {
namespace {

constexpr double kTick_ns = 1e6;
constexpr double kMostOfEarlier = 1.25;  // a fifth of the speed lost

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

double load() {
  double minute = -1.0;
  return getloadavg(&minute, 1) == 1 ? minute : -1.0;
}

}  // namespace

double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

void BenchResult::add(Figure figure) {
  fmt::print("{:<52}{:>10.1f}{:>12.0f}  {}\n", figure.what, figure.ns, kTick_ns / figure.ns, figure.remark);
  figures_.push_back(std::move(figure));
}

double BenchResult::ratio(const Figure& figure) const {
  const auto peer =
      std::find_if(figures_.begin(), figures_.end(), [&](const Figure& one) { return one.name == peer_; });
  if (peer == figures_.end())
    throw ConfigError("no peer was measured in this run", peer_, "install libsundials-dev and build again");
  return figure.ns / peer->ns;
}

void BenchResult::write(const std::filesystem::path& file) const {
  nlohmann::ordered_json out{
      {"processor", processor()}, {"compiler", __VERSION__}, {"load", load()}, {"peer", peer_}};
  for (const Figure& one : figures_)
    out["figures"][one.name] = {{"ns_per_tick", one.ns},
                                {"times_real_time", kTick_ns / one.ns},
                                {"ratio_to_peer", ratio(one)},
                                {"remark", one.remark}};
  atomic_write(file, out.dump(1) + "\n");
}

std::string BenchResult::losses(const std::filesystem::path& file) const {
  const auto earlier = nlohmann::json::parse(read_file(file), nullptr, false);
  if (!earlier.is_object() || !earlier.contains("figures") || !earlier["figures"].is_object())
    throw ConfigError("no figures of a bench", file.string(), "write one with --out");
  std::string text;
  for (const Figure& one : figures_) {
    const double was = earlier["figures"].value(one.name, nlohmann::json::object()).value("ratio_to_peer", 0.0);
    const double is = ratio(one);
    if (was > 0.0 && is > kMostOfEarlier * was)
      text += fmt::format("{}: {:.3f} of the peer's time, {:.3f} earlier\n", one.name, is, was);
  }
  return text;
}

}  // namespace biopsy::bench
