#include "robot/recorder/log_mcap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "robot/common/config_error.hpp"
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

struct Change {
  std::string mode;
  double at_s;  // of the log: since its first record
};

std::vector<Change> changes_in(const std::vector<Record>& records) {
  std::vector<Change> changes;
  for (const Record& record : records) {
    if (record.kind != name_of(RecordKind::StateChange)) continue;
    const std::optional<OrderedJson> values = object_in(record.body);
    if (values && values->contains("mode") && (*values)["mode"].is_string())
      changes.push_back(
          {(*values)["mode"], static_cast<double>(record.utc_ns - records.front().utc_ns) * 1e-9});
  }
  return changes;
}

std::vector<Change> changes_in(const CsvTable& run, const std::vector<double>& time_s) {
  std::vector<Change> changes{{std::string(run.text("mode", 0)), time_s[0]}};
  for (std::size_t row = 1; row < run.rows(); ++row)
    if (run.text("mode", row) != run.text("mode", row - 1))
      changes.push_back({std::string(run.text("mode", row)), time_s[row]});
  return changes;
}

// When the run's clock was 0, in seconds since the log's first record: the last place where the log went
// through the states of the run.
double start_of(const std::vector<Record>& records, const CsvTable& run, const std::vector<double>& time_s) {
  const std::vector<Change> log = changes_in(records), wanted = changes_in(run, time_s);
  const auto found = std::find_end(log.begin(), log.end(), wanted.begin(), wanted.end(),
                                   [](const Change& a, const Change& b) { return a.mode == b.mode; });
  if (wanted.size() < 2 || found == log.end())
    throw ConfigError("the log never went through the states of this run", run.file(),
                      "give the run.csv of a run that this log recorded");
  return (found + 1)->at_s - wanted[1].at_s;  // it may have been in the first state for a while
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
  const double start_s = start_of(records, run, numbers["time_s"]);
  for (std::size_t row = 0; row < run.rows(); ++row) {
    OrderedJson message = OrderedJson::object();
    for (const std::string_view name : run.names()) {
      if (is_text(name))
        message[std::string(name)] = run.text(name, row);
      else
        message[std::string(name)] = numbers[name][row];
    }
    const auto since_ns = static_cast<std::int64_t>((start_s + numbers["time_s"][row]) * 1e9);
    writer.add_message(
        channel, static_cast<std::uint32_t>(row),
        static_cast<std::uint64_t>(std::max<std::int64_t>(records.front().utc_ns + since_ns, 0)),
        dumped(message));
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
