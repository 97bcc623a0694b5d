// Every number option of every program, found in its --help, refuses what is not a finite number.
#include "tests/integration/process.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

// Types of values that are texts. Whatever else --help names after an option is taken for a number, so that a new
// option is tried unless it is declared to be a text.
const std::regex kTexts(
    R"(^(FILE(\.png)?|FOLDER|BANK|PREFIX|TEXT|NAME|URL|NAME=BANK|NODE=MATERIAL|osc\.udp://HOST:PORT|)"
    R"(jack\|.*|mix\|.*|spectrum\|.*|tet20\|.*|auto\|.*|dark\|.*|scene\|.*|receptance\|.*|MODE\|BAND|Excludes:|Needs:)([ =].*)?$)");

// How a value is written for types that hold more than a number. What stands for it is V.
const std::map<std::string, Words> kForms = {
    {"X,Y,Z", {"0,V,1"}},         {"X Y Z", {"0", "V", "1"}},       {"LOW HIGH", {"V", "V"}},
    {"WIDTH HEIGHT", {"V", "V"}}, {"NAME=NUMBER", {"size=V"}},      {"NAME:LOW..HIGH", {"size:V..V"}},
    {"LOW..HIGH", {"V..V"}},      {"[FAMILY:]MODE=VALUE", {"1=V"}}, {"OBJECT[:X,Y,Z[:FX,FY,FZ]]", {"bell:V,0,0"}},
    {"FRAMES|MSms", {"V"}},
};

// Arguments without which some programs refuse a command line before they look at numbers.
const std::map<std::string, Words> kNeeded = {
    {"ringdown-bake", {"box.geo", "-o", "box.glb", "--material", "steel"}},
    {"ringdown-tune", {"bar.toml", "-o", "tuned.toml", "--vary", "length:1..2", "--target", "1=A4"}},
    {"ringdown-compare", {"my-bowl"}},
    {"ringdown-fill", {"cup.glb", "-o", "full.glb"}},
    {"ringdown-fit", {"cup.wav"}},
    {"ringdown foley", {"fall.glb", "-o", "fall.wav"}},
    {"ringdown scene export", {"demo", "-o", "demo.glb"}},
    {"ringdown strike", {"bell", "--impulse", "1,0,0"}},
};

std::string joined(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

struct NumberOption {
  std::string name, type;
};

// The options of one command line whose values are no texts, and the verbs below it.
struct CommandLine {
  std::vector<NumberOption> numbers;
  Words verbs;
};

CommandLine read_help(const Words& command) {
  Words asked = command;
  asked[0] = RINGDOWN_BIN_DIR "/" + asked[0];
  asked.emplace_back("--help");
  std::istringstream lines(run(asked).output);
  const std::regex option(R"(^ +(?:-\w,)?(--?[\w-]+) (\S.*?)(  .*)?$)"), verb(R"(^  ([a-z]+)  .*)");
  CommandLine found;
  bool is_own = false, in_verbs = false;
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    is_own = is_own || line.starts_with("Usage: " + joined(command) + " ");  // not of a program that a verb becomes
    in_verbs = line == "Subcommands:" || (in_verbs && line.starts_with(" "));
    if (!is_own) continue;
    if (in_verbs && std::regex_match(line, match, verb)) found.verbs.push_back(match[1]);
    if (!std::regex_match(line, match, option) || std::regex_match(match[2].str(), kTexts)) continue;
    found.numbers.push_back({match[1], match[2]});
  }
  return found;
}

Words value_of(const NumberOption& option, const std::string& number) {
  Words words = {"V"};
  std::size_t longest = 0;
  for (const auto& [type, form] : kForms) {
    if (option.type.starts_with(type) && type.size() > longest) words = form, longest = type.size();
  }
  for (std::string& word : words) {
    for (std::size_t at; (at = word.find('V')) != word.npos;) word.replace(at, 1, number);
  }
  return words;
}

// Tries all number options of a command line and of its verbs. Returns how many there are.
std::size_t try_numbers(const Words& command, const fs::path& folder) {
  const CommandLine line = read_help(command);
  for (const NumberOption& option : line.numbers) {
    for (const char* number : {"nan", "inf", "-inf", "1e999", ""}) {
      Words words = {"env", "-C", folder, RINGDOWN_BIN_DIR "/" + command[0]};
      words.insert(words.end(), command.begin() + 1, command.end());
      if (const auto needed = kNeeded.find(joined(command)); needed != kNeeded.end()) {
        words.insert(words.end(), needed->second.begin(), needed->second.end());
      }
      if (const auto given = std::ranges::find(words, option.name); given != words.end()) {
        words.erase(given, given + 2);
      }
      const Words value = value_of(option, number);
      words.push_back(option.name);
      if (value.size() == 1 && !value[0].empty()) {
        words.back() += "=" + value[0];  // or -inf would be an option
      } else {
        words.insert(words.end(), value.begin(), value.end());
      }
      const Outcome ran = run(words);
      EXPECT_EQ(ran.exit_code, 2) << joined(words) << ":\n" << ran.output;
      EXPECT_EQ(std::ranges::count(ran.output, '\n'), 1) << joined(words) << ":\n" << ran.output;
      EXPECT_NE(ran.output.find(option.name), std::string::npos) << joined(words) << ":\n" << ran.output;
    }
  }
  std::size_t count = line.numbers.size();
  for (const std::string& verb : line.verbs) {
    Words below = command;
    below.push_back(verb);
    count += try_numbers(below, folder);
  }
  return count;
}

TEST(Numbers, EveryNumberOptionOfEveryProgramRefusesWhatIsNotFinite) {
  const TemporaryFolder folder;
  std::size_t count = 0, programs = 0;
  for (const auto& entry : fs::directory_iterator(RINGDOWN_BIN_DIR)) {
    const std::string name = entry.path().filename();
    if (name == "ringdown-modes-slepc" || name == "ringdown-mesher") continue;  // other programs start them
    if (!entry.is_regular_file() || !name.starts_with("ringdown")) continue;
    ++programs;
    count += try_numbers({name}, folder.path());
  }
  EXPECT_GE(programs, 3u);
  EXPECT_GE(count, 25u);
  EXPECT_TRUE(fs::is_empty(folder.path())) << "a refused command line wrote a file";
  RecordProperty("options", static_cast<int>(count));
}

// Through the settings file, the numbers of options meet the checks of the command line.
TEST(Numbers, ASettingThatIsNotFiniteIsRefused) {
  const TemporaryFolder folder;
  for (const char* setting :
       {"rate = nan", "merge = inf", "budget = -inf", "limiter = nan", "port = nan", "port = \"\""}) {
    const fs::path file = folder.write("settings.toml", setting);
    const Outcome ran = run({RINGDOWN_BIN_DIR "/ringdownd", "--driver", "null", "--settings", file, "--seconds", "0"});
    EXPECT_EQ(ran.exit_code, 3) << setting << ": " << ran.output;
    EXPECT_NE(ran.output.find("settings.toml"), std::string::npos) << setting << ": " << ran.output;
  }
}

TEST(Numbers, ASceneOrAStateWithANumberThatIsNotFiniteIsRefused) {
  const TemporaryFolder folder;
  for (const char* number : {"nan", "inf", "-inf"}) {
    const fs::path scene = folder.write("scene.toml", std::string("[scene]\nduration_s = ") + number + "\n");
    const Outcome rendered = run({RINGDOWN_BIN_DIR "/ringdown", "render", "--scene", scene, "-o", folder / "a.wav"});
    EXPECT_EQ(rendered.exit_code, 3) << rendered.output;
    EXPECT_NE(rendered.output.find("duration_s"), std::string::npos) << rendered.output;
    const fs::path state = folder.write(
        "state.toml", std::string("version = 1\n[[object]]\nname = \"a\"\nbank = \"a.glb\"\ngain = ") + number + "\n");
    const Outcome started = run({RINGDOWN_BIN_DIR "/ringdownd", "--driver", "null", "--port", "0", "--settings", "none",
                                 "--seconds", "0", "--state", state});
    EXPECT_EQ(started.exit_code, 3) << started.output;
    EXPECT_NE(started.output.find("gain"), std::string::npos) << started.output;
  }
}

}  // namespace
}  // namespace ringdown::test
