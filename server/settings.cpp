#include "server/settings.h"

#include "engine/base/toml_table.h"
#include "packaging/manual/command_line.h"

#include <cstdlib>

namespace ringdown::server {
namespace {

namespace fs = std::filesystem;

// The value of a key as words of a command line; empty when the file does not have the key or the value is wrong.
std::vector<std::string> words_of(TomlTable& file, const manual::App::Key& key) {
  std::vector<std::string> words;
  if (key.is_switch) {
    bool on = false;
    if (file.has(key.name)) file.boolean(key.name, on);
    if (file.has(key.name)) words = {on ? "true" : "false"};
  } else {
    file.words(key.name, words, key.is_list);
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

Result<void> read_settings(manual::App& app, const fs::path& path) {
  Result<TomlTable> file = TomlTable::read(path);
  if (!file) return fail(file);
  for (const manual::App::Key& key : app.keys()) {
    const std::vector<std::string> words = words_of(*file, key);
    if (words.empty() || key.given) continue;
    if (const std::string wrong = app.set(key.name, words); !wrong.empty()) {
      file->complain(key.name, wrong + "; ringdownd --help lists the options");
    }
  }
  return file->finish();
}

}  // namespace ringdown::server
