// The daemon's settings file: the options of its command line as keys of a TOML file, without their dashes.
//
//   rate = 44100                      # --rate 44100
//   connect = true                    # --connect
//   object = ["bell=/banks/bell.glb", "bowl=/banks/bowl.glb"]
//
// Every option of options.h may stand there but --help, --version and --settings. An option on the command line wins
// over the file's. Paths are as on the command line: a relative one starts where the daemon was started. [main]
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace ringdown::server {

// What --settings says for "read none".
inline constexpr const char* kNoSettings = "none";

// Which file to read: the one the user `named`, if any; else ringdown/ringdownd.toml in $XDG_CONFIG_HOME or ~/.config,
// if there is one; else nothing.
std::optional<std::filesystem::path> settings_file(const std::optional<std::string>& named);

// Gives every option of `app` that the command line left open, after app.parse(), the value it has in the file. An
// error begins with path:line and names the key.
Result<void> read_settings(CLI::App& app, const std::filesystem::path& path);

}  // namespace ringdown::server
