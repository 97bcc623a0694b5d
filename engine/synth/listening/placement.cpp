#include "engine/synth/listening/placement.h"

#include "engine/synth/modes/voice.h"
#include "engine/synth/output/channel_strip.h"

#include <algorithm>
#include <cmath>
#include <utility>

// Gains of modes move in straight lines from one look at their maps to the next. A line's end is looked up ahead, where
// the object will be by then, so that the line is right at both ends. How far ahead follows from how fast the object
// turns under the listener and from how sharp its maps are. In one line it turns by kMaxTurn at most, which leaves an
// error of kMaxTurn^2 / 8, -60 dB rms, in the line's middle. Lines begin and end at the boundaries of cells (chunk.h),
// regardless of chunks.
namespace ringdown::synth {
namespace {

constexpr double kMaxTurn = 0.1;  // phase by which a mode's gain moves through its lobes [rad]
constexpr double kMaxCellsAhead = 8;
constexpr double kMaxAhead_s = 0.3;  // limit under pressure

// The cost of a look-up, in terms of its map.
double terms_of(const ModeTable& table) RINGDOWN_REALTIME {
  const modal::DirectionMap& map = table.directions();
  const double harmonics = 0.5 * static_cast<double>(modal::harmonic_count(std::max(map.degree(), 0)));
  return static_cast<double>(map.terms()) + harmonics + static_cast<double>(table.columns());
}

constexpr double kFewModes = 1000;     // up to this number of modes, kMaxTerms applies, some 1 % of a core
constexpr double kMaxTerms = 16000;    // maximum number of terms in a cell
constexpr double kTermsPerMode = 0.3;  // with more modes: terms for each sounding mode, a tenth of the mode's own cost

}  // namespace

void LookPressure::update(double terms, double modes, const Chunk& chunk) RINGDOWN_REALTIME {
  constexpr double kShare = 0.1, kMaxPressure = 1000;
  terms_ += terms;
  if (chunk.end() < chunk.cell_end()) return;
  const double budget = std::max(kMaxTerms * std::min(1.0, kFewModes / std::max(modes, 1.0)), kTermsPerMode * modes);
  mean_ += kShare * (std::exchange(terms_, 0.0) - mean_);
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
  const double rate_hz = chunk.sample_rate_hz;
  track.advance(chunk.cell_begin(), rate_hz);
  const std::uint32_t jumps = track.jumps() + listening.jumps();
  const bool fresh = std::exchange(anew_, false) || (on_ ? heard_until_ != chunk.begin && !rings : !rings);
  const bool jumped = jumps != jumps_ || airs_ != listening.airs();
  const bool follows = on_ && !leaves_ && !fresh && !jumped && heard_until_ == chunk.begin;
  const bool within = follows && chunk.begin > chunk.cell_begin();  // the cell's first chunk was heard from it, too
  if (fresh) {
    glide_end_ = chunk.cell_begin();
  } else if (!on_ || leaves_ || jumped) {
    glide_end_ = chunk.cell_begin() + kGlide;
    next_look_ = chunk.cell_begin();
  }
  jumps_ = jumps;
  airs_ = listening.airs();
  const bool stands = track.still() && listening.still();
  const bool new_voice = !looked_up && unseen_;
  if (!within || new_voice) {
    origin_m_ = source ? source->table().origin_m() : Vec3{};
    // A body that only rotates about its origin keeps distance and pan. Only its direction changes, which matters at
    // the next look-up.
    const bool only_turns = !stands && follows && looked_up && glide_end_ <= chunk.cell_begin() &&
                            chunk.cell_begin() < next_look_ && listening.still() && track.stays_in_place() &&
                            origin_m_ == Vec3{} && last_.rate == 1;
    const bool sees_begin = !follows || (unseen_ && !only_turns);
    first_ =
        sees_begin ? listening.sight(track.at(chunk.cell_begin(), rate_hz), origin_m_, listening.at_begin()) : last_;
    last_ = stands || only_turns ? first_
                                 : listening.sight(track.at(chunk.cell_end(), rate_hz), origin_m_, listening.at_end());
    unseen_ = only_turns;
  }
  const ChannelStrip::Span span{fresh ? chunk.cell_begin() : chunk.begin, chunk.cell_end()};
  if (!within || !strip.placed_until(span.end)) {
    const auto left = static_cast<double>(glide_end_ - span.begin), n = static_cast<double>(span.end - span.begin);
    const double share = left > 0 ? std::min(1.0, n / left) : 1.0;
    strip.place({first_.toward_source, level_at(first_.distance_m)}, {last_.toward_source, level_at(last_.distance_m)},
                span, fresh ? 2 : share);
  }
  aim(chunk, fresh, within, stands, voices);
  look_terms_ = stands || within ? 0 : look_rate_ * static_cast<double>(kChunkFrames);
  on_ = true;
  leaves_ = false;
  heard_until_ = chunk.end();
  return true;
}

// Looks gains up where it is time to.
void Placement::aim(const Chunk& chunk, bool fresh, bool within, bool stands, VoiceStack& voices) RINGDOWN_REALTIME {
  const Listening& listening = *chunk.listening;
  constexpr auto kCell = static_cast<double>(kChunkFrames);
  const Frame cell = chunk.cell_begin();
  const double turn = length(last_.toward_listener - first_.toward_listener);
  const double glide = std::max(static_cast<double>(glide_end_ - cell), 0.0), least = std::max(kCell, glide);
  const auto clipped = [](double d) RINGDOWN_REALTIME { return std::max(d, kReferenceDistance_m); };
  const auto passed = static_cast<double>(chunk.begin - cell);  // of what is counted from the cell's beginning
  const bool look = !within && cell >= next_look_;
  double ahead = least;
  if (look || fresh) look_rate_ = 0;
  voices.for_each([&](Voice& voice) RINGDOWN_REALTIME {
    ModeGains& gains = voice.gains;
    const bool first = !gains.on(), begins = fresh || (first && glide == 0);
    if (begins) gains.aim(first_.toward_listener, clipped(first_.distance_m), listening.absorption(), 0);
    if (stands) {
      if (within && !first) return;
      const bool there = gains.on() && gains.left() == 0;
      if (there && glide == 0) {  // exactly, where a line has brought it but for rounding
        if (gains.moves()) gains.aim(first_.toward_listener, clipped(first_.distance_m), listening.absorption(), 0);
      } else if (look || !stood_ || gains.left() <= 0) {
        gains.aim(first_.toward_listener, clipped(first_.distance_m), listening.absorption(), least - passed, true);
      }
      return;
    }
    if (!look && !first && !fresh) return;
    const double sharpness = std::max(voice.table().directions().sharpness(), 1.0);
    const double most = std::max(kMaxCellsAhead * kCell, least);
    const double wanted = turn > 0 ? kCell * std::floor(kMaxTurn / (turn * sharpness)) : most;
    ahead = glide > 0 ? least : std::clamp(wanted, least, most);
    look_rate_ += terms_of(voice.table()) / ahead;
    if (chunk.look_pressure > 1 && glide == 0) {
      const double longest = std::max(kMaxAhead_s * chunk.sample_rate_hz, most);
      ahead = std::clamp(ahead * chunk.look_pressure * (0.75 + 0.5 * spread_), kCell, longest);
    }
    const Frame then = cell + static_cast<Frame>(ahead);
    const Sighting there =
        listening.sight(track.at(then, chunk.sample_rate_hz), origin_m_, listening.at(then, chunk.sample_rate_hz));
    gains.aim(there.toward_listener, clipped(there.distance_m), listening.absorption(), ahead - (begins ? 0 : passed),
              true);
    if (begins) gains.advance(static_cast<std::size_t>(chunk.begin - cell));
  });
  if (look || fresh || (stands && !stood_ && !within)) next_look_ = cell + static_cast<Frame>(ahead);
  if (look || fresh) spread_ = std::fmod(spread_ + 0.61803398874989485, 1.0);
  if (!within) stood_ = stands;
  hear(0, chunk.frames, chunk, voices);
}

// The source time that passes in a cell follows from the change of distance, up to terms of second order. Its deviation
// from a straight line in the middle follows from the rates at both ends. Parts of the cell follow the parabola through
// these values, so that the result does not depend on where chunks end.
void Placement::hear(std::size_t offset, std::size_t end, const Chunk& chunk,
                     VoiceStack& voices) const RINGDOWN_REALTIME {
  ModeStates::HeardTime time{.offset = offset};
  if (first_.rate != 1 || last_.rate != 1) {
    constexpr auto kCell = static_cast<double>(kChunkFrames);
    const double way_m = last_.distance_m - first_.distance_m;
    const double way_frames = way_m / chunk.listening->sound_speed_m_s() * chunk.sample_rate_hz;
    const double rate = std::clamp(1 - way_frames / kCell + 0.5 * (first_.excess + last_.excess), 0.5, 2.0);
    const double bend = -(last_.rate - first_.rate) * kCell / 8;
    const auto before = static_cast<double>(chunk.begin - chunk.cell_begin());
    const double from = (before + static_cast<double>(offset)) / kCell,
                 to = (before + static_cast<double>(end)) / kCell;
    time.rate = rate + 4 * bend * (1 - from - to) / kCell;
    time.bend = bend * (to - from) * (to - from);
  }
  voices.for_each([&](Voice& voice) RINGDOWN_REALTIME { voice.hear(&time); });
}

void Placement::end_chunk(const Chunk& chunk, VoiceStack& voices) RINGDOWN_REALTIME {
  voices.for_each([&](Voice& voice) RINGDOWN_REALTIME { voice.gains.advance(chunk.frames); });
}

bool Placement::may_share(const Chunk& chunk, const Voice& voice) const RINGDOWN_REALTIME {
  if (!heard(chunk)) return true;
  if (!on_ || leaves_ || unseen_ || glide_end_ > chunk.end() || heard_until_ != chunk.end()) return false;
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
  track.advance(chunk.cell_begin(), chunk.sample_rate_hz);
  const Sighting now = listening.sight(track.at(chunk.cell_begin(), chunk.sample_rate_hz), voice.table().origin_m(),
                                       listening.at_begin());
  const double sharpness = std::max(voice.table().directions().sharpness(), 1.0);
  const double before = level_at(last_.distance_m), level = level_at(now.distance_m);
  const double most = share * kMaxDrift;
  return length(now.toward_listener - last_.toward_listener) * sharpness > most ||
         length(now.toward_source - last_.toward_source) > most || std::abs(level - before) > most * before;
}

// Back to being heard without a place.
void Placement::go_off(const Chunk& chunk, VoiceStack& voices, ChannelStrip& strip) RINGDOWN_REALTIME {
  const bool later = heard_until_ != chunk.begin;  // it has been silent since
  anew_ = false;                                   // a request to begin anew holds for one chunk
  if (!leaves_ && !later) {
    glide_end_ = chunk.begin + kGlide;
    voices.for_each([](Voice& voice) RINGDOWN_REALTIME { voice.gains.aim_at_one(static_cast<double>(kGlide)); });
    first_ = last_ = {};
  }
  if (later || (leaves_ && glide_end_ <= chunk.begin)) return stop(voices, strip);
  leaves_ = true;
  const auto n = static_cast<double>(chunk.frames), left = static_cast<double>(glide_end_ - chunk.begin);
  strip.place_nowhere({chunk.begin, chunk.end()}, std::min(1.0, n / left));
  heard_until_ = chunk.end();
  hear(0, chunk.frames, chunk, voices);
}

void Placement::stop(VoiceStack& voices, ChannelStrip& strip) RINGDOWN_REALTIME {
  voices.for_each([](Voice& voice) RINGDOWN_REALTIME { voice.hear(nullptr); });
  strip.unplace();
  on_ = leaves_ = false;
}

}  // namespace ringdown::synth
