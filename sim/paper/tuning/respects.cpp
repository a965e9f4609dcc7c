#include "sim/paper/tuning/respects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace biopsy::sim::tuning {
namespace {

struct Entry {
  const char* name;
  double Score::*member;
  double least;  // changes of less than kNoticed of this are not seen, whatever their ratio; as in Score
};

constexpr Entry kEntries[] = {{"settled error", &Score::settled_rmse, 0.010},
                              {"overshoot", &Score::overshoot, 1.0},
                              {"undershoot", &Score::undershoot, 1.0},
                              {"settling", &Score::settling, 0.050},
                              {"error on the sine", &Score::sine_rmse, 0.010}};

double share(double from, double to, double least) {
  return (to - from) / std::max(from, least);
}

// A margin that nothing bounds is as good as any.
double share_of_margin(double from, double to) {
  constexpr double kAny = 100.0;  // dB or degrees
  return share(std::min(from, kAny), std::min(to, kAny), 1.0);
}

std::string listed(const std::vector<Respect>& all, double sign) {
  std::string text;
  for (const Respect& one : all)
    if (sign * one.gain > kNoticed)
      text += fmt::format("{}{} ({:.0f} %)", text.empty() ? "" : ", ", one.name, 100.0 * std::abs(one.gain));
  return text.empty() ? "nothing" : text;
}

}  // namespace

std::vector<Respect> respects(const EvaluatedGains& first, const EvaluatedGains& other) {
  std::vector<Respect> all;
  for (const Entry& e : kEntries) {
    all.push_back({std::string(e.name) + " on the model",
                   -share(first.nominal.*e.member, other.nominal.*e.member, e.least)});
    all.push_back({std::string(e.name) + " on the worst stage",
                   -share(first.worst.*e.member, other.worst.*e.member, e.least)});
  }
  const Margins &a = first.worst_margins, &b = other.worst_margins;
  all.push_back({"gain margin", share_of_margin(a.gain_dB, b.gain_dB)});
  all.push_back({"phase margin", share_of_margin(a.phase_degrees, b.phase_degrees)});
  return all;
}

bool improves(const std::vector<Respect>& all) {
  const auto gain_of = [](const Respect& one) { return one.gain; };
  return std::ranges::min(all, {}, gain_of).gain >= -kNoticed &&
         std::ranges::max(all, {}, gain_of).gain > kNoticed;
}

std::string comparison_text(const std::vector<Respect>& all) {
  return fmt::format("better: {}; worse: {}", listed(all, 1.0), listed(all, -1.0));
}

}  // namespace biopsy::sim::tuning
