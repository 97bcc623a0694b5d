// A thread for slow tasks: it reads files and builds voices, one task after the other, in order.
//
//   Worker worker([&] { rack.collect(); }, 50ms);
//   if (!worker.post([&] { load(); })) refuse();
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

  // Maximum number of waiting tasks; post() refuses more.
  static constexpr std::size_t kMaxTasks = 1024;

  // Runs `chore` after each task, and every `period` if there is no task. Tasks and chore run on the worker's thread.
  Worker(Task chore, std::chrono::milliseconds period);
  ~Worker() = default;  // finishes the present task, drops the others

  // Returns false when kMaxTasks are waiting. [any but audio]
  [[nodiscard]] bool post(Task task);

 private:
  void run(const std::stop_token& stop);

  Task chore_;
  std::chrono::milliseconds period_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::deque<Task> tasks_;
  std::jthread thread_;  // last member: ends before the others are destroyed
};

// Posts tasks to a worker that may not exist yet, or not any more; used by the driver and the scene, which live longer
// than the worker. [any but audio]
class WorkerLine {
 public:
  // While a Connection exists, tasks reach `worker`; otherwise they are refused.
  class Connection {
   public:
    Connection(WorkerLine& line, Worker& worker) : line_(line) { line_.connect(&worker); }
    ~Connection() { line_.connect(nullptr); }
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

   private:
    WorkerLine& line_;
  };

  // Returns false when there is no worker or too many tasks are waiting.
  bool post(Worker::Task task);

  // Posts the task and waits until it is done, but no longer than a second. In freewheel, where blocks are rendered as
  // fast as possible, the sound would otherwise not wait for the task.
  bool post_and_wait(Worker::Task task);

 private:
  void connect(Worker* worker);

  std::mutex mutex_;
  Worker* worker_ = nullptr;
};

}  // namespace ringdown::server
