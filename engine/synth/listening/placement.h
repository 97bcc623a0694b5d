// An object's place, and how it is heard from there: what of each mode, how loud, from which side and how much higher.
// [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/chunk.h"
#include "engine/synth/listening/listening.h"
#include "engine/synth/listening/pose_track.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

class ChannelStrip;
class Voice;
class VoiceStack;

// Looking maps up costs more than all else: a map has some 200 terms. Where more objects turn than can be looked up as
// often as they should be, all are looked up less often, by the same factor (LookPressure), and their gains go along
// longer straight lines. The factor depends on terms counted, not on time, so that renders repeat.
class LookPressure {
 public:
  [[nodiscard]] double now() const RINGDOWN_REALTIME { return pressure_; }
  // After a chunk in which so many modes sounded, and so many terms would be added up without pressure: those that are
  // added up follow the pressure too late, by a line's length, for a steady answer.
  void update(double terms, double modes, const Chunk& chunk) RINGDOWN_REALTIME;

 private:
  double pressure_ = 1, mean_ = 0;
  double terms_ = 0;  // of the cell so far
};

class Placement {
 public:
  // Frames, from the beginning of a cell on, in which what jumps reaches its new level, side and direction.
  static constexpr Frame kGlide = 4 * static_cast<Frame>(kChunkFrames);

  PoseTrack track;

  // Whether the object is to be heard from its place in this chunk.
  [[nodiscard]] bool heard(const Chunk& chunk) const RINGDOWN_REALTIME {
    return chunk.listening != nullptr && (on_ || (chunk.listening->on() && track.known()));
  }
  // Sets strip and voices for the chunk. False when the object is not, or no longer, heard from its place.
  [[nodiscard]] bool begin_chunk(const Chunk& chunk, VoiceStack& voices, ChannelStrip& strip) RINGDOWN_REALTIME;
  // In the chunk, before frames `offset` ... `end` - 1 of it are rendered.
  void hear(std::size_t offset, std::size_t end, const Chunk& chunk, VoiceStack& voices) const RINGDOWN_REALTIME;
  void end_chunk(const Chunk& chunk, VoiceStack& voices) RINGDOWN_REALTIME;
  // Whether begin_chunk() has been called for this chunk.
  [[nodiscard]] bool begun(const Chunk& chunk) const RINGDOWN_REALTIME { return heard_until_ == chunk.end(); }

  // Whether it may share its states after this chunk, with gains as they are at its end: true when it is not heard from
  // a place, or its level stays within a decibel while it rings. That is so when, in the time in which its longest mode
  // falls by 20 dB, it turns under the listener by less than kMaxDrift / (sharpness of its maps), comes nearer or goes
  // away by less than kMaxDrift of its distance, and its pitch is shifted by less than kMaxShift, which is not heard of
  // what shares states.
  static constexpr double kMaxDrift = 0.12, kMaxShift = 0.003;  // 1 dB, 5 cents
  [[nodiscard]] bool may_share(const Chunk& chunk, const Voice& voice) const RINGDOWN_REALTIME;
  // Whether a member of an instance group is heard differently now, by `share` of that or more, than when it joined.
  [[nodiscard]] bool drifted(const Chunk& chunk, const Voice& voice, double share) RINGDOWN_REALTIME;
  // The next chunk begins with what is heard from the present place, instead of going there from the last one.
  void begin_anew() RINGDOWN_REALTIME { anew_ = true; }

  // The cost of the object's lines in the chunk, in terms of maps, if it is looked up as often as would be exact.
  [[nodiscard]] double look_terms() const RINGDOWN_REALTIME { return look_terms_; }

  // The object is no longer heard from its place, at once.
  void stop(VoiceStack& voices, ChannelStrip& strip) RINGDOWN_REALTIME;
  void forget() RINGDOWN_REALTIME {
    const double spread = spread_;
    *this = {};
    spread_ = spread;
  }
  // Objects of different numbers look maps up in different chunks. [worker, before anything is rendered]
  void spread_looks(std::size_t number) { spread_ = std::fmod(0.61803398874989485 * static_cast<double>(number), 1.0); }

 private:
  // `within`: the cell's first chunk was heard from the place, too; `stands`: nothing moves.
  void aim(const Chunk& chunk, bool fresh, bool within, bool stands, VoiceStack& voices) RINGDOWN_REALTIME;
  void go_off(const Chunk& chunk, VoiceStack& voices, ChannelStrip& strip) RINGDOWN_REALTIME;

  bool on_ = false, leaves_ = false, anew_ = false;
  Frame heard_until_ = -1;  // the end of the last chunk in which it was heard
  Frame next_look_ = 0;     // when gains are looked up again
  Frame glide_end_ = 0;
  Sighting first_, last_;  // where the cell of the last chunk begins and ends
  Vec3 origin_m_;
  double look_terms_ = 0;
  double look_rate_ = 0;  // terms of a frame
  double spread_ = 0;     // 0 to 1, another for every look, so that objects do not look in the same chunks
  bool stood_ = false;
  bool unseen_ = false;  // last_ says from where the object was heard, but no longer from which of its sides
  std::uint32_t jumps_ = 0, airs_ = 0;
};

}  // namespace ringdown::synth
