// The verbs that talk to a running daemon.
#include "clients/cli/daemon_link.h"
#include "clients/cli/verb.h"
#include "packaging/manual/command_line.h"
#include "protocol/defaults.h"
#include "protocol/help.h"
#include "protocol/schema.h"

#include <algorithm>
#include <cassert>
#include <cstdio>
#include <memory>

namespace ringdown::cli {
namespace {

struct DaemonOptions {
  std::string url = formatted("osc.udp://127.0.0.1:{}", protocol::kDefaultPort);
  double timeout_s = 2;
};

std::string text_of(const wire::Argument& argument) {
  if (const auto* text = std::get_if<std::string>(&argument)) return *text;
  if (const auto* integer = std::get_if<std::int32_t>(&argument)) return std::to_string(*integer);
  if (const auto* number = std::get_if<float>(&argument)) return formatted("{:g}", *number);
  return "";
}

void print(const protocol::Reply& reply) {
  const protocol::AddressSpec& spec = protocol::spec_of(reply);
  const wire::Message message = protocol::format(reply);
  for (std::size_t i = 0; i < message.arguments.size(); ++i) {
    const protocol::ArgumentSpec& argument = spec.arguments[i];
    if (argument.name == "address") continue;  // the user has just typed it
    std::printf("%-17.*s %s%s%.*s\n", static_cast<int>(argument.name.size()), argument.name.data(),
                text_of(message.arguments[i]).c_str(), argument.unit.empty() ? "" : " ",
                static_cast<int>(argument.unit.size()), argument.unit.data());
  }
}

void add_daemon_options(manual::App& verb, DaemonOptions& options) {
  verb.add_option("--to", options.url, "The daemon's address.")->capture_default_str()->type_name("URL");
  verb.add_option("--timeout", options.timeout_s, "Time to wait for the daemon's answer.")
      ->capture_default_str()
      ->type_name("SECONDS")
      ->check(manual::between(0.001, 3600.0));
}

// Sends the message and prints the answer: nothing for a silent success, else one line per argument.
ExitCode ask_and_print(const DaemonOptions& options, const wire::Message& message) {
  auto link = DaemonLink::open(options.url);
  if (!link) return complain(link.error().message, ExitCode::usage);
  const auto timeout = std::chrono::ceil<std::chrono::milliseconds>(std::chrono::duration<double>(options.timeout_s));
  const auto reply = link->ask(message, timeout);
  if (!reply) return complain(reply.error().message, ExitCode::no_answer);
  if (const auto* fail = reply->get_if<protocol::Fail>()) return complain(fail->sentence, ExitCode::failure);
  if (!reply->holds<protocol::Synced>()) print(*reply);
  return ExitCode::ok;
}

struct StrikeOptions {
  DaemonOptions daemon;
  std::string object, point, vertex, impulse, contact_time;
};

const protocol::AddressSpec& spec_of(std::string_view verb) {
  return **protocol::find_address("/object/0/" + std::string(verb));
}

// The protocol table's description of one argument, for the option that sets it.
std::string help_for(std::string_view verb, std::string_view name) {
  const protocol::AddressSpec& spec = spec_of(verb);
  const auto argument = std::ranges::find(spec.arguments, name, &protocol::ArgumentSpec::name);
  assert(argument != spec.arguments.end());
  return protocol::describe(*argument);
}

// Appends "1,2,3" as three words.
void append_three(std::vector<std::string>& words, const std::string& list) {
  const std::vector<std::string> parts = manual::split_at_commas(list);
  words.insert(words.end(), parts.begin(), parts.end());
}

ExitCode strike(const StrikeOptions& options) {
  std::vector<std::string> words;
  const bool by_vertex = !options.vertex.empty();
  if (by_vertex) {
    words.push_back(options.vertex);
  } else {
    append_three(words, options.point);
  }
  append_three(words, options.impulse);
  if (!options.contact_time.empty()) words.push_back(options.contact_time);
  const auto message =
      protocol::compose("/object/" + options.object + (by_vertex ? "/strike_vertex" : "/strike"), words);
  if (!message) return complain(message.error().message, ExitCode::usage);
  return ask_and_print(options.daemon, *message);
}

struct SendOptions {
  DaemonOptions daemon;
  std::string address;
  std::vector<std::string> words;
};

ExitCode send(const SendOptions& options) {
  const auto message = protocol::compose(options.address, options.words);
  if (!message) return complain(message.error().message, ExitCode::usage);
  return ask_and_print(options.daemon, *message);
}

}  // namespace

void add_strike_verb(manual::App& app, ExitCode& outcome) {
  auto options = std::make_shared<StrikeOptions>();
  manual::App* verb = app.add_subcommand("strike", std::string(spec_of("strike").sentence));
  verb->add_option("object", options->object, help_for("strike", "object"))->required();
  auto* where = verb->add_option_group("where", "either of these");
  where->add_option("--at", options->point, help_for("strike", "x"))->type_name("X,Y,Z")->check(manual::any_vector());
  where->add_option("--vertex", options->vertex, help_for("strike_vertex", "vertex"))
      ->type_name("NUMBER")
      ->check(manual::any_number());
  where->require_option(1);
  verb->add_option("--impulse", options->impulse, help_for("strike", "jx"))
      ->type_name("X,Y,Z")
      ->check(manual::any_vector())
      ->required();
  verb->add_option("--contact-time", options->contact_time, help_for("strike", "contact_time"))
      ->type_name("SECONDS")
      ->check(manual::any_number());
  add_daemon_options(*verb, options->daemon);
  verb->callback([options, &outcome] { outcome = strike(*options); });
}

void add_send_verb(manual::App& app, ExitCode& outcome) {
  auto options = std::make_shared<SendOptions>();
  manual::App* verb = app.add_subcommand("send", "Sends any message of the protocol and prints the daemon's answer.");
  verb->add_option("address", options->address, "Such as /status or /object/bell/gain; `ringdown protocol` lists all.")
      ->required();
  verb->add_option("arguments", options->words, "The arguments of the message, such as 0.5");
  add_daemon_options(*verb, options->daemon);
  verb->callback([options, &outcome] { outcome = send(*options); });
}

}  // namespace ringdown::cli
