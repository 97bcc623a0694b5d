// The sum of many objects in all ambisonic channels, for one chunk at a time: each object's modes are reduced to lines
// of a frequency grid, which are added to every channel with the object's gain there. [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/block_io.h"
#include "engine/synth/kernels/frequency_grid.h"

#include <array>
#include <cstddef>

namespace ringdown::synth {

// A gain that moves in a straight line: its value in the middle of a chunk's window, and the increase from there to the
// window's end.
struct GainLine {
  float middle = 0, slope = 0;
  friend bool operator==(const GainLine&, const GainLine&) = default;
};

// An object's gains at all ambisonic channels.
struct FieldGains {
  alignas(64) std::array<float, kMaxAmbisonicChannels> middle{}, slope{};
  bool moves = false;
};

class FieldSums {
 public:
  FieldSums();

  // Begins a chunk and drops earlier sums.
  void open() REALTIME;

  // Begins an object. Kernels add the object's modes at full level to the returned target, which must be the only
  // target of a call.
  [[nodiscard]] MomentTarget begin_object() REALTIME;
  // add_to() adds the object to a channel that is not ambisonic; end_object() then adds it to the ambisonic channels,
  // of which `wanted` are listened to.
  void add_to(std::size_t channel, const GainLine& gain) REALTIME;
  void end_object(const FieldGains& gains, ChannelSet wanted) REALTIME;

  // Adds the sums of `other` for the present chunk.
  void add(const FieldSums& other) REALTIME;

  // channels() returns the channels to which something was added. close() adds their samples to `out` and uses up the
  // sums.
  [[nodiscard]] ChannelSet channels() const REALTIME { return field_channels_ | other_channels_; }
  void close(const std::array<double*, kMaxChannels>& out, std::size_t frames) REALTIME;

 private:
  static constexpr std::size_t kWidth = kMaxAmbisonicChannels;
  static constexpr std::size_t kBatch = 16;  // objects added to the field together, so that the field is read rarely
  enum Part { middle, slope, kParts };       // parts of the sound: constant, and proportional to t
  using Lines = std::array<float, kGridNumbers>;
  using Bundle = std::array<float, kGridNumbers * kWidth>;  // for each number, the values of kWidth channels
  struct Waiting {
    alignas(64) std::array<Lines, kBatch> objects;
    alignas(64) std::array<std::array<std::array<float, kWidth>, kBatch>, kParts> gains;
    std::size_t count = 0;
    bool slopes = false;
  };

  void add_waiting(const Waiting& waiting) REALTIME;
  float* part_of_field(Part part) REALTIME;
  void add_lines(const Lines& lines, float gain, std::size_t channel, Part part) REALTIME;
  void synthesize(const std::array<double*, kWidth>& out, std::size_t frames) REALTIME;

  alignas(64) std::array<float, 2 * kMoments * 2 * kGridReach> spread_;
  MomentGrid grid_;
  Waiting waiting_;
  alignas(64) std::array<Bundle, kParts> field_;
  std::array<bool, kParts> in_field_ = {};
  alignas(64) std::array<std::array<Lines, kParts>, kFirstAmbisonic> others_;  // the mix and the buses
  std::array<ChannelSet, kParts> in_others_ = {};
  ChannelSet field_channels_ = 0, other_channels_ = 0;

  ChunkTransform transform_;
  std::array<std::array<float, 2 * kChunkFrames>, kParts> turns_;  // factors of frames: real, then imaginary parts
  alignas(64) std::array<float, ChunkTransform::kPoints * kWidth / 2> re_, im_;
  alignas(64) std::array<float, kChunkFrames * kWidth> samples_;
};

}  // namespace ringdown::synth
