// The man pages and completion scripts that the programs write: nothing that --help has is missing there, and the tools
// that read them, groff and the shells themselves, find no fault.
#include "engine/base/formatted.h"
#include "packaging/manual/command.h"
#include "packaging/manual/command_line.h"
#include "packaging/manual/man_page.h"
#include "tests/integration/process.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

namespace ringdown::test {
namespace {

const std::string kShare = RINGDOWN_BIN_DIR "/../share/";
const std::vector<std::string> kPrograms = {"ringdownd",     "ringdown",         "ringdown-bake",  "ringdown-check",
                                            "ringdown-fill", "ringdown-tune",    "ringdown-fit",   "ringdown-compare",
                                            "ringdown-frf",  "ringdown-picture", "ringdown-viewer"};

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string program(const std::string& name) { return RINGDOWN_BIN_DIR "/" + name; }
std::string man(const std::string& name) { return kShare + "man/man1/" + name + ".1"; }
std::string bash(const std::string& name) { return kShare + "bash-completion/completions/" + name; }
std::string zsh(const std::string& name) { return kShare + "zsh/vendor-completions/_" + name; }
std::string fish(const std::string& name) { return kShare + "fish/vendor_completions.d/" + name + ".fish"; }

// The options that begin a line of --help.
std::set<std::string> options_in_help(const std::vector<std::string>& command) {
  const std::string help = run(command).output;
  const std::regex row(R"((?:^|\n) +((?:-\w,)?--?[\w-]+))");
  std::set<std::string> names;
  for (std::sregex_iterator found(help.begin(), help.end(), row), end; found != end; ++found) {
    std::istringstream list((*found)[1].str());
    for (std::string name; std::getline(list, name, ',');) names.insert(name);
  }
  return names;
}

struct CommandLine {
  std::string program, verb;  // verb: "" for the program's own options
  [[nodiscard]] std::set<std::string> options() const {
    return options_in_help(verb.empty() ? std::vector{test::program(program), std::string("--help")}
                                        : std::vector{test::program(program), verb, std::string("--help")});
  }
};

const std::vector<CommandLine> kCommandLines = {
    {"ringdownd", ""},        {"ringdown", ""},       {"ringdown", "info"},       {"ringdown", "materials"},
    {"ringdown", "scale"},    {"ringdown", "render"}, {"ringdown", "strike"},     {"ringdown", "send"},
    {"ringdown", "protocol"}, {"ringdown-bake", ""},  {"ringdown-check", "mesh"}, {"ringdown-tune", ""},
    {"ringdown-fill", ""},    {"ringdown-fit", ""},   {"ringdown-compare", ""},   {"ringdown-frf", ""},
    {"ringdown-picture", ""}, {"ringdown-viewer", ""}};

std::string man_text(const std::string& name) { return run({"groff", "-man", "-Tascii", "-P-cbou", man(name)}).output; }

// What a real bash offers at the end of `line`.
std::vector<std::string> bash_offers(const std::string& name, const std::string& line) {
  const std::string script = "source " + bash(name) + "; COMP_WORDS=(" + line +
                             "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); " + "$(complete -p " + name +
                             " | sed 's/.*-F \\([^ ]*\\) .*/\\1/'); printf '%s\\n' \"${COMPREPLY[@]}\"";
  std::istringstream lines(run({"bash", "--norc", "-c", script}).output);
  std::vector<std::string> offers;
  for (std::string offer; std::getline(lines, offer);) {
    if (!offer.empty()) offers.push_back(offer);
  }
  return offers;
}

TEST(Manual, EveryOptionOfHelpIsInTheManPage) {
  for (const CommandLine& command : kCommandLines) {
    const std::string page = man_text(command.program);
    const auto options = command.options();
    EXPECT_GE(options.size(), 1u) << command.program << " " << command.verb;
    for (const std::string& option : options) {
      EXPECT_TRUE(std::regex_search(page, std::regex("\n +(.*, )?" + option + "[, \n]")))
          << option << " is not in the man page of " << command.program;
    }
  }
}

TEST(Manual, EveryOptionOfHelpIsOfferedByBash) {
  for (const CommandLine& command : kCommandLines) {
    const std::string line = command.program + " " + command.verb + " -";
    const auto offers = bash_offers(command.program, line);
    const std::set<std::string> offered(offers.begin(), offers.end());
    EXPECT_EQ(offered, command.options()) << line;
  }
}

TEST(Manual, BashCompletesValuesVerbsAndFiles) {
  const auto offers = [](const std::string& line) { return bash_offers(line.substr(0, line.find(' ')), line); };
  using Words = std::vector<std::string>;
  EXPECT_EQ(offers("ringdownd --driver n"), Words{"null"});
  EXPECT_EQ(offers("ringdownd --driver = w"), Words{"wav"});
  EXPECT_EQ(offers("ringdown-bake --solver sp"), Words{"spectra"});
  EXPECT_EQ(offers("ringdown-bake --jo"), Words{"--jobs"});
  EXPECT_EQ(offers("ringdown re"), Words{"render"});
  EXPECT_EQ(offers("ringdown render --sce"), Words{"--scene"});
  EXPECT_EQ(offers("ringdown render --scene " RINGDOWN_SOURCE_DIR "/READ"), Words{RINGDOWN_SOURCE_DIR "/README.md"});
  EXPECT_EQ(offers("ringdown info " RINGDOWN_SOURCE_DIR "/READ"), Words{RINGDOWN_SOURCE_DIR "/README.md"});
  EXPECT_EQ(offers("ringdownd --rate 4"), Words{});
}

TEST(Manual, EveryOptionOfHelpIsKnownToZshAndFish) {
  for (const CommandLine& command : kCommandLines) {
    const std::string for_zsh = text_of(zsh(command.program)), for_fish = text_of(fish(command.program));
    for (const std::string& option : command.options()) {
      EXPECT_NE(for_zsh.find(option), std::string::npos) << option;
      const std::string word = option.starts_with("--") ? " -l " + option.substr(2) : " -s " + option.substr(1);
      EXPECT_NE(for_fish.find(word + " "), std::string::npos) << option;
    }
  }
}

TEST(Manual, VersionsForProgramsAreThoseForPeople) {
  for (const std::string& name : kPrograms) {
    if (name == "ringdown-viewer" && !std::filesystem::exists(program(name))) continue;
    const std::string said = run({program(name), "--version"}).output;
    const std::regex words(R"((\S+) ([0-9.]+)\nbanks (\d+), text files (\d+), protocol (\d+)\n)");
    std::smatch parts;
    ASSERT_TRUE(std::regex_match(said, parts, words)) << said;
    const std::string read =
        "import json, sys; v = json.load(sys.stdin); print(*(v[key] for key in "
        "('program', 'version', 'banks', 'text_files', 'protocol')))";
    const Outcome json =
        run({"sh", "-c", "'" + program(name) + "' --version --json | /usr/bin/python3 -c \"" + read + "\""});
    EXPECT_EQ(json.output,
              formatted("{} {} {} {} {}\n", parts.str(1), parts.str(2), parts.str(3), parts.str(4), parts.str(5)));
  }
}

TEST(Manual, GroffFindsNoFaultInTheManPages) {
  if (!installed("groff")) GTEST_SKIP() << "groff is not installed";
  for (const std::string& name : kPrograms) {
    const Outcome checked = run({"groff", "-man", "-ww", "-z", "-Tutf8", man(name)});
    EXPECT_EQ(checked.exit_code, 0) << name;
    EXPECT_EQ(checked.output, "") << name;
    EXPECT_NE(man_text(name).find("EXIT STATUS"), std::string::npos);
  }
}

TEST(Manual, ShellsFindNoFaultInTheCompletionScripts) {
  for (const std::string& name : kPrograms) {
    EXPECT_EQ(run({"bash", "-n", bash(name)}).output, "");
    if (installed("zsh")) {
      EXPECT_EQ(run({"zsh", "-n", zsh(name)}).output, "");
    }
    if (installed("fish")) {
      EXPECT_EQ(run({"fish", "--no-execute", fish(name)}).output, "");
    }
  }
}

TEST(Manual, FishCompletesOptionsAndVerbs) {
  if (!installed("fish")) GTEST_SKIP() << "fish is not installed";
  const auto offers = [](const std::string& line) {
    const std::string name = line.substr(0, line.find(' '));
    return run({"fish", "--no-config", "-c", "source " + fish(name) + "; complete -C '" + line + "'"}).output;
  };
  EXPECT_NE(offers("ringdownd --dri").find("--driver"), std::string::npos);
  EXPECT_NE(offers("ringdownd --driver ").find("null"), std::string::npos);
  EXPECT_NE(offers("ringdown re").find("render"), std::string::npos);
  EXPECT_NE(offers("ringdown render --sc").find("--scene"), std::string::npos);
}

// What the text of an option must not do to the page around it.
TEST(Manual, TheManPageShowsEveryCharacterOfAnOptionsText) {
  manual::App app("Does - what's said.", "thing");
  std::string value;
  app.add_option("--dash-ed", value, ".starts with a dot, a \\ and 'quotes'");
  const std::string page = manual::man_page(manual::command_of(app), {});
  EXPECT_NE(page.find("\\-\\-dash\\-ed"), std::string::npos) << page;
  EXPECT_NE(page.find("\n\\&.starts with a dot, a \\e and"), std::string::npos) << page;
}

}  // namespace
}  // namespace ringdown::test
