// Counts the bytes that malloc has given out and not got back. Linked into a test; or preloaded into ringdownd by
// ringdown_soak, and then the count stands in a file that RINGDOWN_HEAP_METER names and both have mapped. Resident
// memory moves by megabytes with what the allocator keeps; this is exact, so that a leak of a few bytes shows within a
// minute.
#include "tests/support/heap_meter.h"

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

namespace {

std::atomic<std::int64_t> own{0};  // until the file is mapped
std::atomic<std::atomic<std::int64_t>*> meter{&own};

__attribute__((constructor)) void map_the_meter() {
  const char* name = std::getenv("RINGDOWN_HEAP_METER");
  const int file = name ? ::open(name, O_RDWR | O_CLOEXEC) : -1;
  if (file < 0) return;
  void* const page = ::mmap(nullptr, sizeof(std::int64_t), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  if (page == MAP_FAILED) return;
  auto* const shared = static_cast<std::atomic<std::int64_t>*>(page);
  meter = shared;
  *shared += own.exchange(0);
}

void* counted(void* block) {
  if (block) *meter.load() += static_cast<std::int64_t>(::malloc_usable_size(block));
  return block;
}

void* uncounted(void* block) {
  if (block) *meter.load() -= static_cast<std::int64_t>(::malloc_usable_size(block));
  return block;
}

}  // namespace

std::int64_t ringdown::test::bytes_from_malloc() { return *meter.load(); }

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)  // these replace malloc, too

// The C library's own, under the names by which it may be reached when malloc is replaced.
#pragma GCC visibility push(default)  // shared libraries find these
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) { return counted(__libc_malloc(size)); }
void* calloc(std::size_t count, std::size_t size) { return counted(__libc_calloc(count, size)); }
void* realloc(void* block, std::size_t size) { return counted(__libc_realloc(uncounted(block), size)); }
void* memalign(std::size_t alignment, std::size_t size) { return counted(__libc_memalign(alignment, size)); }
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = memalign(alignment, size);
  return *block ? 0 : ENOMEM;
}
void free(void* block) { __libc_free(uncounted(block)); }
}
#pragma GCC visibility pop

#endif
