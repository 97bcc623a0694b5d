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
  [[nodiscard]] double now() const REALTIME { return pressure_; }
  // Call once per chunk with the number of sounding modes and the look-up cost (in terms) without any pressure. The
  // unpressured cost is used because the real one lags one line behind and would make the control loop oscillate.
  void update(double terms, double modes, const Chunk& chunk) REALTIME;

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
  [[nodiscard]] bool heard(const Chunk& chunk) const REALTIME {
    return chunk.listening != nullptr && (state_ != State::absent || (chunk.listening->on() && track.known()));
  }
  // Sets strip and voices for the chunk if the object is heard from its place. Returns the cost of its gain lines in
  // the chunk, in terms of maps, if they were looked up as often as exactness requires.
  double begin_chunk(const Chunk& chunk, VoiceStack& voices, ChannelStrip& strip) REALTIME;
  // Call in the chunk before its frames `offset` ... `end` - 1 are rendered.
  void hear(std::size_t offset, std::size_t end, const Chunk& chunk, VoiceStack& voices) const REALTIME;
  void end_chunk(const Chunk& chunk, VoiceStack& voices) REALTIME;
  // Returns whether begin_chunk() found that the object is heard from its place in this chunk.
  [[nodiscard]] bool begun(const Chunk& chunk) const REALTIME {
    return state_ != State::absent && heard_until_ == chunk.end();
  }

  // Returns whether the object may share its states after this chunk, with its gains at the chunk's end: it is not
  // heard from a place, or its level stays within a decibel while it rings. The latter holds if, in the time in which
  // its longest mode falls by 20 dB, the object turns under the listener by less than kMaxDrift / (sharpness of its
  // maps), changes its distance by less than kMaxDrift of that distance, and has a pitch shift of less than kMaxShift
  // (shared states are not pitch-shifted).
  static constexpr double kMaxDrift = 0.12, kMaxShift = 0.003;  // 1 dB, 5 cents
  [[nodiscard]] bool may_share(const Chunk& chunk, const Voice& voice) const REALTIME;
  // Returns whether the hearing of a member of an instance group has changed since it joined by at least `share` of
  // these limits.
  [[nodiscard]] bool drifted(const Chunk& chunk, const Voice& voice, double share) REALTIME;
  // Makes the next chunk begin with the gains of the present place, instead of gliding there from the last one.
  void begin_anew() REALTIME { state_ = State::renewed; }

  void forget() REALTIME {
    const double spread = spread_;
    *this = {};
    spread_ = spread;
  }
  // Makes objects of different numbers look up their maps in different chunks. [worker, before anything is rendered]
  void spread_looks(std::size_t number) { spread_ = std::fmod(0.61803398874989485 * static_cast<double>(number), 1.0); }

 private:
  // How the object is heard: not from its place (`absent`); from its place in the next chunk, without a glide
  // (`renewed`); from its place while nothing moves in the cell (`still`), while it turns about its place, so that
  // last_ has its distance but not its direction (`turning`), and in any other motion (`moving`); or on its way back to
  // being heard without a place (`leaving`).
  enum class State : std::uint8_t { absent, renewed, still, turning, moving, leaving };
  // How a chunk continues what was heard before: it begins in the present place (`afresh`), glides there from another
  // place or from none (`gliding`), begins after chunks that an instance group rendered (`resumed`), or follows the
  // last chunk of a cell (`next_cell`) or an earlier chunk of its own cell (`same_cell`).
  enum class Entry : std::uint8_t { afresh, gliding, resumed, next_cell, same_cell };
  Entry enter(const Chunk& chunk, bool rings) REALTIME;
  State sight(const Chunk& chunk, Entry entry, const VoiceStack& voices) REALTIME;
  void aim(const Chunk& chunk, Entry entry, VoiceStack& voices) REALTIME;
  void leave(const Chunk& chunk, VoiceStack& voices, ChannelStrip& strip) REALTIME;

  State state_ = State::absent;
  Frame heard_until_ = -1;   // end of the last chunk in which the object was heard
  Frame glide_end_ = 0;      // set by enter() and leave(), where glides begin
  std::uint32_t jumps_ = 0;  // set by enter()
  Sighting first_, last_;    // at the beginning and end of the last chunk's cell; set by sight(), with origin_m_
  Vec3 origin_m_;
  // The plan of look-ups, set by aim():
  Frame next_look_ = 0;   // when gains are looked up again
  double look_rate_ = 0;  // terms per frame
  double spread_ = 0;     // 0 to 1, different for every look, so that objects do not look in one chunk
};

}  // namespace ringdown::synth
