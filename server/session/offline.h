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
  std::optional<double> seconds;  // default: the scene's own duration, or up to the score's end mark /c_set, or its
                                  // last event and its tail
  double sample_rate_hz = 48000;
  std::optional<scene::FoleyLimits> foley;  // set: contacts of animated bodies are recovered from their motion
  std::optional<double> tail_s;             // of foley: what follows the animation; default: until it is silent
  double fade_s = 0;                        // at the end of a sound whose length is known
  std::size_t block_frames = 256;
  synth::MixerSettings mixer;  // the limiter's delay is removed from the result; the budget is not used
};

// A score without an end mark sounds for kTail_s after its last event, and then second by second until the peak of the
// last second is kTail_db below the peak of the whole, for kMaxTail_s at most.
inline constexpr double kTail_s = 5, kMaxTail_s = 60, kTail_db = 60;
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

// The outcome of render_to_file().
struct Rendering {
  double seconds = 0;
  float peak = 0;  // as in a Recording
  std::vector<std::string> warnings;
  std::vector<ContactRow> contacts;  // of foley
};

// Renders into a file equal, sample for sample, to that of write_audio(), but keeps at most a second in memory.
Result<Rendering> render_to_file(const OfflineOptions& options, const std::filesystem::path& path,
                                 const Progress& progress);

// Writes to the user's path (engine/base/output_file.h): 32-bit float WAV, or 24-bit FLAC if the name ends in .flac.
// Writes the ambisonic channels if there are any, else left and right. The file appears when it is complete.
Result<void> write_audio(
    const Recording& recording, const std::filesystem::path& path,
    const Progress& progress = [](double) { return true; });

}  // namespace ringdown::session
