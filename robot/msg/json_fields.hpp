// Reads a message field by field and refuses what the IDL does not allow: a missing or unknown field, another
// type, a number out of range, a text or list that is too long.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace biopsy::console {

inline constexpr std::size_t kLongText = 4'000'000;

// What is wrong with a message; the text names the field.
struct MessageFault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct TextLimits {
  std::size_t most = 0;
};
struct NumberLimits {
  double lowest = std::numeric_limits<double>::lowest(), highest = std::numeric_limits<double>::max();
};

class FieldReader {
 public:
  // Throws MessageFault where `from` is no object.
  explicit FieldReader(const nlohmann::json& from) : from_(from) {
    if (!from.is_object()) throw MessageFault("not an object");
  }

  template <class Value, class... Limits>
  void one(const char* name, Value& to, Limits... limits) {
    read(name, field(name), to, limits...);
  }
  template <class Value, std::size_t Count, class... Limits>
  void list(const char* name, std::array<Value, Count>& to, Limits... limits) {
    const nlohmann::json& values = field(name);
    if (!values.is_array() || values.size() != Count) fail(name, "is no list of the right length");
    for (std::size_t i = 0; i < Count; ++i) read(name, values[i], to[i], limits...);
  }
  template <class Value, class... Limits>
  void list(const char* name, std::vector<Value>& to, std::size_t most, Limits... limits) {
    const nlohmann::json& values = field(name);
    if (!values.is_array() || values.size() > most) fail(name, "is no list or too long");
    to.clear();
    for (const nlohmann::json& value : values) read(name, value, to.emplace_back(), limits...);
  }

  // After the last field: nothing may be left but `type`.
  void expect_no_more() const {
    if (from_.size() != taken_ + from_.contains("type")) throw MessageFault("a field that is not known");
  }

 private:
  [[noreturn]] static void fail(const char* name, const char* why) {
    throw MessageFault(std::string(name) + " " + why);
  }
  const nlohmann::json& field(const char* name) {
    const auto found = from_.find(name);
    if (found == from_.end()) fail(name, "is missing");
    ++taken_;
    return *found;
  }
  static void read(const char* name, const nlohmann::json& from, std::string& to, TextLimits limits) {
    if (!from.is_string() || from.get_ref<const std::string&>().size() > limits.most)
      fail(name, "is no text or too long");
    to = from.get<std::string>();
  }
  static void read(const char* name, const nlohmann::json& from, bool& to) {
    if (!from.is_boolean()) fail(name, "is neither true nor false");
    to = from.get<bool>();
  }
  template <class Value>
  static void read(const char* name, const nlohmann::json& from, Value& to, NumberLimits limits = {}) {
    if constexpr (std::is_enum_v<Value>) {
      read_name(name, from, to);
    } else if constexpr (std::is_class_v<Value>) {
      FieldReader inner(from);
      read_fields(inner, to);
      inner.expect_no_more();
    } else {
      const bool fits = std::is_integral_v<Value> ? from.is_number_integer() : from.is_number();
      if (!fits) fail(name, "is not such a number");
      const auto value = from.get<double>();
      if (!(value >= limits.lowest && value <= limits.highest)) fail(name, "is out of range");
      to = from.get<Value>();
    }
  }
  template <class Value>
  static void read_name(const char* name, const nlohmann::json& from, Value& to) {
    constexpr auto kNames = names_of(Value{});
    for (std::size_t i = 0; i < kNames.size() && from.is_string(); ++i) {
      if (from.get_ref<const std::string&>() != kNames[i]) continue;
      to = static_cast<Value>(i);
      return;
    }
    fail(name, "is not one of its names");
  }

  const nlohmann::json& from_;
  std::size_t taken_ = 0;
};

}  // namespace biopsy::console
