#include "sim/term/term_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "robot/common/config_error.hpp"

namespace biopsy::sim {
namespace {

constexpr double kLargestForce = 1e5;   // N, as of external forces
constexpr double kLongestMemory = 1e4;  // s
constexpr double kShortestMemory = 1e-3;

// In the order of TermFactor.
constexpr std::array<std::string_view, kTermFactors> kFactors{
    "x", "v", "|v|", "sign(v)", "u", "|u|", "sign(u)", "q", "|v|^n", "sin(kx)", "cos(kx)"};

int total_power(const TermPowers& powers, std::initializer_list<TermFactor> factors) {
  int sum = 0;
  for (const TermFactor factor : factors) sum += power_of(powers, factor);
  return sum;
}

[[noreturn]] void refuse(const std::string& what, const std::string& place) {
  throw ConfigError("`expression`: " + what, place,
                    "write a sum of letters a, b, ... times products of x, v, |v|, |v|^n, sign(v), u, |u|, "
                    "sign(u), q, sin(kx) and cos(kx), as \"a v^3 + b x v\"");
}

std::vector<std::string> split(const std::string& text, const std::string& separators) {
  std::vector<std::string> out;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find_first_of(separators, from), text.size());
    if (to > from) out.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return out;
}

void add_factor(TermPowers& powers, const std::string& word, const std::string& place) {
  const bool whole = std::ranges::find(kFactors, word) != kFactors.end();  // "|v|^n" is one
  const std::size_t hat = whole ? word.size() : std::min(word.find('^'), word.size());
  const auto* const found = std::ranges::find(kFactors, word.substr(0, hat));
  if (found == kFactors.end()) refuse(fmt::format("\"{}\" is no factor", word), place);
  int power = 1;
  if (hat < word.size()) {
    const std::string digits = word.substr(hat + 1);
    if (digits.size() != 1 || digits[0] < '1' || digits[0] > '0' + kHighestPower)
      refuse(fmt::format("the power of \"{}\" is none of 1 to {}", word, kHighestPower), place);
    power = digits[0] - '0';
  }
  auto& now = powers[static_cast<std::size_t>(found - kFactors.begin())];
  if (now > 0)
    refuse(fmt::format("\"{}\" stands twice in a product",
                       kFactors[static_cast<std::size_t>(found - kFactors.begin())]),
           place);
  if (word.starts_with("sign") && power > 1) refuse("a sign has no power", place);
  if ((word.starts_with("sin(") || word.starts_with("cos(")) && power > 1)
    refuse("a sine has no power", place);
  now = static_cast<std::uint8_t>(power);
}

std::string unit_power(const char* unit, int power) {
  return power == 1 ? unit : fmt::format("{}^{}", unit, power);
}

}  // namespace

std::string product_text(const TermPowers& powers) {
  std::string out;
  for (std::size_t i = 0; i < kTermFactors; ++i) {
    if (powers[i] == 0) continue;
    out += fmt::format("{}{}", out.empty() ? "" : " ", kFactors[i]);
    if (powers[i] > 1) out += fmt::format("^{}", powers[i]);
  }
  return out;
}

std::string coefficient_unit(const TermPowers& powers, bool on_stack) {
  const int speeds = total_power(powers, {TermFactor::Speed, TermFactor::SpeedSize});
  const int metres = speeds + total_power(powers, {TermFactor::Position, TermFactor::Memory});
  const int drives = total_power(powers, {TermFactor::Drive, TermFactor::DriveSize});
  std::vector<std::string> above, below;
  if (on_stack) {
    above.emplace_back("N");
    if (drives > 0) below.push_back(unit_power("V", drives));
  } else if (drives == 0) {
    above.emplace_back("N");
  } else if (drives > 1) {
    below.push_back(unit_power("N", drives - 1));
  }
  if (speeds > 0) above.push_back(unit_power("s", speeds));
  if (has_speed_power(powers)) above.emplace_back("(s/m)^n");
  if (metres > 0) below.push_back(unit_power("m", metres));
  std::string top = above.empty() ? "1" : fmt::format("{}", fmt::join(above, " "));
  if (below.empty()) return top;
  const std::string bottom = fmt::format("{}", fmt::join(below, " "));
  return below.size() > 1 ? fmt::format("{}/({})", top, bottom) : fmt::format("{}/{}", top, bottom);
}

std::string expression_text(const std::vector<TermPart>& parts) {
  std::string out;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string product = product_text(parts[i].powers);
    out += fmt::format("{}{}{}{}", i == 0 ? "" : " + ", coefficient_name(i), product.empty() ? "" : " ",
                       product);
  }
  return out;
}

std::vector<TermPart> parse_expression(const std::string& text, const std::string& place) {
  std::vector<TermPart> out;
  for (const std::string& piece : split(text, "+")) {
    const std::vector<std::string> words = split(piece, " *\t");
    if (out.size() == kMostTermParts) refuse(fmt::format("more than {} products", kMostTermParts), place);
    if (words.empty() || words.front() != coefficient_name(out.size()))
      refuse(fmt::format("a product does not begin with its letter `{}`", coefficient_name(out.size())),
             place);
    TermPart part;
    for (std::size_t i = 1; i < words.size(); ++i) add_factor(part.powers, words[i], place);
    for (const TermPart& other : out)
      if (other.powers == part.powers)
        refuse(fmt::format("\"{}\" stands twice", product_text(part.powers)), place);
    out.push_back(part);
  }
  if (out.empty()) refuse("it is empty", place);
  return out;
}

bool has_exponent(const std::vector<TermPart>& parts) {
  return std::ranges::any_of(parts, [](const TermPart& part) { return has_speed_power(part.powers); });
}

bool has_period(const std::vector<TermPart>& parts) {
  return std::ranges::any_of(parts, [](const TermPart& part) { return repeats_with_position(part.powers); });
}

std::vector<TermRangeKey> range_keys(const std::vector<TermPart>& parts, bool on_stack) {
  const auto uses = [&](std::initializer_list<TermFactor> factors) {
    return std::ranges::any_of(parts,
                               [&](const TermPart& part) { return total_power(part.powers, factors) > 0; });
  };
  std::vector<TermRangeKey> out;
  if (uses({TermFactor::Position, TermFactor::PositionSine, TermFactor::PositionCosine}))
    out.push_back({"x_mm", 1e-3, &TermRanges::x, 1e5, "x", "mm"});
  if (uses({TermFactor::Speed, TermFactor::SpeedSize, TermFactor::SpeedPower}))
    out.push_back({"v_mm_s", 1e-3, &TermRanges::v, 1e6, "v", "mm/s"});
  if (uses({TermFactor::Drive, TermFactor::DriveSize, TermFactor::DriveSign})) {
    if (on_stack)
      out.push_back({"u_V", 1.0, &TermRanges::drive, 20e3, "u", "V"});
    else
      out.push_back({"u_N", 1.0, &TermRanges::drive, kLargestForce, "u", "N"});
  }
  if (uses({TermFactor::Memory})) out.push_back({"q_mm", 1e-3, &TermRanges::memory, 1e5, "q", "mm"});
  return out;
}

Term read_term_frame(TomlTable& table, const std::string& name, bool on_stack) {
  Term term;
  term.name = name;
  term.parts = parse_expression(table.text("expression"), table.place("expression"));
  for (const TermRangeKey& key : range_keys(term.parts, on_stack)) {
    const std::vector<double> ends = table.numbers(key.name, -key.largest, key.largest);
    if (ends.size() != 2 || ends[0] > ends[1])
      table.refuse(key.name, "is not a range", "write the least and the greatest value where it was seen");
    term.seen.*(key.range) = {ends[0] * key.si_per_unit, ends[1] * key.si_per_unit};
    if (key.range == &TermRanges::memory)
      term.memory_time = table.number("memory_s", kShortestMemory, kLongestMemory, "s");
  }
  if (has_period(term.parts))
    term.period = 1e-3 * table.number("period_mm", kShortestPeriod_mm, kLongestPeriod_mm, "mm");
  if (has_exponent(term.parts)) term.exponent = table.number("n", kLeastExponent, kMostExponent);
  return term;
}

bool can_be_written(const Term& term, bool on_stack) {
  const auto within = [&](const TermRangeKey& key) {
    const TermRange& seen = term.seen.*(key.range);
    return std::max(std::abs(seen.low), std::abs(seen.high)) <= key.largest * key.si_per_unit;
  };
  if (has_exponent(term.parts) && !(term.exponent >= kLeastExponent && term.exponent <= kMostExponent))
    return false;
  const double period_mm = 1e3 * term.period;
  if (has_period(term.parts) && !(period_mm >= kShortestPeriod_mm && period_mm <= kLongestPeriod_mm))
    return false;
  return term.largest_force() <= kLargestForce &&
         std::ranges::all_of(range_keys(term.parts, on_stack), within);
}

void check_term_force(const Term& term, const TomlTable& table) {
  if (!(term.largest_force() <= kLargestForce))
    table.refuse("expression",
                 fmt::format("reaches {:.3g} N within the range where it was seen", term.largest_force()),
                 fmt::format("give coefficients and ranges that stay below {:.0g} N", kLargestForce));
}

}  // namespace biopsy::sim
