#include "server/settings.h"

#include "engine/base/toml_table.h"

#include <CLI/CLI.hpp>

#include <cstdlib>

namespace ringdown::server {
namespace {

namespace fs = std::filesystem;

// The value of a key as words of a command line; empty when the file does not have the key or the value is wrong.
std::vector<std::string> words_of(TomlTable& file, const std::string& key, const CLI::Option& option) {
  std::vector<std::string> words;
  if (option.get_expected_max() == 0) {
    bool on = false;
    if (file.has(key)) file.boolean(key, on);
    if (file.has(key)) words = {on ? "true" : "false"};
  } else {
    file.words(key, words, option.get_items_expected_max() > 1);
  }
  return words;
}

}  // namespace

std::optional<fs::path> settings_file(const std::optional<std::string>& named) {
  if (named == kNoSettings) return std::nullopt;
  if (named) return *named;
  const char* configuration = std::getenv("XDG_CONFIG_HOME");
  const char* home = std::getenv("HOME");
  fs::path folder;
  if (configuration && *configuration) {
    folder = configuration;
  } else if (home && *home) {
    folder = fs::path(home) / ".config";
  } else {
    return std::nullopt;
  }
  const fs::path usual = folder / "ringdown" / "ringdownd.toml";
  std::error_code error;
  return fs::exists(usual, error) ? std::optional(usual) : std::nullopt;
}

Result<void> read_settings(CLI::App& app, const fs::path& path) {
  Result<TomlTable> file = TomlTable::read(path);
  if (!file) return fail(file.error());
  for (CLI::Option* option : app.get_options()) {
    if (!option->get_configurable() || option->get_lnames().empty()) continue;
    const std::string& key = option->get_lnames().front();
    const std::vector<std::string> words = words_of(*file, key, *option);
    if (words.empty() || option->count() > 0) continue;
    try {
      option->add_result(words);
      option->run_callback();
    } catch (const CLI::Error& error) {
      file->complain(key, error.what() + std::string("; ringdownd --help says what may stand here"));
    }
  }
  return file->finish();
}

}  // namespace ringdown::server
