// The daemon's objects as the window knows them, learnt from descriptions and notices.
//
// If a notice names an unknown object, the object's description is requested until it arrives. Descriptions of known
// objects are requested in turn, one every two seconds, because other clients may change them; and all at once when
// /status counts more objects than are known. Replies are not trusted: lists are bounded, and everything beyond a bound
// is ignored. Modes are numbered by rank: in ascending order of frequency, from 0. [one thread: the window's]
#pragma once

#include "clients/viewer/link/bank_transfer.h"
#include "clients/viewer/link/question.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/mode_range.h"
#include "protocol/reply.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::viewer {

struct KnownObject {
  std::string name;
  std::int32_t number = 0;
  std::int32_t version = 0;  // version of its bank
  std::int32_t bank_bytes = 0;
  std::string bank_content;  // identifies the content of the bank's file; objects with equal values share the bank
  std::string bank_path;
  std::int32_t modes = 0;  // number of the bank's modes
  modal::ModeRange selected;
  modal::MaterialScale scale;
  double gain = 1, pan = 0;
  bool mute = false, solo = false;
  double level_m = 0;  // of its liquid, in the object's size
  std::optional<std::string> group;

  std::shared_ptr<const KnownBank> bank;  // null until it has been fetched
  double bank_progress = 0;               // share of the bank that has been fetched, 0 to 1
  std::string bank_fault;                 // one sentence on why the bank cannot be shown; empty: no fault so far
  std::optional<double> bank_retry_at_s;  // when a bank with a fault is requested again; nothing: never

  double peak = 0;  // level in the notice received at peak_at_s; 0 when silent
  double peak_at_s = 0;
  std::vector<float> amplitudes;  // by rank; empty unless the object is watched
  double amplitudes_at_s = 0;
};

class KnownObjects {
 public:
  static constexpr std::size_t kMaxKnownObjects = 1024;
  static constexpr std::size_t kMaxModes = 16384;  // modes of one object

  [[nodiscard]] const std::map<std::string, KnownObject>& all() const { return objects_; }
  [[nodiscard]] std::map<std::string, KnownObject>& all() { return objects_; }
  [[nodiscard]] const KnownObject* find(const std::string& name) const;  // null: unknown

  void on(const protocol::ObjectReply& reply);
  void on(const protocol::NotifyObject& notice);  // for loaded or changed objects; freed ones go to forget()
  void on(const protocol::NotifyGroup& notice);
  void on(const protocol::NotifyObjectPeak& notice, double now_s);
  void on(const protocol::NotifyModes& notice, double now_s);

  // Like find(), but requests the description of an object that is not known.
  KnownObject* find_or_ask(const std::string& name);
  void forget(const std::string& name);

  // Adds the requests for descriptions that are due. `object_count` is how many objects the daemon says it has.
  void add_requests(double now_s, std::optional<std::int32_t> object_count, Requests& requests);

 private:
  std::map<std::string, KnownObject> objects_;
  std::map<std::string, Question> undescribed_;
  Question next_in_turn_, everything_;
  std::string last_in_turn_;
};

}  // namespace ringdown::viewer
