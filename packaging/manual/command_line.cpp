#include "packaging/manual/command_line.h"

#include "engine/base/version.h"
#include "packaging/manual/completion.h"
#include "protocol/defaults.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <new>
#include <sstream>
#include <utility>

namespace ringdown::manual {
namespace {

using protocol::ExitCode;

ExitCode write_manual(App& app, std::string_view kind, const std::vector<Section>& sections) {
  const Command command = command_of(app);
  std::string text;
  if (kind == "man") text = man_page(command, sections);
  if (kind == "bash") text = bash_completion(command);
  if (kind == "zsh") text = zsh_completion(command);
  if (kind == "fish") text = fish_completion(command);
  if (text.empty()) return complain_of_usage(app, "--manual takes man, bash, zsh or fish");
  if (std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0) return ExitCode::ok;
  return protocol::complain({ErrorKind::input_output, "cannot write to the standard output"});
}

constexpr double kLargest = std::numeric_limits<double>::max();

template <class Number>
Check within(Number low, Number high) {
  std::ostringstream words;
  words << "from " << low << " to " << high;
  const auto wrong = [low, high, demand = " " + words.str()](const std::string& text) {
    return wrong_number(text, static_cast<double>(low), static_cast<double>(high), demand);
  };
  return {wrong, words.str()};
}

// Does something that may refuse a value in the words of this file's header.
template <class Do>
void in_words_of_cli11(const Do& act) {
  try {
    act();
  } catch (const WrongValue& wrong) {
    throw CLI::ValidationError(wrong.option, wrong.sentence);
  }
}

}  // namespace

Check::Check(const Wrong& wrong, const std::string& demand)
    : validator_(
          std::make_shared<const CLI::Validator>([wrong](const std::string& text) { return wrong(text); }, demand)) {}

std::string wrong_number(const std::string& text, double low, double high, const std::string& demand) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || end != text.data() + text.size()) return "'" + text + "' is not a number" + demand;
  if (!std::isfinite(number)) return "'" + text + "' is not a finite number" + demand;
  return number < low || number > high ? "'" + text + "' is not a number" + demand : "";
}

Check any_number() {
  return {[](const std::string& text) { return wrong_number(text, -kLargest, kLargest, ""); }, ""};
}

Check any_vector() {
  const auto wrong = [](const std::string& text) {
    const std::vector<std::string> parts = split_at_commas(text);
    if (parts.size() != 3) return "'" + text + "' is not three numbers with commas between them, like 0.05,0,0.02";
    for (const std::string& part : parts) {
      if (const std::string no_number = wrong_number(part, -kLargest, kLargest, ""); !no_number.empty()) {
        return no_number;
      }
    }
    return std::string();
  };
  return {wrong, ""};
}

Check above_zero() {
  const auto wrong = [](const std::string& text) {
    return wrong_number(text, std::numeric_limits<double>::denorm_min(), kLargest, " greater than 0");
  };
  return {wrong, "greater than 0"};
}

Check between(double low, double high) { return within(low, high); }
Check between_integers(long long low, long long high) { return within(low, high); }

Check one_of(std::initializer_list<const char*> words) {
  std::vector<std::string> all(words.begin(), words.end());
  return Check(std::make_shared<const CLI::Validator>(CLI::IsMember(std::move(all)).description("")));
}

std::vector<std::string> split_at_commas(const std::string& text) { return CLI::detail::split(text, ','); }

Option* Option::check(const Check& check) {
  option_->check(*check.validator_);
  return this;
}
Option* Option::type_name(const std::string& words) {
  option_->type_name(words);
  return this;
}
Option* Option::required() {
  option_->required();
  return this;
}
Option* Option::expected(int count) {
  option_->expected(count);
  return this;
}
Option* Option::expected(int least, int most) {
  option_->expected(least, most);
  return this;
}
Option* Option::delimiter(char c) {
  option_->delimiter(c);
  return this;
}
Option* Option::allow_extra_args(bool on) {
  option_->allow_extra_args(on);
  return this;
}
Option* Option::needs(Option* other) {
  option_->needs(other->option_);
  return this;
}
Option* Option::excludes(Option* other) {
  option_->excludes(other->option_);
  return this;
}
Option* Option::hidden() {
  option_->group("");
  return this;
}
Option* Option::capture_default_str() {
  option_->capture_default_str();
  return this;
}
Option* Option::default_str(const std::string& words) {
  option_->default_str(words);
  return this;
}
Option* Option::not_in_settings() {
  option_->configurable(false);
  return this;
}

App::App(const std::string& sentence, const std::string& name)
    : owned_(std::make_unique<CLI::App>(sentence, name)), app_(owned_.get()) {
  app_->set_version_flag("--version",
                         name + " " + kVersion + "\nbanks " + std::to_string(kBankVersion) + ", text files " +
                             std::to_string(kTextFileVersion) + ", protocol " +
                             std::to_string(protocol::kProtocolVersion),
                         "Prints the versions of the program and of what it reads and writes; followed by --json, "
                         "as one line of JSON.");
  app_->footer(protocol::exit_code_help());
}
App::App(CLI::App* verb) : app_(verb) {}
App::~App() = default;

Option* App::keep(CLI::Option* option) {
  options_.push_back(std::unique_ptr<Option>(new Option(option)));
  return options_.back().get();
}
App* App::keep(CLI::App* verb) {
  verbs_.push_back(std::unique_ptr<App>(new App(verb)));
  return verbs_.back().get();
}

template <class T>
Option* App::add_option(const std::string& names, T& value, const std::string& sentence) {
  return keep(app_->add_option(names, value, sentence));
}
template Option* App::add_option(const std::string&, int&, const std::string&);
template Option* App::add_option(const std::string&, std::size_t&, const std::string&);
template Option* App::add_option(const std::string&, std::uint16_t&, const std::string&);
template Option* App::add_option(const std::string&, double&, const std::string&);
template Option* App::add_option(const std::string&, std::string&, const std::string&);
template Option* App::add_option(const std::string&, std::filesystem::path&, const std::string&);
template Option* App::add_option(const std::string&, std::optional<int>&, const std::string&);
template Option* App::add_option(const std::string&, std::optional<std::size_t>&, const std::string&);
template Option* App::add_option(const std::string&, std::optional<std::uint16_t>&, const std::string&);
template Option* App::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option* App::add_option(const std::string&, std::optional<std::string>&, const std::string&);
template Option* App::add_option(const std::string&, std::optional<std::filesystem::path>&, const std::string&);
template Option* App::add_option(const std::string&, std::array<double, 2>&, const std::string&);
template Option* App::add_option(const std::string&, std::vector<int>&, const std::string&);
template Option* App::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option* App::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option* App::add_option(const std::string&, std::vector<std::filesystem::path>&, const std::string&);

template <class T>
Option* App::add_option_function(const std::string& names, std::function<void(const T&)> take,
                                 const std::string& sentence) {
  const auto take_it = [take = std::move(take)](const T& value) { in_words_of_cli11([&] { take(value); }); };
  return keep(app_->add_option_function<T>(names, take_it, sentence));
}
template Option* App::add_option_function(const std::string&, std::function<void(const int&)>, const std::string&);
template Option* App::add_option_function(const std::string&, std::function<void(const double&)>, const std::string&);
template Option* App::add_option_function(const std::string&, std::function<void(const std::string&)>,
                                          const std::string&);
template Option* App::add_option_function(const std::string&, std::function<void(const std::vector<std::string>&)>,
                                          const std::string&);

Option* App::add_numbered_choice(const std::string& names, const std::map<std::string, int>& words,
                                 std::function<void(int)> take, const std::string& sentence) {
  CLI::Option* option = app_->add_option_function<int>(
      names, [take = std::move(take)](const int& number) { take(number); }, sentence);
  return keep(option->transform(CLI::CheckedTransformer(words).description("")));
}

Option* App::add_flag(const std::string& names, bool& value, const std::string& sentence) {
  return keep(app_->add_flag(names, value, sentence));
}
Option* App::add_flag_function(const std::string& names, std::function<void()> act) {
  return keep(app_->add_flag_function(names, [act = std::move(act)](std::int64_t) { act(); }));
}

App* App::add_subcommand(const std::string& name, const std::string& sentence) {
  return keep(app_->add_subcommand(name, sentence));
}

void App::add_passing_verb(const std::string& name, const std::string& sentence,
                           std::function<void(std::vector<std::string>)> act) {
  CLI::App* verb = app_->add_subcommand(name, sentence);
  verb->set_help_flag();  // --help goes to the other program
  verb->prefix_command();
  verb->callback([verb, act = std::move(act)] { act(verb->remaining()); });
}

App* App::add_option_group(const std::string& name, const std::string& sentence) {
  return keep(app_->add_option_group(name, sentence));
}
void App::require_option(int count) { app_->require_option(count); }
void App::require_subcommand(int count) { app_->require_subcommand(count); }
void App::callback(std::function<void()> act) {
  app_->callback([act = std::move(act)] { in_words_of_cli11(act); });
}

std::string App::take(std::vector<std::string> words) {
  std::ranges::reverse(words);  // CLI11 reads backwards
  try {
    app_->parse(words);
    return "";
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
}

std::size_t App::count(const std::string& name) const { return app_->count(name); }

std::vector<std::string> App::given_options(const std::vector<std::string_view>& except) const {
  std::vector<std::string> words;
  for (const CLI::Option* option : std::as_const(*app_).get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || !name.starts_with('-') || std::ranges::find(except, name) != except.end()) continue;
    words.push_back(name);
    const bool is_flag = option->get_items_expected_max() == 0;
    if (!is_flag) words.insert(words.end(), option->results().begin(), option->results().end());
  }
  return words;
}

std::vector<App::Key> App::keys() const {
  std::vector<Key> keys;
  for (const CLI::Option* option : std::as_const(*app_).get_options()) {
    if (!option->get_configurable() || option->get_lnames().empty()) continue;
    keys.push_back({option->get_lnames().front(), option->get_expected_max() == 0, option->get_items_expected_max() > 1,
                    option->count() > 0});
  }
  return keys;
}

std::string App::set(const std::string& key, const std::vector<std::string>& words) {
  try {
    CLI::Option* option = app_->get_option("--" + key);
    option->add_result(words);
    option->run_callback();
    return "";
  } catch (const CLI::Error& error) {
    return error.what();
  }
}

namespace {

ExitCode print_versions_as_json(const std::string& program) {
  std::printf("{\"program\": \"%s\", \"version\": \"%s\", \"banks\": %d, \"text_files\": %d, \"protocol\": %d}\n",
              program.c_str(), kVersion, kBankVersion, kTextFileVersion, int{protocol::kProtocolVersion});
  return ExitCode::ok;
}

}  // namespace

std::optional<ExitCode> parse(App& app, int argc, char** argv, const std::vector<Section>& sections) {
  const std::string_view first = argc == 3 ? argv[1] : "";
  if (first == "--manual") return write_manual(app, argv[2], sections);
  if (first == "--version" && argv[2] == std::string_view("--json"))
    return print_versions_as_json(app.app_->get_name());
  try {
    app.app_->parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::Success& help_or_version) {
    app.app_->exit(help_or_version);
    return ExitCode::ok;
  } catch (const CLI::ParseError& error) {
    return complain_of_usage(app, error.what());
  } catch (const std::bad_alloc&) {
    return protocol::complain({ErrorKind::no_memory, "there is not enough memory for this"});
  }
}

ExitCode complain_of_usage(const App& app, const std::string& what) {
  std::string command = app.app_->get_name();
  for (const CLI::App* verb : app.app_->get_subcommands()) {
    if (!verb->get_name().empty()) command += " " + verb->get_name();
  }
  return protocol::complain(what + "; " + command + " --help lists the options", ExitCode::usage);
}

// The rows of a command, for its man page and its completions (command.h)

namespace {

std::string without_full_stop(std::string text) {
  if (text.ends_with('.')) text.pop_back();
  return text;
}

// CLI11 appends what the option's check demands to the name of the value's type, after a colon.
void read_value(CLI::Option& option, OptionRow& row) {
  row.value = option.get_type_name();
  try {
    row.accepted = option.get_validator(0)->get_description();
  } catch (const CLI::OptionNotFound&) {
    return;  // nothing is checked
  }
  if (!row.accepted.empty()) row.value.resize(row.value.size() - row.accepted.size() - 1);
}

OptionRow row_of(CLI::Option& option) {
  OptionRow row;
  for (const std::string& name : option.get_snames()) row.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) row.names.push_back("--" + name);
  if (row.names.empty()) row.names.push_back(option.get_name());
  if (option.get_expected_max() > 0) read_value(option, row);
  row.fallback = option.get_default_str();
  row.sentence = without_full_stop(option.get_description());
  row.required = option.get_required();
  row.repeats = option.get_items_expected_max() > 2;
  return row;
}

Command command_of(CLI::App& app) {
  Command command{.name = app.get_name(), .sentence = without_full_stop(app.get_description())};
  command.passes_on = app.get_prefix_command();
  for (CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) command.options.push_back(row_of(*option));
  }
  for (CLI::App* verb : app.get_subcommands([](CLI::App*) { return true; })) {
    Command inner = command_of(*verb);
    if (!inner.name.empty()) {
      command.commands.push_back(std::move(inner));
    } else {  // a group of options, not a verb; it has its own --help again
      for (OptionRow& option : inner.options) {
        if (option.names.back() != "--help") command.options.push_back(std::move(option));
      }
    }
  }
  return command;
}

}  // namespace

Command command_of(App& app) { return command_of(*app.app_); }

}  // namespace ringdown::manual
