#include "server/worker.h"

#include "server/turns.h"

#include <future>
#include <memory>
#include <utility>

namespace ringdown::server {

Worker::Worker(Task chore, std::chrono::milliseconds period)
    : chore_(std::move(chore)), period_(period), thread_([this](const std::stop_token& stop) { run(stop); }) {}

bool Worker::post(Task task) {
  {
    const std::scoped_lock lock(mutex_);
    if (tasks_.size() == kMaxTasks) return false;
    tasks_.push_back(std::move(task));
  }
  wake_.notify_one();
  return true;
}

void Worker::run(const std::stop_token& stop) {
  take_turns("carry out a task", stop, [&] {
    Task task;
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, stop, period_, [this] { return !tasks_.empty(); });
      if (!tasks_.empty()) {
        task = std::move(tasks_.front());
        tasks_.pop_front();
      }
    }
    if (task) task();
    chore_();
  });
}

void WorkerLine::connect(Worker* worker) {
  const std::scoped_lock lock(mutex_);
  worker_ = worker;
}

bool WorkerLine::post(Worker::Task task) {
  const std::scoped_lock lock(mutex_);
  return worker_ && worker_->post(std::move(task));
}

bool WorkerLine::post_and_wait(Worker::Task task) {
  const auto done = std::make_shared<std::promise<void>>();
  auto future = done->get_future();
  const bool posted = post([task = std::move(task), done] {
    task();
    done->set_value();
  });
  if (posted) future.wait_for(std::chrono::seconds(1));
  return posted;
}

}  // namespace ringdown::server
