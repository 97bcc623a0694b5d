// Captures the mix as a sound file while the mixer plays. The file begins with the sound of the frame at which the
// capture began, whatever the limiter's delay, as in `ringdown render`.
//
// The audio thread puts the samples of each block into a tap (engine/synth/output/sound_tap.h); a thread of the capture
// takes them out and writes them. Samples that the tap had to drop because that thread was late are zeros in the file,
// so that later samples keep their time, and a warning counts them. The capture ends by itself, and completes its file,
// when the file has reached its maximum length, the sample rate changes or the disk is full.
#pragma once

#include "engine/base/result.h"
#include "server/session/rack.h"
#include "server/session/sound_file.h"

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace ringdown::session {

inline constexpr std::size_t kMaxCapturedFrames = std::size_t{1} << 28;  // per file: 93 minutes at 48 kHz, 2 GiB

class SoundCapture {
 public:
  // `rack` must outlive the capture. A file has at most `max_frames`.
  explicit SoundCapture(Rack& rack, std::size_t max_frames = kMaxCapturedFrames)
      : rack_(rack), max_frames_(max_frames) {}
  ~SoundCapture() = default;  // completes the file
  SoundCapture(const SoundCapture&) = delete;
  SoundCapture& operator=(const SoundCapture&) = delete;

  // Begins to write a .wav or .flac, or a stream. Refused while another file is being written. [worker]
  Result<void> start(OutputTarget target);

  // Completes the file and returns its number of frames, also if the capture has ended by itself. Refused if nothing
  // was captured; fails with the reason if the file could not be written. [worker]
  Result<std::size_t> stop();

  // The file that is being written and its length so far; nullopt if nothing is being captured. [any but audio]
  struct Progress {
    std::string path;
    double seconds = 0;
  };
  [[nodiscard]] std::optional<Progress> progress() const;

  // Returns true from start() to stop(), even if the capture has ended by itself meanwhile. [worker]
  [[nodiscard]] bool is_open() const;

 private:
  void run(const std::stop_token& stop, SoundFile file, synth::Frame first);
  // Writes the samples in the tap. Returns false if the file should end.
  [[nodiscard]] Result<bool> write_pieces(SoundFile& file, synth::Frame first);
  [[nodiscard]] bool writes() const;

  Rack& rack_;
  const std::size_t max_frames_;
  double sample_rate_hz_ = 0;               // sample rate of the file
  std::size_t lost_ = 0;                    // capture's thread: frames that the tap dropped
  std::atomic<std::size_t> frames_ = 0;     // in the file
  mutable std::mutex mutex_;                // guards the next two members
  std::filesystem::path path_;              // empty: nothing was captured since the last stop()
  std::optional<Result<std::size_t>> end_;  // how it ended; nullopt: the file is being written
  std::jthread thread_;                     // last member: ends before the others are destroyed
};

}  // namespace ringdown::session
