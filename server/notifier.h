// Sends subscribers what goes on, at the rate each has asked for (/notify): objects that come, go and change groups,
// contacts (every strike that was taken, from OSC or from the scene), the peaks of the mix and of objects, the load,
// the scene's time, and the poses of its bodies. Those who ask for it get the amplitudes of objects' modes as
// well, and, every kSoundEvery, the samples of the mix.
//
// A subscriber that sends nothing for kSilence_s is forgotten: programs that end do not say so over UDP. Its thread
// sleeps while nobody has subscribed, and neither what is played nor the objects' levels cost anything then.
#pragma once

#include "engine/base/result.h"
#include "protocol/reply.h"
#include "server/driver.h"
#include "server/osc_ports.h"
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
inline constexpr std::size_t kMaxContactsPerNotice = 256;  // the last ones; the others are left out
inline constexpr double kSilence_s = 60;
inline constexpr std::chrono::milliseconds kSoundEvery{20};

class Notifier final : public session::Observer {
 public:
  using Send = std::function<void(Peer, std::span<const std::byte>)>;
  using Clock = std::chrono::steady_clock;
  using Now = std::function<Clock::time_point()>;

  // Observes the session's rack, before anything is loaded into it. All must outlive it. `now` is what silence is
  // measured by, for tests. [main]
  Notifier(session::Session& session, const Driver& driver, Send send, Now now = Clock::now);
  ~Notifier() override;

  // A new subscriber, or a new rate for one. Refused when kMaxSubscribers are there. [osc]
  Result<void> subscribe(Peer peer, double rate_hz);
  void unsubscribe(Peer peer);

  [[nodiscard]] std::size_t subscribers() const { return count_; }  // [any]

  // Whether a subscriber is sent the sound, or an object's amplitudes; they end with its subscription. Refused to
  // others than subscribers, and when synth::kMaxWatched objects are watched. [osc]
  Result<void> watch_sound(Peer peer, bool on);
  Result<void> watch_object(Peer peer, const protocol::ObjectRef& object, bool on);

  // Resets the subscriber's silence timer, to the second. [osc]
  void heard_from(Peer peer);

  void played(const synth::Event& event) override;
  void changed(const session::ObjectState* before, const session::ObjectState* after, synth::Frame at) override;

 private:
  struct Subscriber {
    Peer peer;
    Clock::duration period;
    Clock::time_point next, last_heard;
    bool hears = false;  // the sound
    std::set<synth::ObjectNumber> watched;
    float peak = 0;  // since its last notice, like the following
    std::vector<float> object_peaks = std::vector<float>(synth::kMaxObjects);
    std::vector<bool> rang = std::vector<bool>(synth::kMaxObjects);  // in its last notice
    std::vector<synth::Event> contacts;
    std::vector<protocol::Reply> changes;  // of objects
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
  Peer heard_{};                  // osc: who sent a packet last, and when that was noted
  Clock::time_point heard_at_{};  // osc
  std::mutex mutex_;              // guards all that follows but the thread
  std::condition_variable_any wake_;
  std::vector<Subscriber> subscribers_;
  std::set<synth::ObjectNumber> watched_;  // by one of them
  bool changed_ = false;                   // since the thread began to wait
  synth::Frame sound_from_ = 0;            // what the tap holds from before is from an earlier listener
  std::jthread thread_;                    // last: it stops before what it uses goes away
};

}  // namespace ringdown::server
