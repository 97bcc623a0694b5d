// What the documents promise about the tree.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = RINGDOWN_SOURCE_DIR;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Documents, EveryPackageHasItsReason) {
  std::istringstream packages(text_of(kRoot / "packages.txt"));
  const std::string reasons = text_of(kRoot / "docs/how/dependencies.md");
  int count = 0;
  for (std::string line; std::getline(packages, line);) {
    if (line.empty() || line.front() == '#') continue;
    EXPECT_NE(reasons.find(line), std::string::npos) << line << " is not in docs/how/dependencies.md";
    ++count;
  }
  EXPECT_GT(count, 20);
}

// README, SECURITY, CHANGELOG, and all pages below docs.
std::vector<fs::path> pages() {
  std::vector<fs::path> found = {kRoot / "README.md", kRoot / "SECURITY.md", kRoot / "CHANGELOG.md"};
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "docs")) {
    if (entry.path().extension() == ".md") found.push_back(entry.path());
  }
  return found;
}

// The pages below docs in one text.
std::string documentation() {
  std::string text;
  for (const fs::path& page : pages()) {
    if (page.parent_path() != kRoot) text += text_of(page);
  }
  return text;
}

// Source files of the programs, and whatever else below `folders` is text and names pages.
std::vector<fs::path> files_below(const std::vector<std::string>& folders, const std::set<std::string>& endings) {
  std::vector<fs::path> found;
  for (const std::string& folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (entry.is_regular_file() && endings.contains(entry.path().extension().string())) found.push_back(entry.path());
    }
  }
  return found;
}

// What the first group of `pattern` matches in `text`.
std::set<std::string> matches(const std::string& text, const std::regex& pattern) {
  std::set<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match)
    found.insert((*match)[1]);
  return found;
}

// Whether `word` stands in `text` by itself, not as a part of a longer name.
bool has_word(const std::string& text, const std::string& word) {
  const auto goes_on = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-'; };
  for (auto at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
    if (at > 0 && goes_on(text[at - 1])) continue;
    if (at + word.size() == text.size() || !goes_on(text[at + word.size()])) return true;
  }
  return false;
}

// The anchor that a heading gets: lower case, blanks as hyphens, punctuation dropped.
std::set<std::string> anchors_of(const fs::path& page) {
  std::set<std::string> anchors;
  std::istringstream text(text_of(page));
  for (std::string line; std::getline(text, line);) {
    const auto begin = line.find_first_not_of('#');
    if (begin == 0 || begin == line.npos || line[begin] != ' ') continue;
    std::string anchor;
    for (const char c : line.substr(begin + 1)) {
      const auto byte = static_cast<unsigned char>(c);
      if (std::isalnum(byte) || c == '-' || c == '_' || byte >= 0x80) anchor += static_cast<char>(std::tolower(byte));
      if (c == ' ') anchor += '-';
    }
    anchors.insert(anchor);
  }
  return anchors;
}

TEST(Documents, EveryLinkLeadsToAFileAndItsHeading) {
  const std::regex link(R"(\]\(([^)\s:]+)\))");
  std::size_t count = 0;
  for (const fs::path& page : pages()) {
    for (const std::string& whole : matches(text_of(page), link)) {
      const auto hash = whole.find('#');
      const fs::path target = hash == 0 ? page : page.parent_path() / whole.substr(0, hash);
      ASSERT_TRUE(fs::exists(target)) << page << " links to " << whole;
      if (hash != whole.npos) {
        EXPECT_TRUE(anchors_of(target).contains(whole.substr(hash + 1))) << page << " links to " << whole;
      }
      ++count;
    }
  }
  EXPECT_GT(count, 50u);
}

TEST(Documents, TheIndexListsEveryPage) {
  const std::string index = text_of(kRoot / "docs/README.md");
  for (const fs::path& page : files_below({"docs"}, {".md"})) {
    const std::string name = fs::relative(page, kRoot / "docs").string();
    if (name == "README.md" || name.starts_with("figures/")) continue;
    EXPECT_NE(index.find("](" + name), index.npos) << "docs/README.md does not list " << name;
  }
}

TEST(Documents, TheReadmeCountsMaterialsRightly) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(kRoot / "presets/materials"))
    count += entry.path().extension() == ".toml";
  EXPECT_NE(text_of(kRoot / "README.md").find("one of " + std::to_string(count) + " materials"), std::string::npos)
      << count;
}

TEST(Documents, EveryPathBelowDocsThatAFileNamesExists) {
  const std::regex path(R"((?:^|[^\w/.-])(docs/[\w./-]*[a-z0-9])(?!\w|[\w-]*\$))");
  std::vector<fs::path> files =
      files_below({"engine", "protocol", "server", "clients", "packaging", "presets", "tests", "docs"},
                  {".cpp", ".h", ".txt", ".py", ".sh", ".md", ".toml", ".geo", ".js", ".scd", ".pd", ".in", ".1"});
  for (const char* name : {"run", "README.md", "CONTRIBUTING.md", "SECURITY.md", "CMakeLists.txt", "packages.txt"})
    files.push_back(kRoot / name);
  std::size_t count = 0;
  for (const fs::path& file : files) {
    for (const std::string& name : matches(text_of(file), path)) {
      EXPECT_TRUE(fs::exists(kRoot / name)) << file << " names " << name;
      ++count;
    }
  }
  EXPECT_GT(count, 40u);
}

TEST(Documents, EveryOptionOfTheProgramsIsNamed) {
  const std::string text = documentation();
  const std::regex option(R"re("(?:-\w,)?(--[a-z][a-z-]+)")re");
  const std::set<std::string> for_the_build = {"--manual",
                                               "--masking"};  // no user needs them: --help does not list them
  std::set<std::string> options;
  for (const fs::path& file : files_below({"engine/bake", "server", "clients", "packaging/manual"}, {".cpp", ".h"})) {
    options.merge(matches(text_of(file), option));
  }
  EXPECT_GT(options.size(), 80u);
  for (const std::string& name : options) {
    if (for_the_build.contains(name)) continue;
    EXPECT_TRUE(has_word(text, name)) << name << " is on no page of docs";
  }
}

TEST(Documents, EveryKeyOfAFileThatUsersWriteIsNamed) {
  const std::string text = documentation();
  const std::regex key(
      R"re((?:(?:table|file|note|tables|text|number|numbers|whole|fraction|boolean|choice|vector|named_numbers|read_optional)\((?:\w+, )?"|\n +\{")([a-z][a-z_0-9]+)")re");
  std::size_t count = 0;
  for (const std::string reader : {"engine/scene/scene_file.cpp", "engine/bake/object_file.cpp",
                                   "engine/materials/material_library.cpp", "server/session/note_map_file.cpp"}) {
    std::string code = text_of(kRoot / reader);
    if (reader == "engine/bake/object_file.cpp") code += text_of(kRoot / "engine/bake/recipe_options.cpp");
    const std::set<std::string> keys = matches(code, key);
    EXPECT_GT(keys.size(), 4u) << reader;
    for (const std::string& name : keys) {
      EXPECT_TRUE(has_word(text, name)) << name << " of " << reader << " is on no page of docs";
    }
    count += keys.size();
  }
  EXPECT_GT(count, 80u);
}

// docs/figures/presets_page.py writes both.
TEST(Documents, EveryPresetHasItsRowAndEveryBankItsPicture) {
  const std::string page = text_of(kRoot / "docs/use/presets.md");
  int count = 0;
  for (const auto& entry : fs::directory_iterator(kRoot / "presets/objects")) {
    if (entry.path().extension() != ".toml") continue;
    const std::string name = entry.path().stem().string();
    EXPECT_NE(page.find("| `" + name + "`: "), std::string::npos) << name << " has no row: ./run docs";
    ++count;
    if (!fs::exists(kRoot / "presets/banks" / (name + ".glb"))) continue;
    const fs::path picture = kRoot / "docs/figures/presets" / (name + ".png");
    ASSERT_TRUE(fs::exists(picture)) << picture << " is missing: ./run docs";
    EXPECT_LE(fs::file_size(picture), 25'000u) << picture;
  }
  EXPECT_GT(count, 10);
}

}  // namespace
