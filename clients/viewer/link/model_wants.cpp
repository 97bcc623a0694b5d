// What the model asks the daemon for.
#include "clients/viewer/link/model.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr std::size_t kMaxDescriptions = 16;  // asked for at a time
constexpr double kTurn_s = 2;
constexpr double kRetry_s = 5;  // after the daemon refused a bank
constexpr double kWatchPatience_s = 2;
constexpr double kWatchTurn_s = 0.25;  // how often it is chosen anew who is watched
constexpr double kSoundPatience_s = 1;
constexpr double kStickiness = 4;  // another object must be this much louder to be watched instead

protocol::ObjectRef named(const std::string& name) { return {name, std::nullopt}; }

}  // namespace

std::vector<protocol::Request> Model::wants(double now_s) {
  while (!contacts_.empty() && now_s - contacts_.front().at_s > kContactLife_s) contacts_.pop_front();
  Requests requests;
  if (!told_) return requests;
  want_descriptions(now_s, requests);
  if (auto request = scene_.wants(now_s)) requests.push_back(std::move(*request));
  want_bank(now_s, requests);
  want_watches(now_s, requests);
  want_sound(now_s, requests);
  if (!browse_.complete && browse_.question.ask(now_s, kPatience_s)) requests.emplace_back(protocol::Browse{});
  return requests;
}

void Model::want_descriptions(double now_s, Requests& requests) {
  std::size_t room = kMaxDescriptions;
  for (auto& [name, question] : undescribed_) {
    if (room == 0) break;
    --room;
    if (question.ask(now_s, kPatience_s)) requests.emplace_back(protocol::DescribeObject{named(name)});
  }
  // The notice that told of some has been lost: a pattern names them all.
  if (status_ && undescribed_.empty() && std::cmp_greater(status_->objects, objects_.size()) &&
      everything_.ask(now_s, kTurn_s)) {
    requests.emplace_back(protocol::DescribeObject{named("*")});
  }
  if (objects_.empty() || !turn_.ask(now_s, kTurn_s)) return;
  auto next = objects_.upper_bound(turn_of_);
  if (next == objects_.end()) next = objects_.begin();
  turn_of_ = next->first;
  requests.emplace_back(protocol::DescribeObject{named(turn_of_)});
}

void Model::want_bank(double now_s, Requests& requests) {
  finish_transfer(now_s);
  share_banks();
  if (!transfer_) {
    KnownObject* object = next_to_fetch(now_s);
    if (!object) return;
    if (bank_bytes_held() + static_cast<std::size_t>(std::max(0, object->bank_bytes)) > most_bank_bytes_) {
      object->bank_fault = "the bank of " + object->name +
                           " is not fetched: with it, those of all objects would have " + "more than " +
                           std::to_string(most_bank_bytes_) + " bytes";
      object->bank_retry_at_s = now_s + kRetry_s;
      return;
    }
    transfer_.emplace(BankTransfer::Subject{object->name, object->version, object->bank_bytes, object->bank_content});
  }
  for (auto& request : transfer_->wants(now_s)) requests.push_back(std::move(request));
}

void Model::finish_transfer(double now_s) {
  if (!transfer_) return;
  const auto found = objects_.find(transfer_->subject().object);
  const bool wanted = found != objects_.end() && !found->second.bank &&
                      found->second.version == transfer_->subject().version &&
                      found->second.bank_bytes == transfer_->subject().bytes;
  if (!wanted) return transfer_.reset();
  KnownObject& object = found->second;
  object.bank_progress = transfer_->progress();
  auto outcome = transfer_->outcome();
  if (!outcome) return;
  if (*outcome) {
    object.bank = std::move(**outcome);
    object.bank_fault.clear();
    banks_.insert_or_assign(object.bank_content, object.bank);
  } else {
    object.bank_fault = outcome->error().message;
    if (transfer_->refused()) object.bank_retry_at_s = now_s + kRetry_s;
  }
  transfer_.reset();
}

// A bank that one object has comes to the others that play the same file without being fetched again.
void Model::share_banks() {
  std::erase_if(banks_, [](const auto& bank) { return bank.second.expired(); });
  for (auto& [name, object] : objects_) {
    if (object.bank) continue;
    const auto found = banks_.find(object.bank_content);
    if (found == banks_.end()) continue;
    object.bank = found->second.lock();
    object.bank_fault.clear();
  }
}

KnownObject* Model::next_to_fetch(double now_s) {
  const auto lacks_bank = [now_s](const KnownObject& object) {
    return !object.bank && (object.bank_fault.empty() || (object.bank_retry_at_s && now_s > *object.bank_retry_at_s));
  };
  const auto chosen = objects_.find(chosen_);
  if (chosen != objects_.end() && lacks_bank(chosen->second)) return &chosen->second;
  const auto found = std::ranges::find_if(objects_, [&](const auto& known) { return lacks_bank(known.second); });
  return found == objects_.end() ? nullptr : &found->second;
}

std::size_t Model::bank_bytes_held() const {
  std::map<const KnownBank*, std::size_t> bytes;
  for (const auto& [name, object] : objects_) {
    if (object.bank) bytes[object.bank.get()] = static_cast<std::size_t>(object.bank_bytes);
  }
  return std::accumulate(bytes.begin(), bytes.end(), std::size_t{0},
                         [](std::size_t sum, const auto& bank) { return sum + bank.second; });
}

// The chosen one, then the loudest; one that is watched stays as long as nobody needs its place.
std::set<std::string> Model::to_watch() const {
  std::vector<std::pair<double, std::string>> ranked;
  for (const auto& [name, object] : objects_) {
    const bool watched = watched_.contains(name);
    if (name == chosen_) {
      ranked.emplace_back(std::numeric_limits<double>::infinity(), name);
    } else if (watched || object.peak > 0) {
      ranked.emplace_back(object.peak * (watched ? kStickiness : 1), name);
    }
  }
  const std::size_t count = std::min(ranked.size(), kMaxWatched);
  std::ranges::partial_sort(ranked, ranked.begin() + static_cast<std::ptrdiff_t>(count), std::greater<>());
  std::set<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.insert(std::move(ranked[i].second));
  return names;
}

void Model::want_watches(double now_s, Requests& requests) {
  if (watching_.ask(now_s, kWatchTurn_s)) {
    const std::set<std::string> names = to_watch();
    for (auto it = watched_.begin(); it != watched_.end();) {
      if (names.contains(it->first)) {
        ++it;
        continue;
      }
      requests.emplace_back(protocol::WatchObject{named(it->first), false});
      if (const auto found = objects_.find(it->first); found != objects_.end()) found->second.amplitudes.clear();
      it = watched_.erase(it);
    }
    for (const std::string& name : names) watched_.try_emplace(name);
  }
  for (auto& [name, question] : watched_) {
    const KnownObject* known = object(name);
    const bool told = known && !known->amplitudes.empty() && now_s - known->amplitudes_at_s < kWatchPatience_s;
    if (!told && question.ask(now_s, kWatchPatience_s)) requests.emplace_back(protocol::WatchObject{named(name), true});
  }
}

void Model::want_sound(double now_s, Requests& requests) {
  const bool told = sound_at_s_ && now_s - *sound_at_s_ < kSoundPatience_s;
  if (told != sound_wanted_ && sound_question_.ask(now_s, kSoundPatience_s)) {
    requests.emplace_back(protocol::WatchSound{sound_wanted_});
  }
}

}  // namespace ringdown::viewer
