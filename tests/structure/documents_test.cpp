// What the documents promise about the tree.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
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
  const std::string reasons = text_of(kRoot / "docs/dependencies.md");
  int count = 0;
  for (std::string line; std::getline(packages, line);) {
    if (line.empty() || line.front() == '#') continue;
    EXPECT_NE(reasons.find(line), std::string::npos) << line << " is not in docs/dependencies.md";
    ++count;
  }
  EXPECT_GT(count, 20);
}

TEST(Documents, EveryLinkToAFileLeadsSomewhere) {
  const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
  int count = 0;
  std::vector<fs::path> pages = {kRoot / "README.md", kRoot / "SECURITY.md"};
  for (const auto& entry : fs::directory_iterator(kRoot / "docs")) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  for (const fs::path& page : pages) {
    const std::string text = text_of(page);
    for (std::sregex_iterator found(text.begin(), text.end(), link), end; found != end; ++found, ++count) {
      const std::string target = (*found)[1];
      EXPECT_TRUE(fs::exists(page.parent_path() / target)) << page.filename() << " links to " << target;
    }
  }
  EXPECT_GT(count, 10);
}

// docs/figures/presets_page.py writes both.
TEST(Documents, EveryPresetHasItsRowAndEveryBankItsPicture) {
  const std::string page = text_of(kRoot / "docs/presets.md");
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
