// The command line that all programs have in common: options, verbs, --version, --manual, the exit codes below --help,
// one sentence for a mistake, and checks of values that --help and the man page describe in words. [main]
//
//   manual::App app("Does this and that.", "ringdown-thing");
//   app.add_option("--rate", rate, "Sample rate in Hz")->check(manual::between(8000.0, 768000.0));
//   if (const auto ended = manual::parse(app, argc, argv, kSections)) return *ended;
//
// CLI11 does the work, in command_line.cpp alone: it is a header of 10,000 lines, of which each file that includes it
// compiles its own copy.
#pragma once

#include "packaging/manual/man_page.h"
#include "protocol/exit_codes.h"

#include <concepts>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace ringdown::manual {

// A check of the text of a value. `wrong` returns what is wrong with it, or nothing; `demand` says in --help and on the
// man page what is accepted.
class Check {
 public:
  using Wrong = std::function<std::string(const std::string&)>;
  Check(const Wrong& wrong, const std::string& demand);
  template <std::convertible_to<Wrong> Function>
  Check(const Function& wrong) : Check(Wrong(wrong), "") {}

 private:
  friend class Option;
  friend Check one_of(std::initializer_list<const char*> words);
  explicit Check(std::shared_ptr<const CLI::Validator> validator) : validator_(std::move(validator)) {}
  std::shared_ptr<const CLI::Validator> validator_;
};

// Checks of numbers. Every option that takes a number has one of them: each refuses a text that is not a number, and a
// number that is not finite. What they demand beyond that stands in --help.
Check any_number();
Check any_vector();  // three numbers with commas between them, as one text
Check above_zero();
Check between(double low, double high);  // both included
Check between_integers(long long low, long long high);
template <std::integral Number>
Check between(Number low, Number high) {
  return between_integers(static_cast<long long>(low), static_cast<long long>(high));
}

// One of these words.
Check one_of(std::initializer_list<const char*> words);

// Returns what is wrong with `text` as a number from `low` to `high`, or nothing. [any]
std::string wrong_number(const std::string& text, double low, double high, const std::string& demand);

// The parts of `text` between the commas.
std::vector<std::string> split_at_commas(const std::string& text);

// Thrown by the function of an option for a value that it refuses; parsing ends with "option: sentence".
struct WrongValue {
  std::string option, sentence;
};

// An option that has been added. It lives as long as its App; each function returns it again.
class Option {
 public:
  Option* check(const Check& check);
  Option* type_name(const std::string& words);  // "FILE", "jack|wav|null"
  Option* required();
  Option* expected(int count);
  Option* expected(int least, int most);
  Option* delimiter(char c);          // between several values that are one text
  Option* allow_extra_args(bool on);  // whether it takes what follows its first value
  Option* needs(Option* other);
  Option* excludes(Option* other);
  Option* hidden();               // from --help
  Option* capture_default_str();  // --help shows what the variable holds now
  Option* default_str(const std::string& words);
  Option* not_in_settings();  // no key of a settings file

 private:
  friend class App;
  explicit Option(CLI::Option* option) : option_(option) {}
  CLI::Option* option_;
};

// A program, or one of its verbs.
class App {
 public:
  // With --version, and the exit codes below --help.
  App(const std::string& sentence, const std::string& name);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  // An option whose value goes to `value`, which must outlive the App. command_line.cpp lists the types.
  template <class T>
  Option* add_option(const std::string& names, T& value, const std::string& sentence);
  // One whose value a function takes: a std::string, an int, a double or a std::vector<std::string>. It may throw
  // WrongValue.
  template <class T>
  Option* add_option_function(const std::string& names, std::function<void(const T&)> take,
                              const std::string& sentence);
  // One of several words, each of which stands for a value.
  template <class T>
  Option* add_choice(const std::string& names, T& value, const std::map<std::string, T>& words,
                     const std::string& sentence) {
    std::map<std::string, int> numbers;
    for (const auto& [word, meaning] : words) numbers[word] = static_cast<int>(meaning);
    return add_numbered_choice(
        names, numbers, [&value](int number) { value = static_cast<T>(number); }, sentence);
  }
  Option* add_flag(const std::string& names, bool& value, const std::string& sentence);
  Option* add_flag_function(const std::string& names, std::function<void()> act);

  App* add_subcommand(const std::string& name, const std::string& sentence);
  // A verb that leaves everything after its name to `act`, --help too.
  void add_passing_verb(const std::string& name, const std::string& sentence,
                        std::function<void(std::vector<std::string>)> act);
  App* add_option_group(const std::string& name, const std::string& sentence);
  void require_option(int count);
  void require_subcommand(int count);
  void callback(std::function<void()> act);  // called when the verb was given, after its options

  // Takes the words of a command line, without the program's name. Returns what is wrong with them, or nothing; unlike
  // parse(), it prints nothing.
  std::string take(std::vector<std::string> words);

  // How often the command line has the option, by its name with dashes.
  [[nodiscard]] std::size_t count(const std::string& name) const;
  // The options that the command line has, as words for another one: {"--keep", "100", "--preview"}, in the order of
  // --help. Leaves out `except` (with dashes) and arguments that stand by their place.
  [[nodiscard]] std::vector<std::string> given_options(const std::vector<std::string_view>& except) const;

  // An option that may stand in a settings file: one with a long name.
  struct Key {
    std::string name;  // without dashes
    bool is_switch, is_list;
    bool given;  // on the command line
  };
  [[nodiscard]] std::vector<Key> keys() const;
  // Gives an option its values, as the command line does. Returns what is wrong with them, or nothing.
  std::string set(const std::string& key, const std::vector<std::string>& words);

 private:
  friend std::optional<protocol::ExitCode> parse(App& app, int argc, char** argv, const std::vector<Section>& sections);
  friend protocol::ExitCode complain_of_usage(const App& app, const std::string& what);
  friend Command command_of(App& app);
  explicit App(CLI::App* verb);
  Option* keep(CLI::Option* option);
  App* keep(CLI::App* verb);
  Option* add_numbered_choice(const std::string& names, const std::map<std::string, int>& words,
                              std::function<void(int)> take, const std::string& sentence);

  std::unique_ptr<CLI::App> owned_;  // of the program; a verb belongs to its program
  CLI::App* app_ = nullptr;
  std::vector<std::unique_ptr<Option>> options_;
  std::vector<std::unique_ptr<App>> verbs_;
};

// Parses the command line. Returns the exit code of a program that has nothing left to do: after --help, --version,
// `--version --json` or `--manual man|bash|zsh|fish`, which stands alone and writes the man page or a completion script
// to the standard output for the build, and after a mistake or, in a verb that ran while it was parsed, a lack of
// memory: then one sentence is on the standard error.
std::optional<protocol::ExitCode> parse(App& app, int argc, char** argv, const std::vector<Section>& sections = {});

// Says what is wrong with a command line that was parsed, and names the --help that lists the options.
protocol::ExitCode complain_of_usage(const App& app, const std::string& what);

}  // namespace ringdown::manual
