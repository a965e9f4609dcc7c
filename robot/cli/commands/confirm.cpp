// biopsy confirm: a second person's confirmation of a plan for a real stage.
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "planner/plan/open_plan.hpp"
#include "planner/plan/plan_review.hpp"
#include "planner/plan/seal.hpp"
#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/operator_name.hpp"
#include "robot/common/text/encoding.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/live/live_process.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::robot {
namespace confirm_cli {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using Json = nlohmann::ordered_json;

constexpr std::size_t kTyped = 8;  // characters of the seal, at least
constexpr milliseconds kLook{20}, kAnswer{60'000}, kTaken{3'000}, kHeard{1'500};

struct Options {
  fs::path run_folder;
  int wait_s = 300;
};

void declare(CLI::App& app, Options& options) {
  add(app, "RUN_FOLDER", options.run_folder, "of the robot: holds live.json")->required();
  add(app, "--wait S", options.wait_s, "longest time to wait for a plan", "300")
      ->check(in_range(1, 3600, "s"));
}

class Plans {
 public:
  explicit Plans(const transport::Participant& bus) : plans_(bus) {}

  // The plan that the console confirms now.
  std::optional<Plan> confirmed() {
    plans_.take_newest(newest_);
    std::optional<Plan> plan = planner::open_plan(newest_.bytes, newest_.seal);
    if (!plan) return std::nullopt;
    const std::uint64_t tag = planner::plan_tag(*plan);
    if (newest_.confirmed_tag != std::array{tag, tag}) return std::nullopt;
    return plan;
  }

  bool still_confirms(const Plan& plan) {
    const auto now = confirmed();
    return now && now->seal == plan.seal;
  }

 private:
  transport::Reader<SealedPlan> plans_;
  SealedPlan newest_;
};

template <class Found>
auto wait_for(milliseconds longest, const Found& found) {
  const auto until = std::chrono::steady_clock::now() + longest;
  auto got = found();
  while (!got && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(kLook);
    got = found();
  }
  return got;
}

std::optional<std::string> why_not(const Plan& plan) {
  if (auto objection = planner::objection_to(plan)) return objection;
  if (plan.steps.size() > safety::kMaxSteps || plan.limits.plausible.size() > safety::kMaxBands ||
      !safety::is_plausible(plan_facts(plan, 1)))
    return "the supervisor would refuse it (H-20)";
  return std::nullopt;
}

// A line from standard input; nothing where it ended, or came too late, or `goes_on` no longer.
template <class GoesOn>
std::optional<std::string> typed_line(const GoesOn& goes_on) {
  const auto until = std::chrono::steady_clock::now() + kAnswer;
  std::string line;
  while (goes_on() && std::chrono::steady_clock::now() < until) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, static_cast<int>(kLook.count())) <= 0) continue;
    char letter = 0;
    if (::read(STDIN_FILENO, &letter, 1) != 1) return std::nullopt;
    if (letter == '\n') return line;
    if (std::isspace(static_cast<unsigned char>(letter)) == 0 && line.size() <= 2 * sizeof(Sha256))
      line += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return std::nullopt;
}

// `why`: it is not confirmed; empty: it is.
Result result(const std::string& seal, const std::string& name, const std::string& why) {
  const bool confirmed = why.empty();
  const auto or_null = [](bool is, const std::string& text) { return is ? Json(text) : Json(nullptr); };
  const Json json{{"confirmed", confirmed},
                  {"seal", or_null(confirmed, seal)},
                  {"operator", name},
                  {"why", or_null(!confirmed, why)}};
  return {.exit_code = confirmed ? 0 : 1,
          .text = confirmed
                      ? fmt::format("confirmed by {}. The arm key can be turned once the robot is ready, "
                                    "within three minutes\n",
                                    name)
                      : fmt::format("NOT confirmed: {}\n", why),
          .json = json.dump(2) + "\n"};
}

// Who is signed in at the console, as its heartbeats say; a hint, no proof.
std::string name_at_console(const transport::Participant& bus) {
  transport::Reader<Health> heartbeats(bus);
  const auto heard = wait_for(kHeard, [&]() -> std::optional<std::string> {
    for (Health health; heartbeats.take(health);)
      if (health.process == Process::Person) return health.note;
    return std::nullopt;
  });
  return heard.value_or("");
}

Result run(const Options& options, const Context& context) {
  const fs::path folder = fs::absolute(options.run_folder);
  const live::LiveSettings settings = live::read_settings(folder);
  if (drivers::is_simulated(settings.device))
    throw ConfigError("the stage of this robot is simulated: its console gives both confirmations",
                      folder.string(), "nothing is to be confirmed here");
  const transport::Participant bus(live::bus_settings(settings, security::Role::Confirmer));
  Plans plans(bus);
  transport::Reader<Decision> decisions(bus);
  transport::Writer<PlanConfirmation> confirmations(bus);
  const std::string name = operator_name();
  const auto refused = [&](const std::string& why) { return result("", name, why); };
  context.say(
      fmt::format("waiting for a plan that is confirmed at the console, {} s at most", options.wait_s));
  const auto plan = wait_for(std::chrono::seconds(options.wait_s), [&] { return plans.confirmed(); });
  if (!plan)
    throw ConfigError("no plan is confirmed at the console", folder.string(),
                      "confirm it there and tick the three checks first; then start this again");
  if (name_at_console(bus) == name)
    return refused(fmt::format("{} operates the console; another person confirms here", name));
  context.say(planner::review_text(*plan));
  if (const auto why = why_not(*plan)) return refused(*why);
  context.say(
      "Compare all of this with the patient and the order, not only with the console's page. Then type the "
      "first eight characters of the seal that the page shows, within a minute:");
  const std::string seal = hex(plan->seal);
  const auto typed = typed_line([&] { return plans.still_confirms(*plan); });
  if (!plans.still_confirms(*plan)) return refused("the console no longer confirms this plan");
  if (!typed) return refused("nothing was typed");
  if (typed->size() < kTyped || !seal.starts_with(*typed))
    return refused("that is not the seal of this plan");
  confirmations.write({.seq = 1, .seal = plan->seal, .person = name});
  Decision decision;
  const bool taken = wait_for(kTaken, [&] {
    decisions.take_newest(decision);
    return decision.confirmed_tag == planner::plan_tag(*plan) && !safety::hv_permitted(decision.mode);
  });
  if (!taken) return refused("the supervisor did not take it");
  return result(seal, name, "");
}

}  // namespace confirm_cli

Command confirm_command() {
  using namespace confirm_cli;
  return {
      .name = "confirm",
      .summary = "a second person's confirmation of a plan for a real stage",
      .description =
          "Shows the plan as the robot has it, once the console has confirmed it, and refuses one that its "
          "own points deny or that is out of the planner's ranges. Another person compares it with the "
          "patient and types the beginning of the "
          "seal that the page shows. Without this the supervisor does not become ready "
          "([how-to](../how-to/live.md#the-second-person)).",
      .long_examples = {"biopsy confirm /var/lib/biopsy/run"},
      .exit_codes = "0 confirmed, 1 not confirmed, 2 for no plan or an unusable folder",
      .json =
          "`confirmed`; `seal`, of the plan that was confirmed, or `null`; `operator`; `why` it is not "
          "confirmed, or `null`",
      .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
