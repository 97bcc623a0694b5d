// The daemon's settings file: the options of its command line as keys of a TOML file, without their dashes.
//
//   rate = 44100                      # --rate 44100
//   connect = true                    # --connect
//   object = ["bell=/banks/bell.glb", "bowl=/banks/bowl.glb"]
//
// Every option of options.h may stand in the file, except --help, --version and --settings. An option on the command
// line overrides the file. As on the command line, a relative path starts in the folder where the daemon was started.
// [main]
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <optional>
#include <string>

namespace ringdown::manual {
class App;
}

namespace ringdown::server {

// The value of --settings that means: read no file.
inline constexpr const char* kNoSettings = "none";

// Returns the file to read: the one that the user has `named`; otherwise ringdown/ringdownd.toml in $XDG_CONFIG_HOME or
// ~/.config, if it exists; otherwise nullopt.
std::optional<std::filesystem::path> settings_file(const std::optional<std::string>& named);

// Call after app.parse(). Gives every option of `app` that is not on the command line its value from the file. An error
// begins with path:line and names the key.
Result<void> read_settings(manual::App& app, const std::filesystem::path& path);

}  // namespace ringdown::server
