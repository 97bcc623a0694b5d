#include "server/session/stems.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace ringdown::session {
namespace {

using synth::Event;
using synth::Frame;
using synth::Mixer;
using synth::ObjectNumber;
using EventEntry = std::unique_ptr<const Event>;

// A lasting contact, one-way even if both surfaces feel it.
const synth::verb::Contact* contact_of(const Event& event, synth::verb::Contact& room) {
  if (const auto* rub = event.verb.get_if<synth::verb::Rub>()) {
    room = rub->as_public();
    return &room;
  }
  return event.verb.get_if<synth::verb::Contact>();
}

bool is_slide(const synth::Contact& contact) { return contact.slip_m_s >= contact.roll_m_s; }
bool ends(const synth::Contact& contact) { return length(contact.force_n) == 0; }

// The object whose vibration an event lets its own object feel.
std::optional<ObjectNumber> felt_in(const Event& event) {
  const auto known = [](ObjectNumber other) { return other == synth::kNoObject ? std::nullopt : std::optional(other); };
  if (const auto* rub = event.verb.get_if<synth::verb::Rub>()) return known(rub->other);
  if (const auto* hit = event.verb.get_if<synth::verb::Collision>()) return known(hit->other);
  return {};
}

// A mixer that plays entries of the log, and the block that it has rendered last.
class Player {
 public:
  explicit Player(const StemSettings& settings) : mixer_(settings.sample_rate_hz) {
    synth::MixerSettings without = settings.mixer;
    without.limiter_db.reset();
    mixer_.configure(without);
    if (const auto order = without.ambisonic_order) block_.ambisonics.resize(synth::ambisonic_channels(*order));
  }

  void give(ObjectNumber object, const StemLog::Change& change) {
    auto voice =
        std::make_unique<synth::Voice>(mixer_.table_for(change.map, change.material, change.dampers, change.modes));
    voice->mode_change = change.mode_change;
    lost_ = !mixer_.install(object, std::move(voice), change.how, change.at) || lost_;
  }
  void silence(ObjectNumber object) { lost_ = !mixer_.silence(object, true) || lost_; }
  // Rendering 0 frames moves events from the mixer's short ring to its queue.
  void push(const Event& event) {
    if (mixer_.push(synth::Producer::scene, event)) return;
    mixer_.render({}, {});
    lost_ = !mixer_.push(synth::Producer::scene, event) || lost_;
  }

  RenderedBlock& render(Frame begin, Frame end) {
    const auto frames = static_cast<std::size_t>(end - begin);
    block_.begin = begin, block_.end = end;
    block_.left.resize(frames), block_.right.resize(frames);
    synth::Outputs outputs(block_.left.data(), block_.right.data());
    for (std::size_t c = 0; c < block_.ambisonics.size(); ++c) {
      block_.ambisonics[c].resize(frames);
      outputs.listen_to_ambisonics(c, block_.ambisonics[c].data());
    }
    mixer_.render(outputs, frames);
    mixer_.collect();
    return block_;
  }

  // Returns true if an event could not be played.
  [[nodiscard]] bool lost() const { return lost_; }

 private:
  Mixer mixer_;
  RenderedBlock block_;
  bool lost_ = false;
};

void subtract(RenderedBlock& from, const RenderedBlock& what) {
  const auto each = [](std::vector<float>& a, const std::vector<float>& b) {
    for (std::size_t n = 0; n < a.size(); ++n) a[n] -= b[n];
  };
  each(from.left, what.left);
  each(from.right, what.right);
  for (std::size_t c = 0; c < from.ambisonics.size(); ++c) each(from.ambisonics[c], what.ambisonics[c]);
}

// The objects that have to play with an object: those that feel each other's vibration, directly or through others.
std::set<ObjectNumber> company_of(ObjectNumber object, const StemLog& log) {
  std::set<ObjectNumber> all = {object};
  if (log.tracks().at(object).chaotic) {
    for (const auto& [number, track] : log.tracks()) all.insert(number);
    return all;
  }
  for (std::size_t before = 0; before != all.size();) {
    before = all.size();
    for (const auto& [number, track] : log.tracks()) {
      const bool meets =
          all.contains(number) || std::ranges::any_of(track.felt, [&](auto n) { return all.contains(n); });
      if (!meets) continue;
      all.insert(number);
      all.insert(track.felt.begin(), track.felt.end());
    }
  }
  return all;
}

// The stems of one object.
class ObjectStems {
 public:
  ObjectStems(ObjectNumber object, const StemLog& log, const StemSettings& settings)
      : object_(object), track_(log.tracks().at(object)), log_(log), settings_(settings) {
    for (const ObjectNumber number : company_of(object, log)) {
      if (log.tracks().contains(number)) cursors_.push_back({number, log.tracks().at(number).entries.begin()});
      if (number != object) all_.silence(number);
    }
    if (track_.slides || track_.rolls) lasting_.emplace(settings);
    if (track_.slides && track_.rolls) sliding_.emplace(settings);
    listener_ = log.listener().begin();
  }

  // Returns the number of files.
  Result<std::size_t> write(const std::function<bool(double done)>& progress) {
    const std::vector<Frame>& blocks = log_.blocks();
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      play_until(k);
      const Frame end = k + 1 < blocks.size() ? blocks[k + 1] : settings_.cut.end;
      if (end <= blocks[k]) continue;
      if (const auto written = render(blocks[k], end); !written) return fail(written);
      if (!progress(static_cast<double>(end) / static_cast<double>(settings_.cut.end)))
        return fail(ErrorKind::cancelled, "cancelled; not all stems were written");
    }
    if (all_.lost() || (lasting_ && lasting_->lost()) || (sliding_ && sliding_->lost()))
      return fail(ErrorKind::refused, "stems: too much happens to " + track_.name + " at once");
    std::size_t count = 0;
    for (auto& stem : stems_) {
      if (!stem || stem->peak == 0) continue;
      if (const auto finished = stem->file.finish(); !finished) return fail(finished);
      ++count;
    }
    return count;
  }

 private:
  enum Kind : std::uint8_t { impact, slide, roll };
  struct Stem {
    PieceFile file;
    float peak = 0;
  };
  struct Cursor {
    ObjectNumber object;
    std::deque<StemLog::Entry>::const_iterator next;
  };

  void each_player(const auto& call) {
    call(all_);
    if (lasting_) call(*lasting_);
    if (sliding_) call(*sliding_);
  }

  // Plays what came before a block.
  void play_until(std::size_t block) {
    for (; listener_ != log_.listener().end() && listener_->block <= block; ++listener_)
      each_player([&](Player& player) { player.push(*std::get<EventEntry>(listener_->what)); });
    for (Cursor& cursor : cursors_) {
      const auto& entries = log_.tracks().at(cursor.object).entries;
      for (; cursor.next != entries.end() && cursor.next->block <= block; ++cursor.next) play(cursor, *cursor.next);
    }
  }

  void play(const Cursor& cursor, const StemLog::Entry& entry) {
    const bool own = cursor.object == object_;
    if (const auto* change = std::get_if<std::unique_ptr<const StemLog::Change>>(&entry.what)) {
      if (!own) return all_.give(cursor.object, **change);
      return each_player([&](Player& player) { player.give(object_, **change); });
    }
    const auto* posed = std::get_if<StemLog::Posed>(&entry.what);
    const Event event =
        posed ? Event{posed->frame, cursor.object, synth::verb::Pose{posed->pose}} : *std::get<EventEntry>(entry.what);
    synth::verb::Contact room;
    const synth::Effect effect = effect_of(event);
    const auto* contact = own ? contact_of(event, room) : nullptr;
    if (contact) play_contact(*contact, event);
    if (own && effect != synth::Effect::excites && effect != synth::Effect::begins) {
      each_player([&](Player& player) { player.push(event); });
    } else {
      all_.push(event);
    }
  }

  // A contact that slides no longer, but rolls, ends in the one and begins in the other.
  void play_contact(const synth::verb::Contact& contact, const Event& event) {
    if (!lasting_) return;
    Event one_way{event.frame, event.object, contact};
    lasting_->push(one_way);
    if (!sliding_) return;
    const std::uint32_t number = contact.contact.number;
    if (!ends(contact.contact) && is_slide(contact.contact)) {
      open_.insert(number);
      sliding_->push(one_way);
    } else if (open_.erase(number) > 0) {
      synth::verb::Contact over = contact;
      over.contact.force_n = {};
      one_way.verb = over;
      sliding_->push(one_way);
    }
  }

  Result<void> render(Frame begin, Frame end) {
    RenderedBlock* all = track_.blows ? &all_.render(begin, end) : nullptr;
    if (lasting_) {
      RenderedBlock& lasting = lasting_->render(begin, end);
      if (all) subtract(*all, lasting);
      if (sliding_) {
        RenderedBlock& sliding = sliding_->render(begin, end);
        subtract(lasting, sliding);
        if (const auto taken = take(slide, sliding); !taken) return taken;
      }
      if (const auto taken = take(track_.rolls ? roll : slide, lasting); !taken) return taken;
    }
    return all ? take(impact, *all) : Result<void>();
  }

  Result<void> take(Kind kind, RenderedBlock& block) {
    const Cut& cut = settings_.cut;
    cut.fade(block, 0);
    const Piece piece = Cut::part(block, cut.first, cut.end, 0);
    std::optional<Stem>& stem = stems_[kind];
    if (!stem) {
      constexpr std::array kKinds = {"impact", "slide", "roll"};
      auto file =
          PieceFile::create(settings_.folder / (track_.name + "-" + kKinds[kind] + ".wav"), settings_.sample_rate_hz,
                            {.channels = written_channels(piece).size(),
                             .ambisonic = !piece.ambisonics.empty(),
                             .frames = static_cast<std::size_t>(cut.end - cut.first),
                             .bits = settings_.bits});
      if (!file) return fail(file);
      stem.emplace(Stem{*std::move(file)});
    }
    stem->peak = std::max(stem->peak, peak_of(piece));
    return stem->file.take(piece);
  }

  ObjectNumber object_;
  const StemLog::Track& track_;
  const StemLog& log_;
  const StemSettings& settings_;
  Player all_{settings_};
  std::optional<Player> lasting_, sliding_;
  std::vector<Cursor> cursors_;
  std::deque<StemLog::Entry>::const_iterator listener_;
  std::set<std::uint32_t> open_;  // numbers of contacts that slide
  std::array<std::optional<Stem>, 3> stems_;
};

}  // namespace

void StemLog::begin_block(Frame frame) {
  rack_.observers().report_events();
  blocks_.push_back(frame);
}

void StemLog::played(const Event& event) {
  if (synth::is_of_listener(event)) {
    listener_.push_back({blocks_.size(), std::make_unique<const Event>(event)});
    return;
  }
  Track& track = tracks_[event.object];
  if (const auto* pose = event.verb.get_if<synth::verb::Pose>()) {
    track.entries.push_back({blocks_.size(), Posed{event.frame, pose->pose}});
    return;
  }
  synth::verb::Contact room;
  const auto* contact = contact_of(event, room);
  if (contact && !ends(contact->contact)) (is_slide(contact->contact) ? track.slides : track.rolls) = true;
  const bool one_way = event.verb.holds<synth::verb::Contact>();
  track.blows = track.blows || (synth::is_sound(effect_of(event)) && !one_way);
  if (const auto other = felt_in(event)) track.felt.insert(*other);
  track.entries.push_back({blocks_.size(), std::make_unique<const Event>(event)});
}

void StemLog::changed(const ObjectState* before, const ObjectState* after, Frame at) {
  if (!after) return;
  Track& track = tracks_[after->number];
  track.name = after->name;
  track.chaotic = after->map->bank().nonlinear.has_value();
  const bool new_bank = !before || before->bank_version != after->bank_version;
  const bool retuned = new_bank || before->material != after->material || before->dampers != after->dampers ||
                       before->modes != after->modes || before->map != after->map;
  if (!retuned) return;
  const auto how = new_bank ? Mixer::Install::replace : Mixer::Install::retune;
  auto level = new_bank ? nullptr : mode_change(*before, *after);
  track.entries.push_back(
      {blocks_.size(), std::make_unique<const Change>(Change{after->map, after->material, after->dampers, after->modes,
                                                             how, at, std::move(level)})});
}

Result<std::size_t> write_stems(const StemLog& log, const StemSettings& settings,
                                const std::function<bool(double done)>& progress) {
  std::error_code error;
  std::filesystem::create_directories(settings.folder, error);
  if (error) return fail(ErrorKind::input_output, "cannot make " + settings.folder.string() + ": " + error.message());
  std::vector<ObjectNumber> sounding;
  for (const auto& [number, track] : log.tracks()) {
    if (track.blows || track.slides || track.rolls) sounding.push_back(number);
  }
  std::size_t files = 0, done = 0;
  for (const ObjectNumber number : sounding) {
    ObjectStems stems(number, log, settings);
    const auto written = stems.write([&](double share) {
      return progress((static_cast<double>(done) + share) / static_cast<double>(sounding.size()));
    });
    if (!written) return written;
    files += *written;
    ++done;
  }
  return files;
}

}  // namespace ringdown::session
