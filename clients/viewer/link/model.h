// What the window knows of the daemon: objects, scene, sound, load. Plain data for panels and the picture.
//
//   Model model(30);
//   model.apply(reply, now_s);                                   // each that came
//   for (auto& request : model.wants(now_s)) client.send(request);   // at every frame
//   for (const auto& [name, object] : model.objects()) ...
//
// It asks for what it lacks, and again when answers do not come: datagrams get lost. What it is told is not trusted:
// every list has a bound, and what goes past it is left out. `now_s` is the steady clock's. Modes are named by rank, by
// ascending frequency from 0. [one thread: the window's]
#pragma once

#include "clients/viewer/link/bank_transfer.h"
#include "clients/viewer/link/known_scene.h"
#include "clients/viewer/link/sound_history.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/mode_range.h"
#include "protocol/reply.h"
#include "protocol/request.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace ringdown::viewer {

struct KnownObject {
  std::string name;
  std::int32_t number = 0;
  std::int32_t version = 0;  // of its bank
  std::int32_t bank_bytes = 0;
  std::string bank_content;  // names what is in its file; objects with the same share the bank
  std::string bank_path;
  std::int32_t modes = 0;  // of the bank
  modal::ModeRange selected;
  modal::MaterialScale scale;
  double gain = 1, pan = 0;
  std::optional<std::string> group;

  std::shared_ptr<const KnownBank> bank;  // nothing until it has come
  double bank_progress = 0;               // 0 to 1
  std::string bank_fault;                 // one sentence; empty: none so far
  std::optional<double> bank_retry_at_s;  // when it is asked for again after a fault; nothing: never

  double peak = 0;  // how loud it was in the notice at peak_at_s; 0 when silent
  double peak_at_s = 0;
  std::vector<float> amplitudes;  // by rank; empty unless it is watched
  double amplitudes_at_s = 0;
};

struct KnownContact {
  std::string object;
  Vec3 point_m, impulse_ns;  // object frame
  double contact_time_s = 0;
  double at_s = 0;  // when it was told
};

struct KnownMessage {
  bool failed = false;  // else something was done
  std::string address;
  std::string sentence;  // of a failure
  std::optional<std::int32_t> number;
  double at_s = 0;
};

// The mix's level: `held` is the largest of the last kPeakHold_s.
struct KnownPeak {
  double now = 0, held = 0, held_at_s = 0;
};

class Model {
 public:
  static constexpr std::size_t kMaxObjects = 1024;
  static constexpr std::size_t kMaxContacts = 256;
  static constexpr double kContactLife_s = 2;
  static constexpr std::size_t kMaxMessages = 64;
  static constexpr std::size_t kMaxFiles = 8192;   // of the browser
  static constexpr std::size_t kMaxModes = 16384;  // of one object
  static constexpr std::size_t kMaxWatched = 16;
  static constexpr std::size_t kMaxBankBytesTotal = std::size_t{1} << 30;  // of all banks together, as files
  static constexpr double kPatience_s = 0.5;                               // after which something is asked for again
  static constexpr double kPeakHold_s = 1;

  // `notice_rate_hz` as the client's; `most_bank_bytes` at most of all banks together.
  explicit Model(double notice_rate_hz, std::size_t most_bank_bytes = kMaxBankBytesTotal);

  void apply(const protocol::Reply& reply, double now_s);
  std::vector<protocol::Request> wants(double now_s);
  void restart();  // the daemon is another one: forgets all but what was chosen

  // The object whose modes are shown: its bank comes first, and it is watched first. Empty: none.
  void choose(std::string object) { chosen_ = std::move(object); }
  [[nodiscard]] const std::string& chosen() const { return chosen_; }
  void watch_sound(bool on) { sound_wanted_ = on; }  // off at first

  [[nodiscard]] const std::map<std::string, KnownObject>& objects() const { return objects_; }
  [[nodiscard]] const KnownObject* object(const std::string& name) const;  // null: unknown
  [[nodiscard]] const KnownScene& scene() const { return scene_; }
  [[nodiscard]] KnownScene& scene() { return scene_; }                                  // for its clock
  [[nodiscard]] const std::deque<KnownContact>& contacts() const { return contacts_; }  // oldest first
  [[nodiscard]] const SoundHistory& sound() const { return sound_; }
  [[nodiscard]] const std::optional<protocol::StatusReply>& status() const { return status_; }
  [[nodiscard]] const protocol::NotifyLoad& load() const { return load_; }
  [[nodiscard]] const KnownPeak& peak() const { return peak_; }
  [[nodiscard]] const std::vector<std::string>& scene_files() const { return scene_files_; }
  [[nodiscard]] const std::vector<std::string>& bank_files() const { return bank_files_; }
  [[nodiscard]] const std::deque<KnownMessage>& messages() const { return messages_; }  // oldest first
  [[nodiscard]] bool recording() const { return status_ && status_->recording; }

  // Asks what there is to load once more, for files come and go.
  void browse_again() { browse_ = {}; }

 private:
  // Something that is asked for again and again until it has come.
  struct Question {
    std::optional<double> asked_at_s;
    // Whether it is time to ask; then it counts as asked.
    bool ask(double now_s, double patience_s) {
      if (asked_at_s && now_s - *asked_at_s <= patience_s) return false;
      asked_at_s = now_s;
      return true;
    }
  };
  struct Browsing {
    Question question;
    std::optional<std::int32_t> files;
    std::map<std::int32_t, protocol::BrowseFile> found;
    bool complete = false;
  };
  using Requests = std::vector<protocol::Request>;

  void on(const protocol::Done& reply, double now_s);
  void on(const protocol::Fail& reply, double now_s);
  void on(const protocol::StatusReply& reply, double now_s);
  void on(const protocol::ObjectReply& reply, double now_s);
  void on(const protocol::BankReply& reply, double now_s);
  void on(const protocol::BrowseReply& reply, double now_s);
  void on(const protocol::BrowseFile& reply, double now_s);
  void on(const protocol::NotifyObject& reply, double now_s);
  void on(const protocol::NotifyGroup& reply, double now_s);
  void on(const protocol::NotifyContact& reply, double now_s);
  void on(const protocol::NotifyPeak& reply, double now_s);
  void on(const protocol::NotifyObjectPeak& reply, double now_s);
  void on(const protocol::NotifyLoad& reply, double now_s);
  void on(const protocol::NotifySound& reply, double now_s);
  void on(const protocol::NotifyModes& reply, double now_s);

  KnownObject* find(const std::string& name);  // asks for one that is not known
  void forget(const std::string& name);
  void finish_browsing();
  void add_message(KnownMessage message);

  void want_descriptions(double now_s, Requests& requests);
  void want_bank(double now_s, Requests& requests);
  void want_watches(double now_s, Requests& requests);
  void want_sound(double now_s, Requests& requests);
  void finish_transfer(double now_s);
  void share_banks();
  [[nodiscard]] KnownObject* next_to_fetch(double now_s);
  [[nodiscard]] std::size_t bank_bytes_held() const;
  [[nodiscard]] std::set<std::string> to_watch() const;

  double notice_rate_hz_;
  std::size_t most_bank_bytes_;
  bool told_ = false;  // anything, so that there is somebody to ask
  std::map<std::string, KnownObject> objects_;
  std::map<std::string, Question> undescribed_;
  Question turn_, everything_;  // one object every two seconds; all, when some were missed
  std::string turn_of_;
  std::optional<BankTransfer> transfer_;
  std::map<std::string, std::weak_ptr<const KnownBank>> banks_;  // by content
  Question watching_;
  std::map<std::string, Question> watched_;
  KnownScene scene_;
  std::deque<KnownContact> contacts_;
  SoundHistory sound_;
  bool sound_wanted_ = false;
  std::optional<double> sound_at_s_;
  Question sound_question_;
  std::optional<protocol::StatusReply> status_;
  protocol::NotifyLoad load_;
  KnownPeak peak_;
  Browsing browse_;
  std::vector<std::string> scene_files_, bank_files_;
  std::deque<KnownMessage> messages_;
  std::string chosen_;
};

}  // namespace ringdown::viewer
