#include "engine/base/content_cache.h"

#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <thread>
#include <vector>

namespace ringdown {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

ContentHash key(int number) { return ContentHasher().value(number).hash(); }

fs::path only_file(const fs::path& folder) { return fs::directory_iterator(folder)->path(); }

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void overwrite(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

void make_older(const fs::path& path, int hours) {
  fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(hours));
}

TEST(ContentHash, HashesDifferWhereContentsDo) {
  const auto joined = [](std::string_view a, std::string_view b) { return ContentHasher().text(a).text(b).hash(); };
  EXPECT_EQ(joined("ab", "c"), joined("ab", "c"));
  EXPECT_FALSE(joined("ab", "c") == joined("a", "bc"));
  EXPECT_FALSE(joined("ab", "") == joined("", "ab"));
  std::set<std::string> texts;
  std::string content(4096, 'x');
  for (std::size_t i = 0; i < content.size(); ++i) {  // every single changed byte is noticed
    content[i] = 'y';
    texts.insert(hash_of(content).text());
    content[i] = 'x';
  }
  texts.insert(hash_of(content).text());
  EXPECT_EQ(texts.size(), content.size() + 1);
  EXPECT_EQ(hash_of("").text().size(), 32u);
}

TEST(ContentCache, TheCacheReturnsWhatWasStoredUnderAKindAndKey) {
  const TemporaryFolder folder;
  const ContentCache cache(folder.path() / "not" / "yet");
  const std::string content("\0any\n\xff bytes", 12);
  EXPECT_FALSE(cache.find("modes", key(1)));
  ASSERT_TRUE(cache.store("modes", key(1), content));
  ASSERT_TRUE(cache.store("modes", key(2), ""));
  EXPECT_EQ(cache.find("modes", key(1)), content);
  EXPECT_EQ(cache.find("modes", key(2)), "");
  EXPECT_FALSE(cache.find("modes", key(3)));
  EXPECT_FALSE(cache.find("mesh", key(1)));
  ASSERT_TRUE(cache.store("modes", key(1), "newer"));
  EXPECT_EQ(cache.find("modes", key(1)), "newer");
}

TEST(ContentCache, ADamagedCacheEntryIsNotReturnedAndIsReplaced) {
  const TemporaryFolder folder;
  const ContentCache cache(folder.path());
  ASSERT_TRUE(cache.store("modes", key(1), std::string(1000, 'a')));
  const fs::path file = only_file(folder.path());
  const std::string good = text_of(file);
  for (std::size_t at = 0; at < good.size(); at += 7) {  // header and content alike
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    overwrite(file, bad);
    EXPECT_FALSE(cache.find("modes", key(1))) << "byte " << at;
    EXPECT_FALSE(fs::exists(file)) << "byte " << at;
  }
  for (const std::string& bad : {good.substr(0, good.size() - 1), good.substr(0, 20), std::string(), good + "x"}) {
    overwrite(file, bad);
    EXPECT_FALSE(cache.find("modes", key(1))) << bad.size();
  }
  overwrite(file, good);
  EXPECT_EQ(cache.find("modes", key(1)), std::string(1000, 'a'));
}

TEST(ContentCache, ACacheEntryUnderAnotherEntrysNameIsNotReturned) {
  const TemporaryFolder folder;
  const ContentCache cache(folder.path());
  ASSERT_TRUE(cache.store("modes", key(1), "one"));
  const fs::path one = only_file(folder.path());
  fs::rename(one, folder.path() / ("modes-" + key(2).text()));
  EXPECT_FALSE(cache.find("modes", key(2)));
  fs::create_directory(folder.path() / ("modes-" + key(3).text()));
  EXPECT_FALSE(cache.find("modes", key(3)));
}

TEST(ContentCache, AFullCacheDropsTheEntriesUnusedForLongest) {
  const TemporaryFolder folder;
  const ContentCache cache(folder.path(), 5000);
  const auto file = [&](int i) { return folder.path() / ("modes-" + key(i).text()); };
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(cache.store("modes", key(i), std::string(1100, 'a')));
    make_older(file(i), 10 - i);
  }
  EXPECT_TRUE(cache.find("modes", key(0)));  // the oldest, but used just now
  ASSERT_TRUE(cache.store("modes", key(4), std::string(1100, 'a')));
  EXPECT_TRUE(cache.find("modes", key(0)));
  EXPECT_FALSE(cache.find("modes", key(1)));
  for (const int i : {2, 3, 4}) EXPECT_TRUE(cache.find("modes", key(i))) << i;
  ASSERT_TRUE(cache.store("modes", key(9), std::string(1300, 'a')));  // more than a quarter of all
  EXPECT_FALSE(cache.find("modes", key(9)));
}

// A user may point RINGDOWN_CACHE at a folder with other things in it.
TEST(ContentCache, TheCacheLeavesFilesOfOtherNamesAlone) {
  const TemporaryFolder folder;
  const std::vector<std::string> others = {"thesis.tex", "modes-1234", "Modes-" + key(1).text(), "-" + key(1).text(),
                                           "modes-" + key(1).text() + ".tar"};
  for (const std::string& name : others) make_older(folder.write(name, std::string(3000, 'a')), 1000);
  const std::string left_by_a_killed_process = "modes-" + key(1).text() + ".aB3xYz";
  make_older(folder.write(left_by_a_killed_process, std::string(3000, 'a')), 1000);
  const ContentCache cache(folder.path(), 2000);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(cache.store("modes", key(i), std::string(400, 'a')));
  for (const std::string& name : others) EXPECT_TRUE(fs::exists(folder.path() / name)) << name;
  EXPECT_FALSE(fs::exists(folder.path() / left_by_a_killed_process));
}

TEST(ContentCache, StoringInAnUnwritableCacheFailsWithAReason) {
  const TemporaryFolder folder;
  const ContentCache cache(folder.write("file", "") / "below");
  const auto stored = cache.store("modes", key(1), "content");
  ASSERT_FALSE(stored);
  EXPECT_NE(stored.error().message.find("cannot write"), std::string::npos);
  EXPECT_FALSE(cache.find("modes", key(1)));
}

// Every thread stores and finds under the same few keys: what is found is always one whole content.
TEST(ContentCache, ManyWritersAndReadersShareOneCache) {
  const TemporaryFolder folder;
  constexpr int kThreads = 4, kRounds = 40;
  std::array<int, kThreads> wrong{};
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t) {
      threads.emplace_back([&, t] {
        const ContentCache cache(folder.path(), 40'000);
        for (int i = 0; i < kRounds; ++i) {
          const int k = (i + t) % 5;
          (void)cache.store("modes", key(k), std::string(5000, static_cast<char>('a' + k)));
          const auto found = cache.find("modes", key((i + 2 * t) % 5));
          if (found && *found != std::string(5000, static_cast<char>('a' + (i + 2 * t) % 5))) ++wrong[t];
        }
      });
    }
  }
  EXPECT_EQ(wrong, (std::array<int, kThreads>{}));
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    EXPECT_EQ(entry.path().filename().string().size(), 38u) << "a half-written file: " << entry.path();
  }
}

TEST(CacheFolder, TheCacheFolderIsTheFirstOfThreePlacesThatIsSet) {
  const auto set = [](const char* name, const char* value) { value ? ::setenv(name, value, 1) : ::unsetenv(name); };
  std::vector<std::pair<std::string, std::optional<std::string>>> before;
  for (const char* name : {"RINGDOWN_CACHE", "XDG_CACHE_HOME", "HOME"}) {
    const char* value = std::getenv(name);
    before.emplace_back(name, value ? std::optional<std::string>(value) : std::nullopt);
  }
  set("RINGDOWN_CACHE", "/a"), set("XDG_CACHE_HOME", "/b"), set("HOME", "/c");
  EXPECT_EQ(cache_folder(), fs::path("/a"));
  set("RINGDOWN_CACHE", "");
  EXPECT_EQ(cache_folder(), fs::path("/b/ringdown"));
  set("XDG_CACHE_HOME", "relative");
  EXPECT_EQ(cache_folder(), fs::path("/c/.cache/ringdown"));
  set("HOME", nullptr);
  EXPECT_FALSE(cache_folder());
  for (const auto& [name, value] : before) set(name.c_str(), value ? value->c_str() : nullptr);
}

}  // namespace
}  // namespace ringdown
