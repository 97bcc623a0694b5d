// The strict reader, by what it takes and the sentences with which it refuses. The files that use it have tests of
// their own (tests/bake/presets_test.cpp, tests/scene/scene_file_test.cpp).
#include "engine/base/toml_table.h"

#include <gtest/gtest.h>

#include <functional>

namespace ringdown {
namespace {

using Reader = std::function<void(TomlTable&)>;

// The sentence with which a file of this text is refused; "" when it is not.
std::string complaint(const std::string& text, const Reader& read) {
  Result<TomlTable> file = TomlTable::parse(text, "a.toml");
  if (!file) return file.error().message;
  read(*file);
  const Result<void> done = file->finish();
  return done ? "" : done.error().message;
}

TEST(TomlTable, ValuesOfEveryKindAreRead) {
  std::string text = "none";
  bool boolean = false;
  double number = 0, integer = 0;
  std::uint64_t whole = 0;
  Vec3 vector;
  std::vector<double> numbers;
  std::map<std::string, double> named;
  int choice = -1;
  EXPECT_EQ(complaint("text = 'bell'\nboolean = true\nnumber = 2.5\ninteger = 3\nwhole = 9\nvector = [1, 2.5, -3]\n"
                      "numbers = [4, 5]\nnamed = { a = 1, b = 2 }\nchoice = 'two'\n",
                      [&](TomlTable& file) {
                        file.require({"text", "choice"});
                        file.text("text", text);
                        file.boolean("boolean", boolean);
                        file.number("number", number, {0, 3});
                        file.number("integer", integer);
                        file.whole("whole", whole, 9, 9);
                        file.vector("vector", vector, {-3, 3});
                        file.numbers("numbers", numbers);
                        file.named_numbers("named", named);
                        choice = file.choice("choice", {"one", "two"});
                      }),
            "");
  EXPECT_EQ(text, "bell");
  EXPECT_TRUE(boolean);
  EXPECT_EQ(number, 2.5);
  EXPECT_EQ(integer, 3);
  EXPECT_EQ(whole, 9u);
  EXPECT_EQ(vector, (Vec3{1, 2.5, -3}));
  EXPECT_EQ(numbers, (std::vector<double>{4, 5}));
  EXPECT_EQ(named, (std::map<std::string, double>{{"a", 1}, {"b", 2}}));
  EXPECT_EQ(choice, 1);
}

TEST(TomlTable, AKeyThatIsAbsentOrWrongLeavesItsTargetUnchanged) {
  double absent = 7, wrong = 8;
  EXPECT_NE(complaint("wrong = 100\n",
                      [&](TomlTable& file) {
                        file.number("absent", absent, {0, 9});
                        file.number("wrong", wrong, {0, 9});
                        EXPECT_FALSE(file.table("absent"));
                        EXPECT_TRUE(file.tables("absent").empty());
                        EXPECT_EQ(file.choice("absent", {"one"}), -1);
                      }),
            "");
  EXPECT_EQ(absent, 7);
  EXPECT_EQ(wrong, 8);
}

TEST(TomlTable, EveryErrorBeginsWithFileAndLine) {
  double number = 0;
  std::uint64_t whole = 0;
  Vec3 vector;
  std::vector<double> numbers;
  std::map<std::string, double> named;
  const struct {
    std::string text;
    Reader read;
    std::string sentence;
  } cases[] = {
      {"\na = = 1\n", [](TomlTable&) {}, "a.toml:2: not TOML: "},
      {"\na = 1\n", [](TomlTable&) {}, "a.toml:2: unknown key 'a'; "},
      {"\n", [](TomlTable& file) { file.require({"a"}); }, "a.toml:1: the key a is missing"},
      {"\na = inf\n", [&](TomlTable& file) { file.number("a", number); }, "a.toml:2: a must be a finite number"},
      {"\na = nan\n",
       [&](TomlTable& file) {
         file.number("a", number, {0, 1});
       },
       "a.toml:2: a = nan is outside 0 ... 1"},
      {"a = true\n",
       [&](TomlTable& file) {
         file.number("a", number, {0, 1});
       },
       "a.toml:1: a must be a number"},
      {"a = -1\n", [&](TomlTable& file) { file.whole("a", whole); }, "a.toml:1: a must be a whole number >= 0"},
      {"a = 1.0\n", [&](TomlTable& file) { file.whole("a", whole); }, "a.toml:1: a must be a whole number >= 0"},
      {"a = 9\n", [&](TomlTable& file) { file.whole("a", whole, 1, 8); },
       "a.toml:1: a must be a whole number >= 1 and <= 8"},
      {"a = [1, 2]\n",
       [&](TomlTable& file) {
         file.vector("a", vector, {0, 9});
       },
       "a.toml:1: a must be three numbers [x, y, z]"},
      {"a = [1, 2, 99]\n",
       [&](TomlTable& file) {
         file.vector("a", vector, {0, 9});
       },
       "a.toml:1: a: 99 is outside 0 ... 9"},
      {"a = [1, 'x']\n", [&](TomlTable& file) { file.numbers("a", numbers); },
       "a.toml:1: a must be a list of finite numbers"},
      {"[a]\nb = 'x'\n", [&](TomlTable& file) { file.named_numbers("a", named); },
       "a.toml:2: [a]: b must be a finite number"},
      {"a = 'x'\n",
       [](TomlTable& file) {
         file.choice("a", {"one", "two"});
       },
       "a.toml:1: a must be one of \"one\", \"two\""},
      {"[a]\n", [](TomlTable& file) { file.tables("a"); }, "a.toml:1: a must be written as [[a]]"},
      {"\n[a]\n",
       [](TomlTable& file) {
         file.complain("a", "no");
         file.complain("b", "yes");
       },
       "a.toml:2: no"},
  };
  for (const auto& [text, read, sentence] : cases) {
    EXPECT_EQ(complaint(text, read).substr(0, sentence.size()), sentence) << text;
  }
}

TEST(TomlTable, ErrorsInInnerTablesNameTheTable) {
  double number = 0;
  EXPECT_EQ(complaint("[[body]]\nname = 'bell'\n[[body]]\nname = 'bowl'\nturn = { by = 'much' }\n",
                      [&](TomlTable& file) {
                        for (TomlTable& body : file.tables("body")) {
                          std::string name;
                          body.text("name", name);
                          if (auto turn = body.table("turn")) turn->number("by", number);
                        }
                      }),
            "a.toml:5: body 'bowl': turn: by must be a finite number");
  EXPECT_EQ(complaint("[[body]]\nsize = 1\n", [](TomlTable& file) { file.tables("body"); }).substr(0, 42),
            "a.toml:2: [[body]]: unknown key 'size'; re");
}

// What somebody forgot to read is an error in every table that was opened, whatever came before it.
TEST(TomlTable, UnknownKeysOfInnerTablesAreErrors) {
  double number = 0;
  EXPECT_EQ(complaint("a = 1\n[inner]\nb = 2\nc = 3\n",
                      [&](TomlTable& file) {
                        file.number("a", number);
                        if (auto inner = file.table("inner")) inner->number("b", number);
                        if (auto again = file.table("inner")) again->number("b", number);
                      })
                .substr(0, 35),
            "a.toml:4: [inner]: unknown key 'c';");
}

TEST(TomlTable, TheFirstMistakeIsTheOneReported) {
  double number = 0;
  EXPECT_EQ(complaint("unknown = 1\na = 'x'\nb = 'y'\n",
                      [&](TomlTable& file) {
                        file.number("b", number);
                        file.number("a", number);
                      }),
            "a.toml:3: b must be a finite number");
}

TEST(TomlTable, AFileMaySayItsVersion) {
  const Reader nothing = [](TomlTable&) {};
  EXPECT_EQ(complaint("version = 1\n", nothing), "");
  EXPECT_NE(complaint("\nversion = 2\n", nothing).find("a.toml:2: the file is of version 2"), std::string::npos)
      << complaint("\nversion = 2\n", nothing);
  EXPECT_NE(complaint("version = 0\n", nothing), "");
  EXPECT_NE(complaint("version = '1'\n", nothing), "");
}

TEST(TomlTable, AMissingOrEndlessTomlFileIsRefused) {
  EXPECT_NE(TomlTable::read("/nowhere/a.toml").error().message.find("/nowhere/a.toml"), std::string::npos);
  EXPECT_FALSE(TomlTable::read("/dev/zero"));
}

TEST(TomlTable, TextsThatTheParserAssumesImpossibleAreRefused) {
  for (const char* text : {"[*scene]", "[ *a]", "[[*a]]", "[.a]", "[\"", "x = 1 \u0391", "\u0391 = 1", "x = \u0391"}) {
    EXPECT_NE(complaint(text, [](TomlTable&) {}), "") << text;
  }
  EXPECT_EQ(complaint("\n\nx = \"\"\"a\\\n \u0391\"\"\"", [](TomlTable&) {}).substr(0, 17), "a.toml:3: not TOM");
}

TEST(TomlTable, LettersBeyondAsciiMayStandInStringsAndComments) {
  for (const char* text :
       {"x = \"\u0391\"  # \u0391", "\uFEFFx = '\\'#'\u0391\n", "x = '\u0391'", "x = \"\\\"\u0391\\\\\" # \"\u0391",
        "x = '''\n\u0391'\u0391''\u0391'''''#\u0391", "x = \"\"\"\u0391\\\"\"\"\u0391\\\n a\u0391\"\"\"\"\" # \u0391",
        "# '\u0391\nx = \"\"\"\"\u0391\"\"\""}) {
    std::string read;
    EXPECT_EQ(complaint(text, [&](TomlTable& file) { file.text("x", read); }), "") << text;
    EXPECT_NE(read, "") << text;
  }
}

}  // namespace
}  // namespace ringdown
