// A term as text: the products of its equation, "a v^3 + b x |v| v", with a letter for each coefficient, and
// its table [term.NAME] in a model file.
#pragma once

#include <string>
#include <vector>

#include "robot/common/files/toml_reader.hpp"
#include "sim/term/term.hpp"

namespace biopsy::sim {

inline constexpr double kShortestPeriod_mm = 1e-4, kLongestPeriod_mm = 1e5;
inline constexpr double kLeastExponent = 0.1, kMostExponent = 6.0;

// "x |v| v": factors in a fixed order, powers as ^n.
std::string product_text(const TermPowers& powers);
// The unit of a coefficient whose product is to be a force: "N s^3/m^3". `on_stack`: the drive is a voltage.
std::string coefficient_unit(const TermPowers& powers, bool on_stack);
// "a v^3 + b x"
std::string expression_text(const std::vector<TermPart>& parts);
// The letter of the i-th coefficient.
inline std::string coefficient_name(std::size_t i) {
  return std::string(1, static_cast<char>('a' + i));
}

// The products of an expression, coefficients 0. Throws ConfigError at `place`.
std::vector<TermPart> parse_expression(const std::string& text, const std::string& place);

// Whether a product has a power of the speed with the term's exponent, or repeats with position.
bool has_exponent(const std::vector<TermPart>& parts);
bool has_period(const std::vector<TermPart>& parts);

// A variable's range as a key of the table: "v_mm_s", and SI per unit of it.
struct TermRangeKey {
  const char* name;
  double si_per_unit;
  TermRange TermRanges::*range;
  double largest;               // in that unit
  const char *variable, *unit;  // for people: "v", "mm/s"
};
// Of the variables that the parts use.
std::vector<TermRangeKey> range_keys(const std::vector<TermPart>& parts, bool on_stack);

// A term without its coefficients: expression, time of its memory, period, exponent and ranges.
Term read_term_frame(TomlTable& table, const std::string& name, bool on_stack);
// Whether a model file may hold the term: its force and ranges are those of such a mechanism.
bool can_be_written(const Term& term, bool on_stack);
// Throws ConfigError where the term has a force beyond any such mechanism.
void check_term_force(const Term& term, const TomlTable& table);

}  // namespace biopsy::sim
