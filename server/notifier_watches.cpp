// Subscribers can watch more than notices: the samples of the mix, and the amplitudes of objects' modes.
#include "server/notifier.h"

#include "protocol/defaults.h"
#include "protocol/wire/message.h"
#include "server/answers.h"

#include <algorithm>

namespace ringdown::server {
namespace {

using synth::ObjectNumber;

static_assert(synth::kTappedFrames <= protocol::kMaxSoundFrames);

tl::unexpected<Error> not_subscribed() {
  return fail(ErrorKind::refused, "only a subscriber can watch; send /notify first");
}

}  // namespace

Result<void> Notifier::watch_sound(Peer peer, bool on) {
  const std::scoped_lock lock(mutex_);
  const auto subscriber = std::ranges::find(subscribers_, peer, &Subscriber::peer);
  if (subscriber == subscribers_.end()) return not_subscribed();
  subscriber->hears_sound = on;
  count_subscribers();
  changed_ = true;
  wake_.notify_all();
  return {};
}

Result<void> Notifier::watch_object(Peer peer, const protocol::ObjectRef& ref, bool on) {
  const auto object = session_.rack().find(ref);
  if (!object) return fail(object);
  const std::scoped_lock lock(mutex_);
  const auto subscriber = std::ranges::find(subscribers_, peer, &Subscriber::peer);
  if (subscriber == subscribers_.end()) return not_subscribed();
  if (on && !session_.rack().mixer().meters().mode_watch.watch((*object)->number)) {
    return fail(ErrorKind::refused, "object: {} objects are watched already", synth::kMaxWatched);
  }
  if (on) {
    subscriber->watched.insert((*object)->number);
    watched_.insert((*object)->number);
  } else {
    subscriber->watched.erase((*object)->number);
  }
  count_subscribers();
  return {};
}

// Makes the mixer keep samples and amplitudes only for what at least one subscriber watches.
void Notifier::count_watches() {
  synth::Mixer& mixer = session_.rack().mixer();
  const bool heard = std::ranges::any_of(subscribers_, &Subscriber::hears_sound);
  if (heard && !mixer.sound_tap().watched()) sound_from_ = mixer.counters().frames.load();
  mixer.sound_tap().watch(heard);
  std::erase_if(watched_, [&](ObjectNumber object) {
    if (std::ranges::any_of(subscribers_, [object](const Subscriber& s) { return s.watched.contains(object); })) {
      return false;
    }
    mixer.meters().mode_watch.unwatch(object);
    return true;
  });
}

std::vector<Peer> Notifier::take_listeners() {
  synth::SoundTap& tap = session_.rack().mixer().sound_tap();
  for (const synth::SoundTap::Piece* piece = tap.front(); piece && piece->frame < sound_from_; piece = tap.front()) {
    tap.pop();
  }
  std::vector<Peer> listeners;
  for (const Subscriber& subscriber : subscribers_) {
    if (subscriber.hears_sound) listeners.push_back(subscriber.peer);
  }
  return listeners;
}

// Sends the samples since the last call. Consecutive pieces are joined up to kMaxSoundFrames.
void Notifier::send_sound(const std::vector<Peer>& listeners) {
  synth::SoundTap& tap = session_.rack().mixer().sound_tap();
  std::vector<protocol::Reply> pieces;
  synth::Frame next = 0;
  protocol::NotifySound sound;
  std::vector<float> samples;
  const auto close = [&] {
    if (samples.empty()) return;
    sound.samples = wire::encode_floats(samples);
    pieces.emplace_back(sound);
    samples.clear();
  };
  for (; const synth::SoundTap::Piece* piece = tap.front(); tap.pop()) {
    const bool fits = samples.size() + 2 * piece->frames <= 2 * std::size_t{protocol::kMaxSoundFrames};
    if (!fits || piece->frame != next || piece->sample_rate_hz != sound.sample_rate_hz) close();
    if (samples.empty()) {
      sound.frame = static_cast<std::int32_t>(piece->frame % protocol::kFrameModulus);
      sound.sample_rate_hz = piece->sample_rate_hz;
    }
    samples.insert(samples.end(), piece->samples.begin(),
                   piece->samples.begin() + static_cast<std::ptrdiff_t>(2 * piece->frames));
    next = piece->frame + static_cast<synth::Frame>(piece->frames);
  }
  close();
  for (const Peer& peer : listeners) {
    send_in_bundles(pieces, [&](std::span<const std::byte> packet) { send_(peer, packet); });
  }
}

// Appends the amplitudes of the objects that the subscriber watches, each object's by ascending frequency.
void Notifier::add_modes(const Subscriber& subscriber, std::vector<protocol::Reply>& messages) {
  std::vector<float> amplitudes, ordered;
  for (const ObjectNumber number : subscriber.watched) {
    const auto object = session_.rack().find({.number = number});
    if (!object || !session_.rack().mixer().meters().mode_watch.read(number, (*object)->map->bank(), amplitudes))
      continue;
    ordered.clear();
    for (const std::uint32_t mode : (*object)->map->by_frequency()) ordered.push_back(amplitudes[mode]);
    for (std::span<const float> rest = ordered; !rest.empty();) {
      const std::size_t count = std::min<std::size_t>(protocol::kMaxModeAmplitudes, rest.size());
      messages.emplace_back(protocol::NotifyModes{(*object)->name,
                                                  static_cast<std::int32_t>(ordered.size() - rest.size()),
                                                  wire::encode_floats(rest.first(count))});
      rest = rest.subspan(count);
    }
  }
}

}  // namespace ringdown::server
