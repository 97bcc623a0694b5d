#include "engine/base/blas_memory.h"

#include "engine/base/in_parallel.h"

#include <string>
#include <sys/mman.h>

extern "C" int openblas_get_num_threads() __attribute__((weak));  // null where OpenBLAS is not linked

namespace ringdown {

Result<void> check_blas_memory() {
  if (!openblas_get_num_threads) return {};
  constexpr std::size_t kOfAThread = std::size_t{128} << 20;
  const std::size_t bytes = kOfAThread * static_cast<std::size_t>(thread_count(0));
  void* const room = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room != MAP_FAILED) {
    ::munmap(room, bytes);
    return {};
  }
  return fail(ErrorKind::no_memory,
              "there is not enough memory to start: OpenBLAS takes 128 MiB of address space for each thread; raise the "
              "limit (ulimit -v), or set OPENBLAS_NUM_THREADS=1 and RINGDOWN_THREADS=1");
}

}  // namespace ringdown
