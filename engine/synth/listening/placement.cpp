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

constexpr auto kCell = static_cast<double>(kChunkFrames);
constexpr double kMaxTurn = 0.1;  // phase by which a mode's gain moves through its lobes [rad]
constexpr double kMaxCellsAhead = 8;
constexpr double kMaxAhead_s = 0.3;  // limit under pressure

// The cost of a look-up, in terms of its map.
double terms_of(const ModeTable& table) REALTIME {
  const modal::DirectionMap& map = table.directions();
  const double harmonics = 0.5 * static_cast<double>(modal::harmonic_count(std::max(map.degree(), 0)));
  return static_cast<double>(map.terms()) + harmonics + static_cast<double>(table.columns());
}

constexpr double kFewModes = 1000;     // up to this number of modes, kMaxTerms applies, some 1 % of a core
constexpr double kMaxTerms = 16000;    // maximum number of terms in a cell
constexpr double kTermsPerMode = 0.3;  // with more modes: terms for each sounding mode, a tenth of the mode's own cost

}  // namespace

void LookPressure::update(double terms, double modes, const Chunk& chunk) REALTIME {
  constexpr double kShare = 0.1, kMaxPressure = 1000;
  terms_ += terms;
  if (chunk.end() < chunk.cell_end()) return;
  const double budget = std::max(kMaxTerms * std::min(1.0, kFewModes / std::max(modes, 1.0)), kTermsPerMode * modes);
  mean_ += kShare * (std::exchange(terms_, 0.0) - mean_);
  pressure_ = std::clamp(mean_ / budget, 1.0, kMaxPressure);
}

double Placement::begin_chunk(const Chunk& chunk, VoiceStack& voices, ChannelStrip& strip) REALTIME {
  if (!heard(chunk)) return 0;
  double terms = 0;
  if (!chunk.listening->on() || !track.known()) {
    leave(chunk, voices, strip);
    if (state_ == State::absent) return 0;
  } else {
    bool rings = false;
    voices.for_each([&](const Voice& voice) REALTIME { rings = rings || voice.ringing(); });
    track.advance(chunk.cell_begin(), chunk.sample_rate_hz);
    const Entry entry = enter(chunk, rings);
    const State next = sight(chunk, entry, voices);
    const bool fresh = entry == Entry::afresh, within = entry == Entry::same_cell;
    const ChannelStrip::Span span{fresh ? chunk.cell_begin() : chunk.begin, chunk.cell_end()};
    if (!within || !strip.placed_until(span.end)) {
      const auto left = static_cast<double>(glide_end_ - span.begin), n = static_cast<double>(span.end - span.begin);
      const double share = fresh ? 2 : left > 0 ? std::min(1.0, n / left) : 1;
      strip.place({first_.toward_source, level_at(first_.distance_m)},
                  {last_.toward_source, level_at(last_.distance_m)}, span, share);
    }
    aim(chunk, entry, voices);
    state_ = next;
    if (!within && next != State::still) terms = look_rate_ * kCell;
  }
  heard_until_ = chunk.end();
  hear(0, chunk.frames, chunk, voices);
  return terms;
}

Placement::Entry Placement::enter(const Chunk& chunk, bool rings) REALTIME {
  const bool follows = heard_until_ == chunk.begin;
  const std::uint32_t now = track.jumps() + chunk.listening->jumps();
  const bool jumped = std::exchange(jumps_, now) != now;
  if (state_ == State::renewed || (!rings && (state_ == State::absent || !follows))) {
    glide_end_ = chunk.cell_begin();
    return Entry::afresh;
  }
  if (state_ == State::absent || state_ == State::leaving || jumped) {
    glide_end_ = chunk.cell_begin() + kGlide;
    return Entry::gliding;
  }
  if (!follows) return Entry::resumed;
  return chunk.begin > chunk.cell_begin() ? Entry::same_cell : Entry::next_cell;
}

// Finds how the object is seen at both ends of the cell, and returns the state for the cell. An earlier chunk of the
// cell may have done so; then a voice that has no gains yet needs the direction of an object that turns.
Placement::State Placement::sight(const Chunk& chunk, Entry entry, const VoiceStack& voices) REALTIME {
  bool looked_up = true;
  const Voice* source = nullptr;
  voices.for_each([&](const Voice& voice) REALTIME {
    looked_up = looked_up && voice.gains.on();
    source = source ? source : &voice;
  });
  const bool within = entry == Entry::same_cell, follows = within || entry == Entry::next_cell;
  if (within && (looked_up || state_ != State::turning)) return state_;
  const Listening& listening = *chunk.listening;
  const double rate_hz = chunk.sample_rate_hz;
  origin_m_ = source ? source->table().whole().origin_m : Vec3{};
  // A body that only rotates about its origin keeps distance and pan. Only its direction changes, which matters at
  // the next look-up.
  const bool still = track.still() && listening.still();
  const bool turns = !still && follows && looked_up && glide_end_ <= chunk.cell_begin() &&
                     chunk.cell_begin() < next_look_ && listening.still() && track.stays_in_place() &&
                     origin_m_ == Vec3{} && last_.rate == 1;
  const bool known = follows && (turns || state_ != State::turning);
  first_ = known ? last_ : listening.sight(track.at(chunk.cell_begin(), rate_hz), origin_m_, listening.at_begin());
  last_ = still || turns ? first_ : listening.sight(track.at(chunk.cell_end(), rate_hz), origin_m_, listening.at_end());
  return turns ? State::turning : still && !within ? State::still : State::moving;
}

// Looks gains up where it is time to.
void Placement::aim(const Chunk& chunk, Entry entry, VoiceStack& voices) REALTIME {
  const Listening& listening = *chunk.listening;
  const Frame cell = chunk.cell_begin();
  const bool fresh = entry == Entry::afresh, within = entry == Entry::same_cell,
             still = track.still() && listening.still();
  const bool look = fresh || entry == Entry::gliding || (!within && cell >= next_look_);
  const bool stops = still && !within && state_ != State::still;
  const double turn = length(last_.toward_listener - first_.toward_listener);
  const double glide = std::max(static_cast<double>(glide_end_ - cell), 0.0), min = std::max(kCell, glide);
  const auto passed = static_cast<double>(chunk.begin - cell);  // of what is counted from the cell's beginning
  const auto go_to = [&](ModeGains& gains, const Sighting& at, double frames) REALTIME {
    gains.aim(at.toward_listener, std::max(at.distance_m, kReferenceDistance_m), listening.absorption(), frames);
  };
  double ahead = min;
  if (look) look_rate_ = 0;
  voices.for_each([&](Voice& voice) REALTIME {
    ModeGains& gains = voice.gains;
    const bool first = !gains.on(), begins = fresh || (first && glide == 0);
    if (begins) go_to(gains, first_, 0);
    if (still) {
      // Gains whose line has ended differ from its goal by rounding errors; these are removed once.
      const bool there = glide == 0 && gains.on() && gains.left() == 0;
      const bool goes = there ? gains.moves() : look || stops || gains.left() <= 0;
      if (goes && (first || !within)) go_to(gains, first_, there ? 0 : min - passed);
      return;
    }
    if (!look && !first) return;
    const double sharpness = std::max(voice.table().directions().sharpness(), 1.0);
    const double max = std::max(kMaxCellsAhead * kCell, min);
    const double wanted = turn > 0 ? kCell * std::floor(kMaxTurn / (turn * sharpness)) : max;
    ahead = glide > 0 ? min : std::clamp(wanted, min, max);
    look_rate_ += terms_of(voice.table()) / ahead;
    if (chunk.look_pressure > 1 && glide == 0) {
      const double longest = std::max(kMaxAhead_s * chunk.sample_rate_hz, max);
      ahead = std::clamp(ahead * chunk.look_pressure * (0.75 + 0.5 * spread_), kCell, longest);
    }
    const Frame then = cell + static_cast<Frame>(ahead);
    const Motion source = track.at(then, chunk.sample_rate_hz), listener = listening.at(then, chunk.sample_rate_hz);
    go_to(gains, listening.sight(source, origin_m_, listener), ahead - (begins ? 0 : passed));
    if (begins) gains.advance(static_cast<std::size_t>(chunk.begin - cell));
  });
  if (look || stops) next_look_ = cell + static_cast<Frame>(ahead);
  if (look) spread_ = std::fmod(spread_ + 0.61803398874989485, 1.0);
}

// The source time that passes in a cell follows from the change of distance, up to terms of second order. Its deviation
// from a straight line in the middle follows from the rates at both ends. Parts of the cell follow the parabola through
// these values, so that the result does not depend on where chunks end.
void Placement::hear(std::size_t offset, std::size_t end, const Chunk& chunk, VoiceStack& voices) const REALTIME {
  ModeStates::HeardTime time{.offset = offset};
  if (state_ != State::leaving && (first_.rate != 1 || last_.rate != 1)) {
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
  voices.for_each([&](Voice& voice) REALTIME { voice.hear(&time); });
}

void Placement::end_chunk(const Chunk& chunk, VoiceStack& voices) REALTIME {
  if (!begun(chunk)) return;
  voices.for_each([&](Voice& voice) REALTIME { voice.gains.advance(chunk.frames); });
}

bool Placement::may_share(const Chunk& chunk, const Voice& voice) const REALTIME {
  if (!heard(chunk)) return true;
  if ((state_ != State::still && state_ != State::moving) || glide_end_ > chunk.end() || !begun(chunk)) return false;
  const Motion source = track.at(chunk.end(), chunk.sample_rate_hz), &listener = chunk.listening->at_end();
  const double speed = length(source.velocity_m_s - listener.velocity_m_s), ring_s = voice.table().whole().ring_s;
  const double turn = ring_s * (length(source.spin_rad_s) + speed / std::max(last_.distance_m, kNear_m));
  const double sharpness = std::max(voice.table().directions().sharpness(), 1.0);
  return turn * sharpness <= kMaxDrift &&
         ring_s * speed <= kMaxDrift * std::max(last_.distance_m, kReferenceDistance_m) &&
         std::abs(last_.rate - 1) <= kMaxShift;
}

bool Placement::drifted(const Chunk& chunk, const Voice& voice, double share) REALTIME {
  if (!heard(chunk)) return false;
  const Listening& listening = *chunk.listening;
  if (!listening.on() || track.jumps() + listening.jumps() != jumps_) return true;
  track.advance(chunk.cell_begin(), chunk.sample_rate_hz);
  const Sighting now = listening.sight(track.at(chunk.cell_begin(), chunk.sample_rate_hz),
                                       voice.table().whole().origin_m, listening.at_begin());
  const double sharpness = std::max(voice.table().directions().sharpness(), 1.0);
  const double before = level_at(last_.distance_m), level = level_at(now.distance_m);
  const double max = share * kMaxDrift;
  return length(now.toward_listener - last_.toward_listener) * sharpness > max ||
         length(now.toward_source - last_.toward_source) > max || std::abs(level - before) > max * before;
}

// Glides back to being heard without a place. The glide ends at once if nothing was heard in the last chunk.
void Placement::leave(const Chunk& chunk, VoiceStack& voices, ChannelStrip& strip) REALTIME {
  if (heard_until_ != chunk.begin || (state_ == State::leaving && glide_end_ <= chunk.begin)) {
    voices.for_each([](Voice& voice) REALTIME { voice.hear(nullptr); });
    strip.unplace();
    state_ = State::absent;
    return;
  }
  if (state_ != State::leaving) {
    glide_end_ = chunk.begin + kGlide;
    voices.for_each([](Voice& voice) REALTIME { voice.gains.aim_at_one(static_cast<double>(kGlide)); });
    state_ = State::leaving;
  }
  const auto n = static_cast<double>(chunk.frames), left = static_cast<double>(glide_end_ - chunk.begin);
  strip.place_nowhere({chunk.begin, chunk.end()}, std::min(1.0, n / left));
}

}  // namespace ringdown::synth
