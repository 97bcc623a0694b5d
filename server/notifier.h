// Sends notices to subscribers, at the rate that each has requested by /notify: objects that are added, removed or
// change groups; objects that break; contacts (every strike that the mixer has accepted, from OSC or from the scene);
// the peaks of the mix and of objects; the load; the scene's time, and the poses of its bodies. Subscribers that ask
// for it also get the amplitudes of objects' modes (/object/.../watch) and, every kSoundEvery, the samples of the mix
// (/watch/sound).
//
// A subscriber that sends nothing for kSilence_s is removed, because UDP does not report the end of a program. The
// notifier's thread sleeps while there is no subscriber; events and levels then cost nothing.
#pragma once

#include "engine/base/result.h"
#include "protocol/reply.h"
#include "server/driver.h"
#include "server/osc_stream.h"
#include "server/session/observers.h"
#include "server/session/session.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <set>
#include <span>
#include <thread>
#include <vector>

namespace ringdown::server {

inline constexpr std::size_t kMaxSubscribers = 32;
inline constexpr std::size_t kMaxContactsPerNotice = 256;  // latest contacts; earlier ones are left out
inline constexpr double kSilence_s = 60;
inline constexpr std::chrono::milliseconds kSoundEvery{20};

class Notifier final : public session::Observer {
 public:
  using Send = std::function<void(Peer, std::span<const std::byte>)>;
  using Clock = std::chrono::steady_clock;
  using Now = std::function<Clock::time_point()>;

  // Observes the session's rack, before anything is loaded into it. Session, driver and everything that `send` uses
  // must outlive the notifier. `now` measures silence; tests replace it. [main]
  Notifier(session::Session& session, const Driver& driver, Send send, Now now = Clock::now);
  ~Notifier() override;

  // Adds a subscriber, or changes a subscriber's rate. Fails if there are kMaxSubscribers already. [osc]
  Result<void> subscribe(Peer peer, double rate_hz);
  void unsubscribe(Peer peer);

  [[nodiscard]] std::size_t subscribers() const { return count_; }  // [any]

  // Starts or ends sending the sound, or the amplitudes of an object's modes, to a subscriber, until its subscription
  // ends. Fails for peers that have not subscribed, and if synth::kMaxWatched objects are watched. [osc]
  Result<void> watch_sound(Peer peer, bool on);
  Result<void> watch_object(Peer peer, const protocol::ObjectRef& object, bool on);

  // Resets the subscriber's silence timer, with a resolution of one second. [osc]
  void heard_from(Peer peer);

  void broke(const session::BrokenObject& object) override;
  void played(const synth::Event& event) override;
  void changed(const session::ObjectState* before, const session::ObjectState* after, synth::Frame at) override;

 private:
  struct Subscriber {
    Peer peer;
    Clock::duration period;
    Clock::time_point next, last_heard;
    bool hears_sound = false;
    std::set<synth::ObjectNumber> watched;
    // Since the last notice to this subscriber:
    float peak = 0;
    std::vector<float> object_peaks = std::vector<float>(synth::kMaxObjects);
    std::vector<synth::Event> contacts;
    std::vector<protocol::Reply> changes;  // changes of objects
    // In the last notice:
    std::vector<bool> rang = std::vector<bool>(synth::kMaxObjects);
  };
  void run(const std::stop_token& stop);
  void add_news(const protocol::Reply& change);
  void end_watches_of(synth::ObjectNumber object);
  void count_subscribers();
  void count_watches();
  [[nodiscard]] std::vector<Peer> take_listeners();
  void send_sound(const std::vector<Peer>& listeners);
  void add_modes(const Subscriber& subscriber, std::vector<protocol::Reply>& messages);
  void take_peaks();
  void forget_silent();
  [[nodiscard]] std::vector<Subscriber> take_due(Clock::time_point now);
  void send_notice(const Subscriber& subscriber);
  [[nodiscard]] std::vector<protocol::Reply> messages_for(const Subscriber& subscriber);

  session::Session& session_;
  const Driver& driver_;
  Send send_;
  Now now_;
  std::atomic<std::size_t> count_ = 0;
  Peer heard_{};                  // osc: the last sender for whom heard_from() reset the timer, and when
  Clock::time_point heard_at_{};  // osc
  std::mutex mutex_;              // guards all members below except the thread
  std::condition_variable_any wake_;
  std::vector<Subscriber> subscribers_;
  std::set<synth::ObjectNumber> watched_;  // objects watched by at least one subscriber
  bool changed_ = false;                   // subscribers have changed since the thread began to wait
  synth::Frame sound_from_ = 0;            // samples before this frame are for an earlier listener
  std::jthread thread_;                    // last member: ends before the others are destroyed
};

}  // namespace ringdown::server
