// How many threads OpenBLAS uses, for as long as this lives. [worker]
//
// One, unless a single caller has large products to do: what is computed is then the same on every run, and threads of
// ours that call BLAS at the same time do not wait for each other. The setting is the process's: hold it around work,
// not inside of it.
#pragma once

namespace ringdown::fem {

class BlasThreads {
 public:
  explicit BlasThreads(int threads);
  ~BlasThreads();
  BlasThreads(const BlasThreads&) = delete;
  BlasThreads& operator=(const BlasThreads&) = delete;

 private:
  int before_;
};

}  // namespace ringdown::fem
