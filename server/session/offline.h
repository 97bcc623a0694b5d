// Renders without a clock: runs the daemon's session, mixer and scene as fast as the machine can.
//
// `ringdown render` and `ringdownd --driver wav` use it, and tests compare live sound with it. Two renderings are
// bit-identical; at another block size the samples differ only by rounding.
#pragma once

#include "engine/base/result.h"
#include "engine/scene/foley/limits.h"
#include "protocol/wire/message.h"
#include "engine/synth/mixer.h"
#include "server/session/contact_report.h"
#include "server/session/variation.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::session {

struct OfflineOptions {
  std::optional<std::filesystem::path> scene;
  std::vector<wire::ScoreEvent> score;                                 // by time, as read_score() returns it
  std::vector<std::pair<std::string, std::filesystem::path>> objects;  // name, bank
  // The length, exactly. By default the scene and the score are rendered up to the scene's own duration, the score's
  // end mark /c_set or its last event, and then what still sounds for tail_s, or until it is silent (kSilence_db).
  std::optional<double> seconds;
  std::optional<double> tail_s;        // an end mark is a tail of 0
  std::optional<double> min_tail_s;    // until it is silent, but not shorter; nothing: as kMinTail_s says
  std::optional<double> from_s, to_s;  // the part of the scene that is written, before its tail
  double sample_rate_hz = 48000;
  std::optional<scene::FoleyLimits> foley;  // set: contacts of animated bodies are recovered from their motion
  std::optional<std::string> camera;        // of a glTF scene, which is the listener; default: the first
  std::optional<VariationRange> variation;  // what is played otherwise than described
  double fade_s = 0;                        // within the end of the sound
  std::size_t block_frames = 256;
  synth::MixerSettings mixer;  // the limiter's delay is removed from the result; the budget is not used
};

// A sound of unknown length ends when the peak of its last second is below kSilence_db of full scale and kTail_db below
// the peak of the whole: a whole number of seconds after the scene, at least kMinTail_s, or after a score's last event,
// at least kMinScoreTail_s, and a fade later; after kMaxTail_s in any case.
inline constexpr double kSilence_db = -96, kTail_db = 60, kMinTail_s = 1, kMinScoreTail_s = 5, kMaxTail_s = 60;

// Fades of what programs render: within the end, and within the beginning of a part that does not begin at 0.
inline constexpr double kFade_s = 0.03, kRise_s = 0.005;

inline constexpr double kMaxRender_s = 24 * 3600;

struct Recording {
  double sample_rate_hz = 0;
  std::vector<float> left, right;
  std::vector<std::vector<float>> ambisonics;  // one row per ambisonic channel; none if the mixer has none
  float peak = 0;                              // largest |sample| of what write_audio() writes
  std::vector<std::string> warnings;           // warnings of the scene, and refused requests with their times
};

// Called now and then with the finished share, 0 to 1. If the function returns false, rendering is cancelled.
using Progress = std::function<bool(double done)>;

// Renders into memory.
Result<Recording> render_offline(const OfflineOptions& options, const Progress& progress);

// The bodies of a scene as its file describes them.
struct BodyCounts {
  std::size_t moved = 0;     // by keyframes
  std::size_t sounding = 0;  // with an object
};

// The outcome of render_to_file().
struct Rendering {
  double seconds = 0;
  float peak = 0;              // as in a Recording
  std::optional<double> lufs;  // loudness of left and right by EBU R 128; nothing: silent, or too short
  double true_peak = 0;        // of left and right, between samples too; 1 is full scale
  double gain = 1;             // that gave the file its loudness
  std::size_t stems = 0;       // files in the stems' folder
  std::vector<std::string> warnings;
  std::vector<ContactRow> contacts;  // of foley
  BodyCounts bodies;
};

struct FileOptions {
  int bits = 32;                               // of a sample in a WAV: 32 (float) or 24
  std::optional<double> lufs;                  // the loudness that the file shall have
  std::optional<std::filesystem::path> stems;  // folder to write stems into (stems.h), which are not made louder
  // Sound file for what the pickups of the score feel, one channel for each up to the last; not faded or made louder.
  std::optional<std::filesystem::path> pickups;
};

// Renders into a file equal, sample for sample, to that of write_audio(), but keeps at most a second in memory.
Result<Rendering> render_to_file(const OfflineOptions& options, const std::filesystem::path& path,
                                 const Progress& progress, const FileOptions& file = {});

// Writes to the user's path (engine/base/output_file.h): 32-bit float WAV, or 24-bit FLAC if the name ends in .flac.
// Writes the ambisonic channels if there are any, else left and right. The file appears when it is complete.
Result<void> write_audio(
    const Recording& recording, const std::filesystem::path& path,
    const Progress& progress = [](double) { return true; });

}  // namespace ringdown::session
