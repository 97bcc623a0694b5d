// An object's place, and how it is heard from there: the gain of each mode, level, direction and Doppler shift. [audio,
// after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/modes/chunk.h"
#include "engine/synth/listening/listening.h"
#include "engine/synth/listening/pose_track.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

class ChannelStrip;
class Voice;
class VoiceStack;

// Limits the cost of looking up radiation maps, which costs more than everything else: a map has some 200 terms. If
// more objects turn than can be looked up as often as they should be, all are looked up less often, by one factor (the
// pressure), and their gains follow longer straight lines. The factor depends on terms counted, not on time, so that
// renders repeat.
class LookPressure {
 public:
  [[nodiscard]] double now() const RINGDOWN_REALTIME { return pressure_; }
  // Call once per chunk with the number of sounding modes and the look-up cost (in terms) without any pressure. The
  // unpressured cost is used because the real one lags one line behind and would make the control loop oscillate.
  void update(double terms, double modes, const Chunk& chunk) RINGDOWN_REALTIME;

 private:
  double pressure_ = 1, mean_ = 0;
  double terms_ = 0;  // terms of the cell so far
};

class Placement {
 public:
  // Frames, from the beginning of a cell on, in which a jump reaches its new level, pan and direction.
  static constexpr Frame kGlide = 4 * static_cast<Frame>(kChunkFrames);

  PoseTrack track;

  // Returns whether the object should be heard from its place in this chunk.
  [[nodiscard]] bool heard(const Chunk& chunk) const RINGDOWN_REALTIME {
    return chunk.listening != nullptr && (on_ || (chunk.listening->on() && track.known()));
  }
  // Sets strip and voices for the chunk. Returns false if the object is not, or no longer, heard from its place.
  [[nodiscard]] bool begin_chunk(const Chunk& chunk, VoiceStack& voices, ChannelStrip& strip) RINGDOWN_REALTIME;
  // Call in the chunk before its frames `offset` ... `end` - 1 are rendered.
  void hear(std::size_t offset, std::size_t end, const Chunk& chunk, VoiceStack& voices) const RINGDOWN_REALTIME;
  void end_chunk(const Chunk& chunk, VoiceStack& voices) RINGDOWN_REALTIME;
  // Returns whether begin_chunk() has been called for this chunk.
  [[nodiscard]] bool begun(const Chunk& chunk) const RINGDOWN_REALTIME { return heard_until_ == chunk.end(); }

  // Returns whether the object may share its states after this chunk, with its gains at the chunk's end: it is not
  // heard from a place, or its level stays within a decibel while it rings. The latter holds if, in the time in which
  // its longest mode falls by 20 dB, the object turns under the listener by less than kMaxDrift / (sharpness of its
  // maps), changes its distance by less than kMaxDrift of that distance, and has a pitch shift of less than kMaxShift
  // (shared states are not pitch-shifted).
  static constexpr double kMaxDrift = 0.12, kMaxShift = 0.003;  // 1 dB, 5 cents
  [[nodiscard]] bool may_share(const Chunk& chunk, const Voice& voice) const RINGDOWN_REALTIME;
  // Returns whether the hearing of a member of an instance group has changed since it joined by at least `share` of
  // these limits.
  [[nodiscard]] bool drifted(const Chunk& chunk, const Voice& voice, double share) RINGDOWN_REALTIME;
  // Makes the next chunk begin with the gains of the present place, instead of gliding there from the last one.
  void begin_anew() RINGDOWN_REALTIME { anew_ = true; }

  // Returns the cost of the object's gain lines in the chunk, in terms of maps, if they were looked up as often as
  // exactness requires.
  [[nodiscard]] double look_terms() const RINGDOWN_REALTIME { return look_terms_; }

  // Stops hearing the object from its place, at once.
  void stop(VoiceStack& voices, ChannelStrip& strip) RINGDOWN_REALTIME;
  void forget() RINGDOWN_REALTIME {
    const double spread = spread_;
    *this = {};
    spread_ = spread;
  }
  // Makes objects of different numbers look up their maps in different chunks. [worker, before anything is rendered]
  void spread_looks(std::size_t number) { spread_ = std::fmod(0.61803398874989485 * static_cast<double>(number), 1.0); }

 private:
  // `within`: the cell's first chunk was also heard from the place; `stands`: nothing moves.
  void aim(const Chunk& chunk, bool fresh, bool within, bool stands, VoiceStack& voices) RINGDOWN_REALTIME;
  void go_off(const Chunk& chunk, VoiceStack& voices, ChannelStrip& strip) RINGDOWN_REALTIME;

  bool on_ = false, leaves_ = false, anew_ = false;
  Frame heard_until_ = -1;  // end of the last chunk in which the object was heard
  Frame next_look_ = 0;     // when gains are looked up again
  Frame glide_end_ = 0;
  Sighting first_, last_;  // at the beginning and end of the last chunk's cell
  Vec3 origin_m_;
  double look_terms_ = 0;
  double look_rate_ = 0;  // terms per frame
  double spread_ = 0;     // 0 to 1, different for every look, so that objects do not look in one chunk
  bool stood_ = false;
  bool unseen_ = false;  // last_ still has the object's place, but no longer its orientation
  std::uint32_t jumps_ = 0, airs_ = 0;
};

}  // namespace ringdown::synth
