#include "clients/cli/ask_verb.h"

#include "clients/cli/daemon_link.h"
#include "protocol/schema.h"

#include <CLI/CLI.hpp>

#include <cstdio>

namespace ringdown::cli {
namespace {

std::string text_of(const wire::Argument& argument) {
  if (const auto* text = std::get_if<std::string>(&argument)) return *text;
  if (const auto* integer = std::get_if<std::int32_t>(&argument)) return std::to_string(*integer);
  char text[32] = "";
  if (const auto* number = std::get_if<float>(&argument)) std::snprintf(text, sizeof text, "%g", *number);
  return text;
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

}  // namespace

void add_daemon_options(CLI::App& verb, DaemonOptions& options) {
  verb.add_option("--to", options.url, "The daemon.")->capture_default_str()->type_name("URL");
  verb.add_option("--timeout", options.timeout_s, "How long to wait for its answer.")
      ->capture_default_str()
      ->type_name("SECONDS")
      ->check(CLI::Range(0.001, 3600.0));
}

ExitCode ask_and_print(const DaemonOptions& options, const wire::Message& message) {
  auto link = DaemonLink::open(options.url);
  if (!link) return complain(link.error().message, ExitCode::usage);
  const auto timeout = std::chrono::ceil<std::chrono::milliseconds>(std::chrono::duration<double>(options.timeout_s));
  const auto reply = link->ask(message, timeout);
  if (!reply) return complain(reply.error().message, ExitCode::no_answer);
  if (const auto* fail = std::get_if<protocol::Fail>(&*reply)) return complain(fail->sentence, ExitCode::failure);
  if (!std::holds_alternative<protocol::Synced>(*reply)) print(*reply);
  return ExitCode::ok;
}

}  // namespace ringdown::cli
