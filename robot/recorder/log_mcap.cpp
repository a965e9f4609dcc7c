#include "robot/recorder/log_mcap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "robot/common/config_error.hpp"
#include "robot/recorder/log_alignment.hpp"
#include "robot/recorder/mcap_writer.hpp"

namespace biopsy::recorder {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::string dumped(const OrderedJson& json) {
  return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

const char* type_of(const OrderedJson& value) {
  switch (value.type()) {
    case OrderedJson::value_t::boolean:
      return "boolean";
    case OrderedJson::value_t::number_integer:
    case OrderedJson::value_t::number_unsigned:
      return "integer";
    case OrderedJson::value_t::number_float:
      return "number";
    case OrderedJson::value_t::array:
      return "array";
    case OrderedJson::value_t::object:
      return "object";
    case OrderedJson::value_t::null:
      return "null";
    default:
      return "string";
  }
}

std::optional<OrderedJson> object_in(const std::string& body) {
  OrderedJson parsed = OrderedJson::parse(body, nullptr, false);
  if (!parsed.is_object()) return std::nullopt;
  return parsed;
}

OrderedJson property(const char* type, const char* description) {
  return {{"type", type}, {"description", description}};
}

// The fields that the records of one kind have, with their types.
using Fields = std::map<std::string, std::set<std::string>>;

OrderedJson schema_of(const Fields& fields) {
  OrderedJson values = {{"type", "object"}, {"properties", OrderedJson::object()}};
  for (const auto& [name, types] : fields)
    values["properties"][name]["type"] = types.size() == 1 ? OrderedJson(*types.begin()) : OrderedJson(types);
  return {{"type", "object"},
          {"properties",
           {{"record", property("integer", "number in the log, from 1")},
            {"utc_ns", property("string", "wall clock of the source, ns since 1970, UTC")},
            {"mono_us", property("integer", "its monotonic clock, us")},
            {"source", property("string", "process that it comes from")},
            {"kind", property("string", "kind of record")},
            {"body", property("string", "as it is hashed")},
            {"previous", property("string", "hash of the record before, hexadecimal")},
            {"hash", property("string", "of this record, hexadecimal")},
            {"values", values}}}};
}

std::string topic_of(const std::string& kind) {
  std::string topic = "/log/" + kind;
  std::ranges::replace(topic, ' ', '_');
  return topic;
}

// Nanoseconds as a text: JavaScript's numbers do not hold them.
OrderedJson message_of(const Record& record) {
  OrderedJson message = {{"record", record.seq},
                         {"utc_ns", std::to_string(record.utc_ns)},
                         {"mono_us", record.mono_us},
                         {"source", record.source},
                         {"kind", record.kind},
                         {"body", record.body},
                         {"previous", fmt::format("{:02x}", fmt::join(record.previous, ""))},
                         {"hash", fmt::format("{:02x}", fmt::join(record.hash, ""))}};
  if (const std::optional<OrderedJson> values = object_in(record.body)) message["values"] = *values;
  return message;
}

std::uint64_t time_of(const Record& record) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(record.utc_ns, 0));
}

// The log's wall clock at the zero of the run's clock.
std::int64_t zero_ns_of(const std::vector<Record>& records, const CsvTable& run,
                        const std::vector<double>& time_s) {
  std::vector<ModeChange> changes;
  for (std::size_t row = 1; row < run.rows(); ++row) {
    if (run.text("mode", row) == run.text("mode", row - 1)) continue;
    if (const std::optional<Mode> mode = mode_named(run.text("mode", row)))
      changes.push_back({static_cast<std::int64_t>(1e6 * time_s[row]), *mode});
  }
  const std::optional<Alignment> place = align(changes, mode_changes(records));
  if (!place)
    throw ConfigError("the log never went through the states of this run", run.file(),
                      "give the run.csv of a run that this log recorded");
  const auto of_supervisor = std::ranges::find(records, name_of(RecordKind::StateChange), &Record::kind);
  return of_supervisor->utc_ns + 1'000 * (place->zero_us - of_supervisor->mono_us);
}

bool is_text(std::string_view column) {
  return column == "mode" || column == "stop" || column == "gate";
}

void add_run(McapWriter& writer, const std::vector<Record>& records, const CsvTable& run) {
  for (const char* column : {"time_s", "mode"})
    if (!run.has(column))
      throw ConfigError(fmt::format("there is no column {}", column), run.header_place(), "give a run.csv");
  constexpr double kMost = 1e12;
  std::map<std::string_view, std::vector<double>> numbers;
  OrderedJson properties = OrderedJson::object();
  for (const std::string_view name : run.names()) {
    if (!is_text(name)) numbers[name] = run.numbers(name, -kMost, kMost);
    properties[std::string(name)]["type"] = is_text(name) ? "string" : "number";
  }
  const std::uint16_t channel =
      writer.add_channel("/run", "biopsy.run", dumped({{"type", "object"}, {"properties", properties}}));
  const std::int64_t zero_ns = zero_ns_of(records, run, numbers["time_s"]);
  for (std::size_t row = 0; row < run.rows(); ++row) {
    OrderedJson message = OrderedJson::object();
    for (const std::string_view name : run.names()) {
      if (is_text(name))
        message[std::string(name)] = run.text(name, row);
      else
        message[std::string(name)] = numbers[name][row];
    }
    const auto at_ns = zero_ns + static_cast<std::int64_t>(numbers["time_s"][row] * 1e9);
    writer.add_message(channel, static_cast<std::uint32_t>(row),
                       static_cast<std::uint64_t>(std::max<std::int64_t>(at_ns, 0)), dumped(message));
  }
}

}  // namespace

std::string log_mcap(const std::vector<Record>& records, const CsvTable* run, const std::string& library) {
  std::map<std::string, Fields> kinds;
  for (const Record& record : records) {
    Fields& fields = kinds[record.kind];
    if (const std::optional<OrderedJson> values = object_in(record.body))
      for (const auto& [name, value] : values->items()) fields[name].insert(type_of(value));
  }
  McapWriter writer(library);
  std::map<std::string, std::uint16_t> channels;
  for (const auto& [kind, fields] : kinds) {
    const std::string topic = topic_of(kind);
    channels[kind] = writer.add_channel(topic, "biopsy" + topic, dumped(schema_of(fields)));
  }
  for (const Record& record : records)
    writer.add_message(channels[record.kind], static_cast<std::uint32_t>(record.seq), time_of(record),
                       dumped(message_of(record)));
  if (run != nullptr && !records.empty()) add_run(writer, records, *run);
  return writer.finish();
}

}  // namespace biopsy::recorder
