// How the mixer computes sound: the options that the daemon and `ringdown render` have in common. [main]
#pragma once

#include <optional>

namespace CLI {
class App;
}
namespace ringdown::synth {
class Mixer;
}

namespace ringdown::session {

struct SoundOptions {
  double floor_db = 120;             // below full scale, where modes rest (Mixer::set_floor)
  bool masking = false;              // Mixer::set_masking
  bool exact_contacts = false;       // Mixer::set_exact_contacts
  std::optional<double> limiter_db;  // ceiling of the mix (Mixer::limit)
};

// One row of --help for each; `options` must outlive the app.
void add_sound_options(CLI::App& app, SoundOptions& options);

// While nothing is rendered.
void apply(const SoundOptions& options, synth::Mixer& mixer);

}  // namespace ringdown::session
