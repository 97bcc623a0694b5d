#include "engine/solve/team.h"

namespace ringdown::solve {

Team::Team(int threads) : failures_(threads) {
  try {
    for (int i = 1; i < threads; ++i) helpers_.emplace_back([this, i] { help(i); });
  } catch (...) {  // the system gives no more threads; those already running would wait for ever
    ++round_;
    round_.notify_all();
    throw;
  }
}

Team::~Team() {
  part_ = nullptr;
  ++round_;
  round_.notify_all();
}

void Team::help(int number) {
  for (unsigned seen = 0;;) {
    round_.wait(seen);
    seen = round_;
    if (part_ == nullptr) return;
    try {
      (*part_)(number);
    } catch (...) {
      failures_[number] = std::current_exception();
    }
    if (--busy_ == 0) busy_.notify_one();
  }
}

void Team::run(const std::function<void(int)>& part) {
  part_ = &part;
  busy_ = static_cast<int>(helpers_.size());
  if (!helpers_.empty()) {
    ++round_;
    round_.notify_all();
  }
  try {
    part(0);
  } catch (...) {
    failures_[0] = std::current_exception();
  }
  for (int left = busy_; left > 0; left = busy_) busy_.wait(left);
  for (std::exception_ptr& failure : failures_) {
    if (failure) {
      const std::exception_ptr first = failure;
      for (std::exception_ptr& other : failures_) other = nullptr;
      std::rethrow_exception(first);
    }
  }
}

void Team::run_together(const std::function<void(int, const Member&)>& part) {
  if (helpers_.empty()) return part(0, Member());
  std::barrier<> meeting(size());
  run([&](int number) {
    try {
      part(number, Member(number, size(), meeting));
    } catch (...) {
      meeting.arrive_and_drop();
      throw;
    }
  });
}

}  // namespace ringdown::solve
