// The sum of many objects in all ambisonic channels, for one chunk at a time: each object's modes come down to lines of
// a frequency grid, which are added to every channel at the object's gain there. [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/block_io.h"
#include "engine/synth/kernels/frequency_grid.h"

#include <array>
#include <cstddef>

namespace ringdown::synth {

// A gain that moves in a straight line: what it is in the middle of a chunk's window, and how much more at its end.
struct GainLine {
  float middle = 0, slope = 0;
};

// The gains of an object at all ambisonic channels.
struct FieldGains {
  alignas(64) std::array<float, kMaxAmbisonicChannels> middle{}, slope{};
  bool moves = false;
};

class FieldSums {
 public:
  FieldSums();

  // Begins a chunk; what was added before is dropped.
  void open() RINGDOWN_REALTIME;

  // Begins an object. To this target, which stands alone in a call, kernels add its modes at full level.
  [[nodiscard]] MomentTarget begin_object() RINGDOWN_REALTIME;
  // The object is heard in channels beside the ambisonic ones, and then in these, of which `wanted` are listened to.
  void add_to(std::size_t channel, const GainLine& gain) RINGDOWN_REALTIME;
  void end_object(const FieldGains& gains, ChannelSet wanted) RINGDOWN_REALTIME;

  // Adds all that was added to `other` in the same chunk.
  void add(const FieldSums& other) RINGDOWN_REALTIME;

  // The channels to which something was added. Adds their samples to `out`; the sums are used up.
  [[nodiscard]] ChannelSet channels() const RINGDOWN_REALTIME { return field_channels_ | other_channels_; }
  void close(const std::array<double*, kMaxChannels>& out, std::size_t frames) RINGDOWN_REALTIME;

 private:
  static constexpr std::size_t kWidth = kMaxAmbisonicChannels;
  static constexpr std::size_t kBatch = 16;  // objects that wait to be added to the field, so that it is read seldom
  enum Part { middle, slope, kParts };       // of what is heard: what stands, and what goes as t
  using Lines = std::array<float, kGridNumbers>;
  using Bundle = std::array<float, kGridNumbers * kWidth>;  // of kWidth channels: a number of each, then the next
  struct Waiting {
    alignas(64) std::array<Lines, kBatch> objects;
    alignas(64) std::array<std::array<std::array<float, kWidth>, kBatch>, kParts> gains;
    std::size_t count = 0;
    bool slopes = false;
  };

  void add_waiting(const Waiting& waiting) RINGDOWN_REALTIME;
  float* part_of_field(Part part) RINGDOWN_REALTIME;
  void add_lines(const Lines& lines, float gain, std::size_t channel, Part part) RINGDOWN_REALTIME;
  void synthesize(const std::array<double*, kWidth>& out, std::size_t frames) RINGDOWN_REALTIME;

  alignas(64) std::array<float, 2 * kMoments * 2 * kGridReach> spread_;
  MomentGrid grid_;
  Waiting waiting_;
  alignas(64) std::array<Bundle, kParts> field_;
  std::array<bool, kParts> in_field_ = {};
  alignas(64) std::array<std::array<Lines, kParts>, kFirstAmbisonic> others_;  // the mix and the buses
  std::array<ChannelSet, kParts> in_others_ = {};
  ChannelSet field_channels_ = 0, other_channels_ = 0;

  ChunkTransform transform_;
  std::array<std::array<float, 2 * kChunkFrames>, kParts> turns_;  // by which a frame is multiplied: re, then im
  alignas(64) std::array<float, ChunkTransform::kPoints * kWidth / 2> re_, im_;
  alignas(64) std::array<float, kChunkFrames * kWidth> samples_;
};

}  // namespace ringdown::synth
