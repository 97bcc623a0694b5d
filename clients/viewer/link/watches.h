// Decides for which objects the daemon reports mode amplitudes, and whether it sends the mix. The window watches at
// most kMaxWatched objects: the chosen one and the loudest. A subscription that delivers nothing is renewed. [one
// thread: the window's]
#pragma once

#include "clients/viewer/link/known_objects.h"
#include "clients/viewer/link/question.h"

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace ringdown::viewer {

class ObjectWatches {
 public:
  static constexpr std::size_t kMaxWatched = 16;

  void forget(const std::string& object) { watched_.erase(object); }

  // Adds the requests that begin and end watches. Clears the amplitudes of objects that are no longer watched.
  void add_requests(KnownObjects& objects, const std::string& chosen, double now_s, Requests& requests);

 private:
  [[nodiscard]] std::set<std::string> best(const KnownObjects& objects, const std::string& chosen) const;
  void replace(KnownObjects& objects, const std::set<std::string>& names, Requests& requests);

  Question choice_;
  std::map<std::string, Question> watched_;
};

class SoundWatch {
 public:
  void want(bool on) { wanted_ = on; }  // off by default
  [[nodiscard]] bool wanted() const { return wanted_; }
  void note_piece(double now_s) { last_piece_s_ = now_s; }

  // Adds /watch/sound while arriving data differ from the wanted state.
  void add_requests(double now_s, Requests& requests);

 private:
  bool wanted_ = false;
  std::optional<double> last_piece_s_;
  Question question_;
};

}  // namespace ringdown::viewer
