// The thread that may take its time: it reads files and builds voices, one task after the other, in order.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace ringdown::server {

class Worker {
 public:
  using Task = std::function<void()>;

  // Tasks that may wait. Past it, post() refuses.
  static constexpr std::size_t kMaxTasks = 1024;

  // Runs `chore` between tasks, at least every `period`. Both run on the worker's own thread.
  Worker(Task chore, std::chrono::milliseconds period);
  ~Worker() = default;  // finishes the task at hand, drops the others

  // False when kMaxTasks are waiting. [any but audio]
  [[nodiscard]] bool post(Task task);

 private:
  void run(const std::stop_token& stop);

  Task chore_;
  std::chrono::milliseconds period_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::deque<Task> tasks_;
  std::jthread thread_;  // last: it stops before what it uses goes away
};

// A way to the worker for those who live longer than it: the driver and the scene. [any but audio]
class WorkerLine {
 public:
  // While it lives, tasks reach `worker`; otherwise they are refused.
  class Connection {
   public:
    Connection(WorkerLine& line, Worker& worker) : line_(line) { line_.connect(&worker); }
    ~Connection() { line_.connect(nullptr); }
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

   private:
    WorkerLine& line_;
  };

  // False when there is no worker, or too many tasks are waiting.
  bool post(Worker::Task task);

  // Waits besides until the task is done, but no longer than a second: in freewheel sound does not wait for the worker.
  bool post_and_wait(Worker::Task task);

 private:
  void connect(Worker* worker);

  std::mutex mutex_;
  Worker* worker_ = nullptr;
};

}  // namespace ringdown::server
