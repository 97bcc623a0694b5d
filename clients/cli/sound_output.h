// A rendering as files: what `ringdown render` and `ringdown foley` have in common. [main, worker]
#pragma once

#include "protocol/exit_codes.h"
#include "server/session/offline.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

namespace ringdown::manual {
class App;
}

namespace ringdown::cli {

struct SoundOutput {
  std::string path;
  session::FileOptions file;
  std::optional<std::filesystem::path> mux;  // a picture to put the sound under
  int takes = 0;                             // 0: one file, as described
  session::VariationRange variation;         // of the takes; its seed is the first one's
  bool progress_lines = false;               // on stdout, for programs (ProgressLine)
};

// Adds the options of both verbs. `options` and `output` must outlive the app.
void add_sound_output(manual::App& app, session::OfflineOptions& options, SoundOutput& output);

// Renders, writes all files, prints a line for each that ends with what `more` returns, and complains of what one would
// not expect. `judge` is called at last for each file, and returns the exit code.
using Judge = std::function<protocol::ExitCode(const session::Rendering& rendering, const std::string& path)>;
using More = std::function<std::string(const session::Rendering& rendering)>;
protocol::ExitCode write_sound(session::OfflineOptions options, const SoundOutput& output, const std::stop_token& stop,
                               const More& more, const Judge& judge);

}  // namespace ringdown::cli
