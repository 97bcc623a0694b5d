// Sets the number of threads that OpenBLAS uses for as long as the object lives. [worker]
//
// Use 1 unless a single caller has large products to compute. Results are then the same in every run, and our own
// threads that call BLAS at the same time do not wait for each other. The setting belongs to the whole process, so hold
// the object around work, not inside it.
#pragma once

namespace ringdown::dense {

class BlasThreads {
 public:
  explicit BlasThreads(int threads);
  ~BlasThreads();
  BlasThreads(const BlasThreads&) = delete;
  BlasThreads& operator=(const BlasThreads&) = delete;

 private:
  int before_;
};

}  // namespace ringdown::dense
