#include "engine/dense/blas_threads.h"

#include <cblas.h>

namespace ringdown::dense {

BlasThreads::BlasThreads(int threads) : before_(openblas_get_num_threads()) { openblas_set_num_threads(threads); }
BlasThreads::~BlasThreads() { openblas_set_num_threads(before_); }

}  // namespace ringdown::dense
