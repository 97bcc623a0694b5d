// Command-line options for how the mixer computes sound, which the daemon and `ringdown render` have in common. [main]
#pragma once

namespace CLI {
class App;
}
namespace ringdown::synth {
struct MixerSettings;
}

namespace ringdown::session {

// Adds one row of --help for each option; `settings` must outlive the app.
void add_sound_options(CLI::App& app, synth::MixerSettings& settings);

}  // namespace ringdown::session
