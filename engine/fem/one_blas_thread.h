// OpenBLAS on one thread while this lives: what it computes is then the same on every run, and does not compete with
// threads of ours. The setting is the process's: hold it around work, not inside of it. [worker]
#pragma once

namespace ringdown::fem {

class OneBlasThread {
 public:
  OneBlasThread();
  ~OneBlasThread();
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

 private:
  int before_;
};

}  // namespace ringdown::fem
