#include "robot/recorder/record_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "robot/common/text/number_text.hpp"

namespace biopsy::recorder {
namespace {

using Json = nlohmann::json;

std::string joined(const std::vector<std::string>& parts, const char* if_none) {
  return parts.empty() ? if_none : fmt::format("{}", fmt::join(parts, ", "));
}

// IEC 60204-1 stop categories, as StopCategory counts them.
std::string stop_text(int stop) {
  constexpr std::array kNames{"none", "hold (C2)", "ramp to 0 V (C1)", "off at once (C0)"};
  return stop >= 0 && stop < static_cast<int>(kNames.size()) ? kNames[static_cast<std::size_t>(stop)]
                                                             : fmt::format("unknown ({})", stop);
}

std::string value_text(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

// What no sentence was written for: its entries, with spaces for their underscores.
std::string entries(const Json& body) {
  std::vector<std::string> parts;
  for (const auto& [key, value] : body.items()) {
    std::string name = key;
    for (char& letter : name)
      if (letter == '_') letter = ' ';
    parts.push_back(fmt::format("{} {}", name, value_text(value)));
  }
  return joined(parts, "no more is said");
}

std::string process_text(const Json& body, bool started) {
  if (body.empty()) return started ? "the log begins" : "the log ends";
  std::string text = started ? "started" : "stopped, or silent";
  if (body.contains("config"))
    text += fmt::format(", configuration {}", body.at("config").get<std::string>());
  if (body.contains("operator")) text += fmt::format(", operator {}", body.at("operator").get<std::string>());
  return text;
}

// An older log does not say it.
std::string by_operator(const Json& body) {
  const std::string name = body.value("operator", "");
  return name.empty() ? "" : ", operator " + name;
}

std::string plan_text(const Json& body) {
  const std::string seal = body.at("seal").get<std::string>().substr(0, 16);
  if (!body.at("seal_holds").get<bool>())
    return fmt::format("a plan whose seal {} DOES NOT HOLD{}", seal, by_operator(body));
  return fmt::format(
      "plan {} for patient {}: target {:.2f} mm in {} steps, {} of 2 confirmations at the console{}", seal,
      body.at("patient").get<std::string>(), body.at("target_mm").get<double>(), body.at("stages").get<int>(),
      body.at("confirmations").get<int>(), by_operator(body));
}

std::string act_text(const Json& body) {
  std::vector<std::string> parts;
  if (body.at("held").get<bool>())
    parts.push_back(fmt::format("holds the motion button (press {})", body.at("token").get<std::uint64_t>()));
  if (body.at("stop").get<int>() != 0)
    parts.push_back("requests stop: " + stop_text(body.at("stop").get<int>()));
  if (body.at("finish").get<bool>()) parts.emplace_back("withdraws the needle");
  if (body.contains("hold_still") && body.at("hold_still").get<bool>())
    parts.emplace_back("has the needle locked");
  if (body.at("acquiring").get<bool>()) parts.emplace_back("has an image taken");
  if (body.at("asks_arm").get<bool>()) parts.emplace_back("asks to arm over the network");
  if (body.at("asks_reset").get<bool>()) parts.emplace_back("asks to reset over the network");
  std::string text = joined(parts, "asks for nothing");
  if (body.contains("operator")) text = body.at("operator").get<std::string>() + " " + text;
  return text;
}

std::string state_text(const Json& body) {
  const auto reason = body.at("reason").get<std::string>();
  return fmt::format("{}: {}{}, step {}{}", body.at("mode").get<std::string>(),
                     body.at("event").get<std::string>(), reason == "none" ? "" : " (" + reason + ")",
                     body.at("stage").get<int>(), body.at("stage_done").get<bool>() ? " done" : "");
}

std::string permit_text(const Json& body) {
  if (body.contains("mode"))
    return fmt::format("step {}{}, stop {}", body.at("stage").get<int>(),
                       body.at("stage_done").get<bool>() ? " done" : "",
                       stop_text(body.at("stop").get<int>()));
  return fmt::format("high voltage {}, {:.2f} kV commanded, needle at {:.2f} mm",
                     body.at("hv_enabled").get<bool>() ? "ON" : "off", body.at("command_kV").get<double>(),
                     body.at("depth_mm").get<double>());
}

// Whoever measured could not tell where it is millions of millimetres.
std::string motion_text(double moved_mm) {
  const bool known = moved_mm >= 0 && moved_mm < 1e6;
  return known ? fmt::format("the patient is {:.1f} mm from where the planning image shows them", moved_mm)
               : "nobody knows how far the patient moved";
}

std::string alarm_text(const Json& body) {
  if (body.contains("worst")) {
    const auto worst = body.at("worst").get<std::string>(), before = body.at("before").get<std::string>();
    return worst == "none" ? "over: " + before : worst;
  }
  if (body.contains("beside"))
    return (body.at("over").get<bool>() ? "over: " : "beside it: ") + body.at("beside").get<std::string>();
  if (body.contains("note")) {
    const auto note = body.at("note").get<std::string>();
    return note.empty() ? "its trouble is over" : note;
  }
  if (body.contains("topic"))
    return fmt::format("{}: {} alive, {} missed so far", body.at("topic").get<std::string>(),
                       counted(body.at("writers_alive").get<std::size_t>(), "writer"),
                       counted(body.at("deadlines_missed").get<std::size_t>(), "deadline"));
  if (body.contains("patient_measured"))
    return body.at("patient_measured").get<bool>() ? motion_text(body.at("patient_motion_mm").get<double>())
                                                   : "no sensor measures the patient's motion any more";
  if (body.contains("strangers_refused"))
    return fmt::format("{} of unauthenticated participants refused so far",
                       counted(body.at("strangers_refused").get<std::size_t>(), "message"));
  return entries(body);
}

std::string request_text(const Json& body) {
  if (body.at("finished").get<bool>()) return "the plan is finished";
  return fmt::format("step {} {}", body.at("stage").get<int>(),
                     body.at("reached").get<bool>() ? "reached" : "begun");
}

std::string depth_check_text(const Json& body) {
  return fmt::format("step {}: {}{}", body.at("stage").get<int>(),
                     body.at("accepted").get<bool>() ? "its depth is accepted" : "no depth is accepted",
                     by_operator(body));
}

std::string confirmation_text(const Json& body) {
  const std::string seal = body.at("seal").get<std::string>();
  return fmt::format("confirms plan {} apart from the console{}", seal.substr(0, 16), by_operator(body));
}

// "armed on the device", "reset on the device": by whoever stands there.
bool is_key_turn(const Json& body) {
  return body.value("event", "").ends_with("on the device");
}

using Words = std::string (*)(const Json&);
const std::map<std::string, Words, std::less<>> kWords{
    {name_of(RecordKind::ProcessStart), [](const Json& body) { return process_text(body, true); }},
    {name_of(RecordKind::ProcessStop), [](const Json& body) { return process_text(body, false); }},
    {name_of(RecordKind::Plan), plan_text},
    {name_of(RecordKind::PlanConfirmation), confirmation_text},
    {name_of(RecordKind::OperatorAct), act_text},
    {name_of(RecordKind::Request), request_text},
    {name_of(RecordKind::RequestRefused), [](const Json& body) { return body.at("why").get<std::string>(); }},
    {name_of(RecordKind::PermitChange), permit_text},
    {name_of(RecordKind::StateChange), state_text},
    {name_of(RecordKind::DepthCheck), depth_check_text},
    {name_of(RecordKind::Alarm), alarm_text},
};

}  // namespace

void SignedIn::follow(const Record& record) {
  if (record.source != "person") return;
  if (record.kind == name_of(RecordKind::ProcessStop)) name_.clear();
  const Json body = Json::parse(record.body, nullptr, false);
  const auto name = body.is_object() ? body.find("operator") : body.end();
  if (name != body.end() && name->is_string()) name_ = name->get<std::string>();
}

std::string text_of(const Record& record, const std::string& signed_in) {
  const Json body = Json::parse(record.body, nullptr, false);
  if (!body.is_object()) return record.body;
  try {
    const auto words = kWords.find(record.kind);
    const std::string text = words == kWords.end() ? entries(body) : words->second(body);
    const bool turned = record.kind == name_of(RecordKind::StateChange) && is_key_turn(body);
    return turned && !signed_in.empty() ? text + "; signed in: " + signed_in : text;
  } catch (const Json::exception&) {  // of another version of the program
    return record.body;
  }
}

}  // namespace biopsy::recorder
