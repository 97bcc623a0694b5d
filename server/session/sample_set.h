// Writes an object as samples for any sampler: sound files of single strikes, and an SFZ file that maps key, velocity
// and repetition to them. [worker]
//
// A strike's loudness is proportional to its impulse, and its timbre depends on the contact time. So a velocity layer
// is a contact time: softer blows last longer, by Hertz's law, as in MidiPlayer. All layers are written at one impulse,
// and the player scales them by (velocity / 127)^2, SFZ's default, so layers differ in timbre but not in loudness.
// Repetitions are strikes at other points nearby. Other keys are the object rendered in another size, so that a sampler
// transposes by a few semitones at most.
#pragma once

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "protocol/defaults.h"
#include "server/session/offline.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::session {

inline constexpr int kKeys = 128;

struct SampleSetOptions {
  std::filesystem::path bank;    // the bank to read
  std::filesystem::path folder;  // the folder NAME to make, with NAME/NAME.sfz and NAME/samples/; must not exist
  bool flac = false;             // 24-bit FLAC instead of 32-bit float WAV
  double sample_rate_hz = 48000;

  struct Keys {
    int low, high;  // MIDI keys, both included
  };
  std::optional<Keys> keys;  // nothing: the object in its own size, on its own key
  int step = 3;              // keys from one size to the next
  std::optional<int>
      pitch;  // MIDI key that the object sounds in its own size; nothing: from its pitch (modal/hearing/pitch.h)

  int velocities = 5;               // layers
  int strikes = 4;                  // number of strikes that take turns on a repeated key
  std::vector<Vec3> places_m;       // strike points; several: chosen by key switches; none: the loudest point
  double scatter = 0.06;            // how far the turns' points lie apart, of the object's size
  double contact_time_s = 0.001;    // contact time of the hardest blow
  double max_s = 15;                // maximum length of a sample
  std::optional<double> release_s;  // time within which a released key is damped; nothing: the note rings on
};

struct SampleSet {
  std::size_t samples = 0;
  double seconds = 0;    // total length of all samples
  double pitch_hz = 0;   // pitch of the object in its own size, or the nearest to a pitch
  int key = 0;           // key of the object in its own size
  std::string no_pitch;  // why it has no definite pitch; "" when it has one, or when the options say it
  std::filesystem::path sfz;
};

// Renders the samples and writes them. The folder appears when it is complete.
Result<SampleSet> write_sample_set(const SampleSetOptions& options, const Progress& progress);

}  // namespace ringdown::session
