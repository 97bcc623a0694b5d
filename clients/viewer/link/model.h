// Everything the window knows of the daemon: objects, scene, sound, load, files, messages. Plain data for the panels
// and the picture.
//
//   Model model(30);
//   model.apply(reply, now_s);                                       // each reply and notice that came
//   for (auto& request : model.wants(now_s)) client.send(request);   // at every frame
//   for (const auto& [name, object] : model.objects()) ...
//
// The model requests missing data repeatedly until the answer arrives, because datagrams get lost. Replies are not
// trusted: every list has a bound, and everything beyond a bound is ignored. `now_s` is the steady clock's time. [one
// thread: the window's]
#pragma once

#include "clients/viewer/link/bank_fetcher.h"
#include "clients/viewer/link/file_browser.h"
#include "clients/viewer/link/known_objects.h"
#include "clients/viewer/link/known_scene.h"
#include "clients/viewer/link/sound_history.h"
#include "clients/viewer/link/watches.h"
#include "protocol/reply.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace ringdown::viewer {

struct KnownContact {
  std::string object;
  Vec3 point_m, impulse_ns;  // object frame
  double contact_time_s = 0;
  double at_s = 0;  // when the notice arrived
};

struct KnownMessage {
  bool failed = false;  // false: a request was carried out
  std::string address;
  std::string sentence;  // sentence of a failure
  std::optional<std::int32_t> number;
  double at_s = 0;
  std::uint64_t order = 0;  // how many messages came before
};

// The mix's level; `held` is the maximum of the last kPeakHold_s.
struct KnownPeak {
  double now = 0, held = 0, held_at_s = 0;
};

class Model {
 public:
  static constexpr std::size_t kMaxContacts = 256;
  static constexpr double kContactLife_s = 2;
  static constexpr std::size_t kMaxMessages = 64;
  static constexpr double kPeakHold_s = 1;

  // `notice_rate_hz` is that of the client; `max_bank_bytes` bounds the size of all banks together.
  explicit Model(double notice_rate_hz, std::size_t max_bank_bytes = BankFetcher::kMaxBytesTotal);

  void apply(const protocol::Reply& reply, double now_s);
  Requests wants(double now_s);

  // Call when another daemon answers: forgets everything except the chosen object and whether sound is wanted.
  void restart();

  // Sets the object whose modes are shown: its bank is fetched first, and it is always watched. Empty: none.
  void choose(std::string object) { chosen_ = std::move(object); }
  [[nodiscard]] const std::string& chosen() const { return chosen_; }
  void watch_sound(bool on) { sound_watch_.want(on); }  // off at first

  [[nodiscard]] const std::map<std::string, KnownObject>& objects() const { return objects_.all(); }
  [[nodiscard]] const KnownObject* object(const std::string& name) const { return objects_.find(name); }
  [[nodiscard]] const KnownScene& scene() const { return scene_; }
  [[nodiscard]] KnownScene& scene() { return scene_; }                                  // mutable for its clock
  [[nodiscard]] const std::deque<KnownContact>& contacts() const { return contacts_; }  // oldest first
  [[nodiscard]] const SoundHistory& sound() const { return sound_; }
  [[nodiscard]] const std::optional<protocol::StatusReply>& status() const { return status_; }
  [[nodiscard]] const protocol::NotifyLoad& load() const { return load_; }
  [[nodiscard]] const KnownPeak& peak() const { return peak_; }
  [[nodiscard]] const FileBrowser& files() const { return files_; }
  [[nodiscard]] FileBrowser& files() { return files_; }
  [[nodiscard]] const std::deque<KnownMessage>& messages() const { return messages_; }  // oldest first
  [[nodiscard]] std::uint64_t message_count() const { return message_count_; }          // of all messages so far

  // Returns whether the scene is described as it is now, and the bank of every object that a body plays has arrived, or
  // is known to be unavailable.
  [[nodiscard]] bool has_whole_scene() const;
  [[nodiscard]] bool recording() const { return status_ && status_->recording; }

 private:
  void on(const protocol::Done& reply, double now_s);
  void on(const protocol::Fail& reply, double now_s);
  void on(const protocol::NotifyObject& notice);
  void on(const protocol::NotifyContact& notice, double now_s);
  void on(const protocol::NotifyPeak& notice, double now_s);
  void on(const protocol::NotifySound& notice, double now_s);
  void forget(const std::string& object);
  void add_message(KnownMessage message);

  double notice_rate_hz_;
  std::size_t max_bank_bytes_;
  bool has_daemon_ = false;  // whether anything has arrived, so that there is a daemon to ask
  KnownObjects objects_;
  BankFetcher banks_;
  ObjectWatches watches_;
  KnownScene scene_;
  std::deque<KnownContact> contacts_;
  SoundWatch sound_watch_;
  SoundHistory sound_;
  std::optional<protocol::StatusReply> status_;
  protocol::NotifyLoad load_;
  KnownPeak peak_;
  FileBrowser files_;
  std::deque<KnownMessage> messages_;
  std::uint64_t message_count_ = 0;
  std::string chosen_;
};

}  // namespace ringdown::viewer
