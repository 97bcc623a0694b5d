#include "engine/synth/placement.h"

#include "engine/synth/object.h"

#include <algorithm>
#include <cmath>
#include <utility>

// Gains of modes move in straight lines from one look at their maps to the next. A line's end is looked up ahead, where
// the object will be by then, so that the line is right at both ends. How far ahead follows from how fast the object
// turns under the listener and from how sharp its maps are: by kMaxTurn at most, which leaves the middle of a line off
// by kMaxTurn^2 / 8, -60 dB rms.
namespace ringdown::synth {
namespace {

constexpr double kMaxTurn = 0.1;  // of the phase in which a mode's gain goes through its lobes [rad]
constexpr double kMaxChunksAhead = 8;
constexpr double kMaxAhead_s = 0.3;  // under pressure

// What a look-up costs, in terms of its map.
double terms_of(const ModeTable& table) RINGDOWN_REALTIME {
  const modal::DirectionMap& map = table.directions();
  const double harmonics = 0.5 * static_cast<double>(modal::harmonic_count(std::max(map.degree(), 0)));
  return static_cast<double>(map.terms()) + harmonics + static_cast<double>(table.columns());
}

constexpr double kFewModes = 1000;     // up to which looks may add up kMaxTerms in a full chunk, some 1 % of a core
constexpr double kMaxTerms = 16000;    // in a full chunk
constexpr double kTermsPerMode = 0.3;  // and with more modes, so many for each that sounds, a tenth of what it costs

}  // namespace

void LookPressure::update(double terms, double modes, std::size_t frames) RINGDOWN_REALTIME {
  constexpr double kShare = 0.1, kMaxPressure = 1000;
  const double chunks = static_cast<double>(frames) / static_cast<double>(kChunkFrames);
  const double budget =
      chunks * std::max(kMaxTerms * std::min(1.0, kFewModes / std::max(modes, 1.0)), kTermsPerMode * modes);
  mean_ += kShare * (terms - mean_);
  pressure_ = std::clamp(mean_ / budget, 1.0, kMaxPressure);
}

bool Placement::begin_chunk(const Chunk& chunk, VoiceStack& voices, ChannelStrip& strip) RINGDOWN_REALTIME {
  look_terms_ = 0;
  if (!heard(chunk)) return false;
  const Listening& listening = *chunk.listening;
  if (!(listening.on() && track.known())) {
    go_off(chunk, voices, strip);
    return on_;
  }
  bool rings = false, looked_up = true;
  const Voice* source = nullptr;
  voices.for_each([&](const Voice& voice) RINGDOWN_REALTIME {
    rings = rings || voice.ringing();
    looked_up = looked_up && voice.gains.on();
    source = source ? source : &voice;
  });
  const Vec3 origin_m = source ? source->table().origin_m() : Vec3{};
  const double rate_hz = chunk.sample_rate_hz;
  track.advance(chunk.begin, rate_hz);
  const std::uint32_t jumps = track.jumps() + listening.jumps();
  const bool fresh = std::exchange(anew_, false) || (on_ ? heard_until_ != chunk.begin && !rings : !rings);
  if (fresh) {
    glide_left_ = 0;
  } else if (!on_ || leaves_ || jumps != jumps_ || airs_ != listening.airs()) {
    glide_left_ = kGlide;
    next_look_ = chunk.begin;
  }
  const bool follows = on_ && !leaves_ && !fresh && jumps == jumps_ && heard_until_ == chunk.begin;
  jumps_ = jumps;
  airs_ = listening.airs();
  const bool stands = track.still() && listening.still();
  // What turns about where it is heard from keeps its distance and side; its direction counts where maps are looked up.
  const bool only_turns = !stands && follows && looked_up && glide_left_ == 0 && chunk.begin < next_look_ &&
                          listening.still() && track.stays_in_place() && origin_m == Vec3{} && last_.rate == 1;
  const bool sees_begin = !follows || (unseen_ && !only_turns);
  const Sighting begin =
      sees_begin ? listening.sight(track.at(chunk.begin, rate_hz), origin_m, listening.at_begin()) : last_;
  const Sighting end =
      stands || only_turns ? begin : listening.sight(track.at(chunk.end(), rate_hz), origin_m, listening.at_end());
  unseen_ = only_turns;
  const double n = static_cast<double>(chunk.frames);
  const double share = glide_left_ > 0 ? std::min(1.0, n / static_cast<double>(glide_left_)) : 1.0;
  strip.place({begin.toward_source, level_at(begin.distance_m)}, {end.toward_source, level_at(end.distance_m)},
              {chunk.begin, chunk.end()}, fresh ? 2 : share);
  first_ = begin;
  last_ = end;
  origin_m_ = origin_m;
  aim(chunk, begin, end, fresh, stands, origin_m, voices);
  look_terms_ = stands ? 0 : look_rate_ * n;
  glide_left_ = std::max<Frame>(glide_left_ - static_cast<Frame>(chunk.frames), 0);
  on_ = true;
  leaves_ = false;
  heard_until_ = chunk.end();
  return true;
}

// Looks gains up where it is time to.
void Placement::aim(const Chunk& chunk, const Sighting& begin, const Sighting& end, bool fresh, bool stands,
                    const Vec3& origin_m, VoiceStack& voices) RINGDOWN_REALTIME {
  const Listening& listening = *chunk.listening;
  const double n = static_cast<double>(chunk.frames), turn = length(end.toward_listener - begin.toward_listener);
  const double least = std::max(n, static_cast<double>(glide_left_));
  const auto clipped = [](double d) RINGDOWN_REALTIME { return std::max(d, kReferenceDistance_m); };
  const bool look = chunk.begin >= next_look_;
  double ahead = least;
  if (look || fresh) look_rate_ = 0;
  voices.for_each([&](Voice& voice) RINGDOWN_REALTIME {
    ModeGains& gains = voice.gains;
    const bool first = !gains.on();
    if (fresh || (first && glide_left_ == 0)) {
      gains.aim(begin.toward_listener, clipped(begin.distance_m), listening.absorption(), 0);
    }
    if (stands) {
      const bool there = gains.on() && gains.left() == 0;
      if (there && glide_left_ == 0) {  // exactly, where a line has brought it but for rounding
        if (gains.moves()) gains.aim(begin.toward_listener, clipped(begin.distance_m), listening.absorption(), 0);
      } else if (look || !stood_ || gains.left() <= 0) {
        gains.aim(begin.toward_listener, clipped(begin.distance_m), listening.absorption(), least, true);
        ahead = std::max(ahead, least);
      }
      return;
    }
    if (!look && !first && !fresh) return;
    const double sharpness = std::max(voice.table().directions().sharpness(), 1.0);
    const double most = std::max(kMaxChunksAhead * static_cast<double>(kChunkFrames), least);
    const double wanted = turn > 0 ? n * std::floor(kMaxTurn / (turn * sharpness)) : most;
    ahead = glide_left_ > 0 ? least : std::clamp(wanted, least, most);
    look_rate_ += terms_of(voice.table()) / ahead;
    if (chunk.look_pressure > 1 && glide_left_ == 0) {
      const double longest = std::max(kMaxAhead_s * chunk.sample_rate_hz, most);
      ahead = std::clamp(ahead * chunk.look_pressure * (0.75 + 0.5 * spread_), n, longest);
    }
    const Frame then = chunk.begin + static_cast<Frame>(ahead);
    const Sighting there =
        listening.sight(track.at(then, chunk.sample_rate_hz), origin_m, listening.at(then, chunk.sample_rate_hz));
    gains.aim(there.toward_listener, clipped(there.distance_m), listening.absorption(), ahead, true);
  });
  if (look || fresh || (stands && !stood_)) next_look_ = chunk.begin + static_cast<Frame>(ahead);
  if (look || fresh) spread_ = std::fmod(spread_ + 0.61803398874989485, 1.0);
  stood_ = stands;
  hear(0, chunk.frames, chunk, voices);
}

// The time of the source that passes is found from how the distance changes, so that it does not matter where chunks
// end; what is left is of second order. How far it lies off a straight line in the middle follows from the rates at
// both ends.
void Placement::hear(std::size_t offset, std::size_t end, const Chunk& chunk,
                     VoiceStack& voices) const RINGDOWN_REALTIME {
  const auto frames = static_cast<double>(end - offset);
  Sighting a = first_, b = last_;
  const bool shifted = a.rate != 1 || b.rate != 1;
  const auto at = [&](std::size_t frame) RINGDOWN_REALTIME {
    const Frame then = chunk.begin + static_cast<Frame>(frame);
    return chunk.listening->sight(track.at(then, chunk.sample_rate_hz), origin_m_,
                                  chunk.listening->at(then, chunk.sample_rate_hz));
  };
  if (shifted && offset > 0) a = at(offset);
  if (shifted && end < chunk.frames) b = at(end);
  double rate = 1, bend = 0;
  if (shifted) {
    const double way_frames = (b.distance_m - a.distance_m) / chunk.listening->sound_speed_m_s() * chunk.sample_rate_hz;
    rate = std::clamp(1 - way_frames / frames + 0.5 * (a.excess + b.excess), 0.5, 2.0);
    bend = -(b.rate - a.rate) * frames / 8;
  }
  const ModeStates::HeardTime time{offset, rate, bend};
  voices.for_each([&](Voice& voice) RINGDOWN_REALTIME { voice.hear(&time); });
}

void Placement::end_chunk(const Chunk& chunk, VoiceStack& voices) RINGDOWN_REALTIME {
  voices.for_each([&](Voice& voice) RINGDOWN_REALTIME { voice.gains.advance(chunk.frames); });
}

bool Placement::may_share(const Chunk& chunk, const Voice& voice) const RINGDOWN_REALTIME {
  if (!heard(chunk)) return true;
  if (!on_ || leaves_ || unseen_ || glide_left_ > 0 || heard_until_ != chunk.end()) return false;
  const Motion source = track.at(chunk.end(), chunk.sample_rate_hz), &listener = chunk.listening->at_end();
  const double speed = length(source.velocity_m_s - listener.velocity_m_s), ring_s = voice.table().ring_s();
  const double turn = ring_s * (length(source.spin_rad_s) + speed / std::max(last_.distance_m, kNear_m));
  const double sharpness = std::max(voice.table().directions().sharpness(), 1.0);
  return turn * sharpness <= kMaxDrift &&
         ring_s * speed <= kMaxDrift * std::max(last_.distance_m, kReferenceDistance_m) &&
         std::abs(last_.rate - 1) <= kMaxShift;
}

bool Placement::drifted(const Chunk& chunk, const Voice& voice, double share) RINGDOWN_REALTIME {
  if (!heard(chunk)) return false;
  const Listening& listening = *chunk.listening;
  if (!listening.on() || track.jumps() + listening.jumps() != jumps_ || listening.airs() != airs_) return true;
  track.advance(chunk.begin, chunk.sample_rate_hz);
  const Sighting now =
      listening.sight(track.at(chunk.begin, chunk.sample_rate_hz), voice.table().origin_m(), listening.at_begin());
  const double sharpness = std::max(voice.table().directions().sharpness(), 1.0);
  const double before = level_at(last_.distance_m), level = level_at(now.distance_m);
  const double most = share * kMaxDrift;
  return length(now.toward_listener - last_.toward_listener) * sharpness > most ||
         length(now.toward_source - last_.toward_source) > most || std::abs(level - before) > most * before;
}

// Back to being heard without a place.
void Placement::go_off(const Chunk& chunk, VoiceStack& voices, ChannelStrip& strip) RINGDOWN_REALTIME {
  const bool later = heard_until_ != chunk.begin;  // it has been silent since
  if (!leaves_ && !later) {
    glide_left_ = kGlide;
    voices.for_each([](Voice& voice) RINGDOWN_REALTIME { voice.gains.aim_at_one(static_cast<double>(kGlide)); });
    first_ = last_ = {};
  }
  if (later || (leaves_ && glide_left_ == 0)) return stop(voices, strip);
  leaves_ = true;
  const double n = static_cast<double>(chunk.frames);
  strip.place_nowhere({chunk.begin, chunk.end()}, std::min(1.0, n / static_cast<double>(glide_left_)));
  glide_left_ = std::max<Frame>(glide_left_ - static_cast<Frame>(chunk.frames), 0);
  heard_until_ = chunk.end();
  hear(0, chunk.frames, chunk, voices);
}

void Placement::stop(VoiceStack& voices, ChannelStrip& strip) RINGDOWN_REALTIME {
  voices.for_each([](Voice& voice) RINGDOWN_REALTIME { voice.hear(nullptr); });
  strip.unplace();
  on_ = leaves_ = false;
}

}  // namespace ringdown::synth
