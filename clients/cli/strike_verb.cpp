#include "clients/cli/ask_verb.h"
#include "protocol/help.h"
#include "protocol/schema.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cassert>
#include <memory>

namespace ringdown::cli {
namespace {

struct StrikeOptions {
  DaemonOptions daemon;
  std::string object, point, vertex, impulse, contact_time;
};

const protocol::AddressSpec& spec_of(std::string_view verb) {
  return **protocol::find_address("/object/0/" + std::string(verb));
}

// The table's description of one argument, for the option that fills it.
std::string help_for(std::string_view verb, std::string_view name) {
  const protocol::AddressSpec& spec = spec_of(verb);
  const auto argument = std::ranges::find(spec.arguments, name, &protocol::ArgumentSpec::name);
  assert(argument != spec.arguments.end());
  return protocol::describe(*argument);
}

// "1,2,3" -> three words, which the table's parser checks.
bool append_three(std::vector<std::string>& words, const std::string& list) {
  const std::vector<std::string> parts = CLI::detail::split(list, ',');
  words.insert(words.end(), parts.begin(), parts.end());
  return parts.size() == 3;
}

ExitCode strike(const StrikeOptions& options) {
  std::vector<std::string> words;
  const bool by_vertex = !options.vertex.empty();
  if (by_vertex) {
    words.push_back(options.vertex);
  } else if (!append_three(words, options.point)) {
    return complain("--at takes three numbers with commas between them, like 0.05,0,0.02", ExitCode::usage);
  }
  if (!append_three(words, options.impulse)) {
    return complain("--impulse takes three numbers with commas between them, like 0,0,-0.1", ExitCode::usage);
  }
  if (!options.contact_time.empty()) words.push_back(options.contact_time);
  const auto message =
      protocol::compose("/object/" + options.object + (by_vertex ? "/strike_vertex" : "/strike"), words);
  if (!message) return complain(message.error().message, ExitCode::usage);
  return ask_and_print(options.daemon, *message);
}

}  // namespace

void add_strike_verb(CLI::App& app, ExitCode& outcome) {
  auto options = std::make_shared<StrikeOptions>();
  CLI::App* verb = app.add_subcommand("strike", std::string(spec_of("strike").sentence));
  verb->add_option("object", options->object, help_for("strike", "object"))->required();
  auto* where = verb->add_option_group("where", "one of these two");
  where->add_option("--at", options->point, help_for("strike", "x"))->type_name("X,Y,Z");
  where->add_option("--vertex", options->vertex, help_for("strike_vertex", "vertex"))->type_name("NUMBER");
  where->require_option(1);
  verb->add_option("--impulse", options->impulse, help_for("strike", "jx"))->type_name("X,Y,Z")->required();
  verb->add_option("--contact-time", options->contact_time, help_for("strike", "contact_time"))->type_name("SECONDS");
  add_daemon_options(*verb, options->daemon);
  verb->callback([options, &outcome] { outcome = strike(*options); });
}

}  // namespace ringdown::cli
