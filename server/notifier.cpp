#include "server/notifier.h"

#include "server/answers.h"
#include "server/describe.h"
#include "server/turns.h"

#include <algorithm>
#include <utility>

namespace ringdown::server {
namespace {

using synth::Event;

// The news of a strike; nothing of other events.
std::optional<protocol::NotifyContact> contact_news(const Event& event, const session::ObjectState& object) {
  if (const auto* strike = event.verb.get_if<synth::verb::Strike>()) {
    return protocol::NotifyContact{object.name, strike->point_m, strike->impulse_ns, strike->contact_time_s};
  }
  const auto* strike = event.verb.get_if<synth::verb::StrikeVertex>();
  if (!strike) return std::nullopt;
  const modal::Bank& bank = object.map->bank();
  const modal::Vec3f& point = bank.positions[strike->vertex < bank.point_count() ? strike->vertex : 0];
  return protocol::NotifyContact{object.name, object.material.size * Vec3{point[0], point[1], point[2]},
                                 strike->impulse_ns, strike->contact_time_s};
}

constexpr float kAudible = 1e-6f;  // -120 dB: quieter objects do not ring

protocol::NotifyObject object_news(const session::ObjectState& object, bool loaded) {
  return {static_cast<std::int32_t>(object.number), object.name, loaded};
}

protocol::NotifyGroup group_news(const session::ObjectState& object) {
  return {static_cast<std::int32_t>(object.number), object.name,
          object.group.empty() ? std::nullopt : std::optional(object.group)};
}

}  // namespace

Notifier::Notifier(session::Session& session, const Driver& driver, Send send, Now now)
    : session_(session), driver_(driver), send_(std::move(send)), now_(std::move(now)) {
  session_.rack().observers().add(*this);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Notifier::~Notifier() {
  thread_.request_stop();
  thread_.join();
  subscribers_.clear();
  count_subscribers();
  session_.rack().observers().remove(*this);
}

Result<void> Notifier::subscribe(Peer peer, double rate_hz) {
  session_.rack().observers().report_events();  // events from before the subscription are not for this subscriber
  const std::scoped_lock lock(mutex_);
  auto subscriber = std::ranges::find(subscribers_, peer, &Subscriber::peer);
  if (subscriber == subscribers_.end()) {
    if (subscribers_.size() == kMaxSubscribers) {
      return fail(ErrorKind::refused, "there are {} subscribers already", kMaxSubscribers);
    }
    subscriber = subscribers_.insert(subscriber, {.peer = peer});
    for (const session::ObjectSnapshot& object : session_.rack().objects()) {
      subscriber->changes.emplace_back(object_news(*object, true));
      if (!object->group.empty()) subscriber->changes.emplace_back(group_news(*object));
    }
  }
  subscriber->period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate_hz));
  subscriber->next = Clock::now();
  subscriber->last_heard = now_();
  count_subscribers();
  changed_ = true;
  wake_.notify_all();
  return {};
}

void Notifier::unsubscribe(Peer peer) {
  const std::scoped_lock lock(mutex_);
  std::erase_if(subscribers_, [&](const Subscriber& subscriber) { return subscriber.peer == peer; });
  count_subscribers();
}

void Notifier::count_subscribers() {
  count_ = subscribers_.size();
  session_.rack().mixer().meters().watch_objects(!subscribers_.empty());
  session_.scene().set_watched(!subscribers_.empty());
  count_watches();
}

void Notifier::heard_from(Peer peer) {
  if (count_ == 0) return;
  // A resolution of one second is enough, and a sender of many packets then rarely takes the mutex.
  const Clock::time_point now = now_();
  if (peer == heard_ && now - heard_at_ < std::chrono::seconds(1)) return;
  heard_ = peer;
  heard_at_ = now;
  const std::scoped_lock lock(mutex_);
  const auto subscriber = std::ranges::find(subscribers_, peer, &Subscriber::peer);
  if (subscriber != subscribers_.end()) subscriber->last_heard = now;
}

void Notifier::played(const Event& event) {
  if (count_ == 0) return;
  if (!event.verb.holds<synth::verb::Strike>() && !event.verb.holds<synth::verb::StrikeVertex>()) return;
  const std::scoped_lock lock(mutex_);
  for (Subscriber& subscriber : subscribers_) {
    if (subscriber.contacts.size() == 2 * kMaxContactsPerNotice) {
      subscriber.contacts.erase(subscriber.contacts.begin(), subscriber.contacts.begin() + kMaxContactsPerNotice);
    }
    subscriber.contacts.push_back(event);
  }
}

void Notifier::changed(const session::ObjectState* before, const session::ObjectState* after, synth::Frame) {
  if (!after) {
    add_news(object_news(*before, false));
    return end_watches_of(before->number);
  }
  if (!before || before->bank_version != after->bank_version || before->mute != after->mute ||
      before->solo != after->solo) {
    add_news(object_news(*after, true));
  }
  if (after->group != (before ? before->group : std::string())) add_news(group_news(*after));
}

void Notifier::broke(const session::BrokenObject& object) {
  if (count_ == 0) return;
  for (const protocol::Reply& news : news_of(object)) add_news(news);
}

void Notifier::end_watches_of(synth::ObjectNumber object) {
  const std::scoped_lock lock(mutex_);
  for (Subscriber& subscriber : subscribers_) subscriber.watched.erase(object);
  count_watches();
}

void Notifier::add_news(const protocol::Reply& change) {
  const std::scoped_lock lock(mutex_);
  for (Subscriber& subscriber : subscribers_) subscriber.changes.push_back(change);
}

void Notifier::run(const std::stop_token& stop) {
  take_turns("notify subscribers", stop, [&] {
    std::vector<Subscriber> due;
    std::vector<Peer> listeners;
    {
      std::unique_lock lock(mutex_);
      if (!wake_.wait(lock, stop, [this] { return !subscribers_.empty(); })) return;
      auto next = std::ranges::min(subscribers_, {}, &Subscriber::next).next;
      if (std::ranges::any_of(subscribers_, &Subscriber::hears_sound))
        next = std::min(next, Clock::now() + kSoundEvery);
      wake_.wait_until(lock, stop, next, [&] { return changed_ || Clock::now() >= next; });
      changed_ = false;
      lock.unlock();
      session_.rack().observers().report_events();
      lock.lock();
      forget_silent();
      take_peaks();
      due = take_due(Clock::now());
      listeners = take_listeners();
    }
    send_sound(listeners);
    for (const Subscriber& subscriber : due) send_notice(subscriber);
  });
}

void Notifier::forget_silent() {
  const auto now = now_();
  std::erase_if(subscribers_, [now](const Subscriber& subscriber) {
    return now - subscriber.last_heard > std::chrono::duration<double>(kSilence_s);
  });
  count_subscribers();
}

void Notifier::take_peaks() {
  synth::Mixer& mixer = session_.rack().mixer();
  const float peak = mixer.meters().take_peak();
  for (Subscriber& subscriber : subscribers_) subscriber.peak = std::max(subscriber.peak, peak);
  for (synth::ObjectNumber object = 0; object < synth::kMaxObjects; ++object) {
    const float peak_level = mixer.meters().take_peak_level(object);
    if (peak_level < kAudible) continue;
    for (Subscriber& subscriber : subscribers_) {
      subscriber.object_peaks[object] = std::max(subscriber.object_peaks[object], peak_level);
    }
  }
}

// Returns copies of the subscribers whose notice is due, and clears what the originals have gathered for it.
std::vector<Notifier::Subscriber> Notifier::take_due(Clock::time_point now) {
  std::vector<Subscriber> due;
  for (Subscriber& subscriber : subscribers_) {
    if (subscriber.next > now) continue;
    due.push_back(subscriber);
    subscriber.peak = 0;
    for (std::size_t object = 0; object < synth::kMaxObjects; ++object) {
      subscriber.rang[object] = std::exchange(subscriber.object_peaks[object], 0.0f) > 0;
    }
    subscriber.contacts.clear();
    subscriber.changes.clear();
    subscriber.next = std::max(subscriber.next + subscriber.period, now);
  }
  return due;
}

std::vector<protocol::Reply> Notifier::messages_for(const Subscriber& subscriber) {
  std::vector<protocol::Reply> messages;
  const auto add = [&](protocol::Reply reply) { messages.push_back(std::move(reply)); };
  for (const protocol::Reply& change : subscriber.changes) add(change);
  const std::size_t left_out = subscriber.contacts.size() - std::min(subscriber.contacts.size(), kMaxContactsPerNotice);
  for (const Event& event : std::span(subscriber.contacts).subspan(left_out)) {
    const auto object = session_.rack().find({.number = event.object});
    if (!object) continue;
    if (const auto news = contact_news(event, **object)) add(*news);
  }
  add(protocol::NotifyPeak{subscriber.peak});
  for (std::size_t number = 0; number < synth::kMaxObjects; ++number) {
    const float peak = subscriber.object_peaks[number];
    if (peak == 0 && !subscriber.rang[number]) continue;
    const auto object = session_.rack().find({.number = static_cast<synth::ObjectNumber>(number)});
    if (object) add(protocol::NotifyObjectPeak{(*object)->name, peak});
  }
  const Driver::Load load = driver_.load();
  const synth::MixerCounters& mixer = session_.rack().mixer().counters();
  add(protocol::NotifyLoad{load.mean, load.peak, load.xruns, static_cast<std::int32_t>(mixer.ringing_voices.load()),
                           static_cast<std::int32_t>(mixer.ringing_modes.load())});
  add_modes(subscriber, messages);
  const session::ScenePlayer::Poses scene = session_.scene().poses();
  add(protocol::NotifyScene{scene.version, scene.time_s, scene.paused});
  for (const scene::BodyState& body : scene.bodies) {
    if (body.waiting) continue;
    add(protocol::NotifyBody{static_cast<std::int32_t>(body.id), body.name,
                             body.object.empty() ? std::string("-") : body.object, body.position_m, body.rotation.x,
                             body.rotation.y, body.rotation.z, body.rotation.w});
  }
  return messages;
}

void Notifier::send_notice(const Subscriber& subscriber) {
  send_in_bundles(messages_for(subscriber), [&](std::span<const std::byte> packet) { send_(subscriber.peer, packet); });
}

}  // namespace ringdown::server
