// Sounds in pieces, as they are rendered: where they begin and end, and the files that take them. [one thread]
#pragma once

#include "engine/base/result.h"
#include "engine/synth/events/event.h"
#include "server/session/sound_file.h"

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace ringdown::session {

// A part of the sound. The mix and the ambisonic channels begin and end at different blocks, because the limiter delays
// only the mix.
struct Piece {
  std::span<const float> left, right;
  std::vector<std::span<const float>> ambisonics;  // all of one length
};

// Returns the channels to write: the ambisonic ones if there are any, else left and right.
std::vector<std::span<const float>> written_channels(const Piece& piece);

float peak_of(const Piece& piece);

// One block of every channel, as a mixer has rendered it.
struct RenderedBlock {
  synth::Frame begin = 0, end = 0;
  std::vector<float> left, right;
  std::vector<std::vector<float>> ambisonics;
};

// The part of what is rendered that is written, in frames from the beginning, and the fades within it: it rises within
// `rise` frames and falls within the last `fall`.
struct Cut {
  synth::Frame first = 0, end = 0, rise = 0, fall = 0;

  // Lets the samples of a block that lie within the fades rise and fall. `late` is the delay of left and right. The end
  // must not change any more once a block reaches into the last `fall` frames.
  void fade(RenderedBlock& block, synth::Frame late) const;

  // The part of a block between two frames; left and right are `late` frames late.
  [[nodiscard]] static Piece part(const RenderedBlock& block, synth::Frame first, synth::Frame end, synth::Frame late);
};

struct PieceFormat {
  std::size_t channels = 2;
  bool ambisonic = false;
  std::size_t frames = 0;  // length of the whole file, at most
  int bits = 32;           // as in SoundFormat
  bool scaled = false;     // whether the samples are multiplied when all are known
};

// A sound file that is written in pieces.
class PieceFile {
 public:
  static Result<PieceFile> create(const std::filesystem::path& path, double sample_rate_hz, const PieceFormat& format);

  Result<void> take(const Piece& piece);

  // Completes the file; `gain` multiplies all samples of a file that is scaled.
  Result<void> finish(float gain = 1);

 private:
  static constexpr std::size_t kKept = 1 << 15;  // samples before they are written

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  PieceFile(SoundFile file, std::size_t channels) : file_(std::move(file)), channels_(channels) {}
  Result<void> write();

  SoundFile file_;
  std::size_t channels_;
  std::unique_ptr<std::FILE, Close> waiting_;  // without a name: the samples of a file that is scaled
  std::vector<float> samples_;                 // frame by frame
};

}  // namespace ringdown::session
