// Tells subscribers what goes on, at the rate each has asked for (/notify): objects that come, go and change groups,
// contacts (every strike that was taken, from OSC or from the scene), the peaks of the mix and of objects, the load,
// and the poses of the scene's bodies.
//
// A subscriber that sends nothing for kSilence_s is forgotten: programs that end do not say so over UDP. Its thread
// sleeps while nobody has subscribed, and neither what is played nor the objects' levels cost anything then.
#pragma once

#include "engine/base/result.h"
#include "protocol/reply.h"
#include "server/driver.h"
#include "server/observer.h"
#include "server/osc_ports.h"
#include "server/session.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

namespace ringdown::server {

inline constexpr std::size_t kMostSubscribers = 32;
inline constexpr std::size_t kMostContactsPerNotice = 256;  // the last ones; the others are not told
inline constexpr double kSilence_s = 60;

class Notifier final : public Observer {
 public:
  using Send = std::function<void(Peer, std::span<const std::byte>)>;
  using Clock = std::chrono::steady_clock;
  using Now = std::function<Clock::time_point()>;

  // Observes the session's rack, before anything is loaded into it. All must outlive it. `now` is what silence is
  // measured by, for tests. [main]
  Notifier(Session& session, const Driver& driver, Send send, Now now = Clock::now);
  ~Notifier() override;

  // A new subscriber, or a new rate for one. Refused when kMostSubscribers are there. [osc]
  Result<void> subscribe(Peer peer, double rate_hz);
  void unsubscribe(Peer peer);

  [[nodiscard]] std::size_t subscribers() const { return count_; }  // [any]

  // It lives. [osc]
  void heard_from(Peer peer);

  void played(const protocol::Event& event) override;
  void loaded(const RackObject& object) override;
  void retuned(const RackObject&) override {}
  void held(const RackObject&, const modal::Touches&, protocol::Frame) override {}
  void regrouped(const RackObject& object) override;
  void freed(const RackObject& object) override;

 private:
  struct Subscriber {
    Peer peer;
    Clock::duration period;
    Clock::time_point next, last_heard;
    float peak = 0;  // since its last notice, like the following
    std::vector<float> object_peaks = std::vector<float>(synth::kMostObjects);
    std::vector<bool> rang = std::vector<bool>(synth::kMostObjects);  // in its last notice
    std::vector<protocol::Event> contacts;
    std::vector<protocol::Reply> changes;  // of objects
  };
  void run(const std::stop_token& stop);
  void tell(const protocol::Reply& change);
  void count_subscribers();
  void take_peaks();
  void forget_silent();
  [[nodiscard]] std::vector<Subscriber> take_due(Clock::time_point now);
  void send_notice(const Subscriber& subscriber);
  [[nodiscard]] std::vector<protocol::Message> messages_for(const Subscriber& subscriber);

  Session& session_;
  const Driver& driver_;
  Send send_;
  Now now_;
  std::atomic<std::size_t> count_ = 0;
  std::mutex mutex_;  // guards subscribers_
  std::condition_variable_any wake_;
  std::vector<Subscriber> subscribers_;
  std::jthread thread_;  // last: it stops before what it uses goes away
};

}  // namespace ringdown::server
