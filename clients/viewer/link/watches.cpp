#include "clients/viewer/link/watches.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace ringdown::viewer {
namespace {

constexpr double kWatchPatience_s = 2;
constexpr double kChoicePeriod_s = 0.25;  // how often the watched objects are chosen
constexpr double kSoundPatience_s = 1;
constexpr double kStickiness = 4;  // a watched object is replaced by one that is this many times as loud

}  // namespace

// The chosen object, then the loudest. A watched object keeps its watch until a much louder one needs it.
std::set<std::string> ObjectWatches::best(const KnownObjects& objects, const std::string& chosen) const {
  std::vector<std::pair<double, std::string>> ranked;
  for (const auto& [name, object] : objects.all()) {
    const bool watched = watched_.contains(name);
    if (name == chosen) {
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

void ObjectWatches::replace(KnownObjects& objects, const std::set<std::string>& names, Requests& requests) {
  for (auto it = watched_.begin(); it != watched_.end();) {
    if (names.contains(it->first)) {
      ++it;
      continue;
    }
    requests.emplace_back(protocol::WatchObject{object_named(it->first), false});
    if (const auto found = objects.all().find(it->first); found != objects.all().end()) {
      found->second.amplitudes.clear();
    }
    it = watched_.erase(it);
  }
  for (const std::string& name : names) watched_.try_emplace(name);
}

void ObjectWatches::add_requests(KnownObjects& objects, const std::string& chosen, double now_s, Requests& requests) {
  if (choice_.due(now_s, kChoicePeriod_s)) replace(objects, best(objects, chosen), requests);
  for (auto& [name, question] : watched_) {
    const KnownObject* known = std::as_const(objects).find(name);
    const bool reported = known && !known->amplitudes.empty() && now_s - known->amplitudes_at_s < kWatchPatience_s;
    if (!reported && question.due(now_s, kWatchPatience_s)) {
      requests.emplace_back(protocol::WatchObject{object_named(name), true});
    }
  }
}

void SoundWatch::add_requests(double now_s, Requests& requests) {
  const bool arrives = last_piece_s_ && now_s - *last_piece_s_ < kSoundPatience_s;
  if (arrives != wanted_ && question_.due(now_s, kSoundPatience_s)) {
    requests.emplace_back(protocol::WatchSound{wanted_});
  }
}

}  // namespace ringdown::viewer
