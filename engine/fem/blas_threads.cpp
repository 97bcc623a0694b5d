#include "engine/fem/blas_threads.h"

#include <cblas.h>

namespace ringdown::fem {

BlasThreads::BlasThreads(int threads) : before_(openblas_get_num_threads()) { openblas_set_num_threads(threads); }
BlasThreads::~BlasThreads() { openblas_set_num_threads(before_); }

}  // namespace ringdown::fem
