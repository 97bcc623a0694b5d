#include "server/refusal_log.h"

#include "server/log.h"

#include <utility>

namespace ringdown::server {

RefusalLog::RefusalLog() : RefusalLog(log_warning, Clock::now) {}

RefusalLog::RefusalLog(Write write, std::function<Clock::time_point()> now)
    : write_(std::move(write)), now_(std::move(now)) {}

void RefusalLog::add(const std::string& from, const std::string& sentence) {
  const std::scoped_lock lock(mutex_);
  end_second(now_());
  if (const auto known = repeats_.find(sentence); known != repeats_.end()) {
    ++known->second;
  } else if (repeats_.size() < kMaxPerSecond) {
    repeats_.emplace(sentence, 0);
    write_(from + ": " + sentence);
  } else {
    ++others_;
  }
}

void RefusalLog::report() {
  const std::scoped_lock lock(mutex_);
  end_second(now_());
}

void RefusalLog::end_second(Clock::time_point now) {
  if (now - begin_ < std::chrono::seconds(1)) return;
  begin_ = now;
  for (const auto& [sentence, count] : repeats_) {
    if (count > 0) write_(formatted("{} ({} times more)", sentence, count));
  }
  if (others_ > 0) write_(formatted("{} refusals with other sentences were not logged", others_));
  repeats_.clear();
  others_ = 0;
}

}  // namespace ringdown::server
