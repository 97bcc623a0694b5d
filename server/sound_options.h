// The command-line options for the mixer's sound, shared by the daemon and `ringdown render`. [main]
#pragma once

namespace ringdown::manual {
class App;
}
namespace ringdown::synth {
struct MixerSettings;
}

namespace ringdown::server {

// Adds --floor, --contacts, --full-scale, --limiter, --ambisonics and --binaural, which write to `settings`: it must
// outlive the app. The limiter is on by default. --masking is accepted but only prints that it has no effect any more.
void add_sound_options(manual::App& app, synth::MixerSettings& settings);

}  // namespace ringdown::server
