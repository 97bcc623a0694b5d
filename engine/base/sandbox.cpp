#include "engine/base/sandbox.h"

#include <array>
#include <cerrno>
#include <cstddef>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace ringdown {
namespace {

namespace fs = std::filesystem;

// Landlock has no functions in the C library.
long create_ruleset(const landlock_ruleset_attr* rights, std::size_t size, unsigned flags) {
  return ::syscall(SYS_landlock_create_ruleset, rights, size, flags);
}

long landlock_version() { return create_ruleset(nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION); }

bool is_alone() {
  std::error_code error;
  return std::distance(fs::directory_iterator("/proc/self/task", error), {}) == 1;
}

void allow_reading(int ruleset, const fs::path& path) {
  landlock_path_beneath_attr rule{};
  rule.parent_fd = ::open(path.c_str(), O_PATH | O_CLOEXEC);
  if (rule.parent_fd < 0) return;
  std::error_code error;
  rule.allowed_access = LANDLOCK_ACCESS_FS_READ_FILE;
  if (fs::is_directory(path, error)) rule.allowed_access |= LANDLOCK_ACCESS_FS_READ_DIR;
  ::syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
  ::close(rule.parent_fd);
}

// Every right of Landlock's first version, from executing (bit 0) to making symbolic links (bit 12).
constexpr std::uint64_t kAllFileRights = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;

bool confine_files(const std::vector<fs::path>& readable) {
  if (landlock_version() < 1 || !is_alone()) return false;
  landlock_ruleset_attr rights{};
  rights.handled_access_fs = kAllFileRights;
  const int ruleset = static_cast<int>(create_ruleset(&rights, sizeof rights, 0));
  if (ruleset < 0) return false;
  for (const fs::path& path : readable) allow_reading(ruleset, path);
  const bool confined = ::syscall(SYS_landlock_restrict_self, ruleset, 0) == 0;
  ::close(ruleset);
  return confined;
}

// The filter is a list of calls that fail rather than of those that are allowed: what the C and C++ libraries need
// differs between their versions, while a new call that can do harm needs a new kernel. Calls that the architecture
// lacks are left out by the macro.
#define RINGDOWN_CALL(name) SYS_##name
constexpr std::array kRefusedCalls = {
    // programs and processes
    RINGDOWN_CALL(execve),
    RINGDOWN_CALL(execveat),
    RINGDOWN_CALL(ptrace),
    RINGDOWN_CALL(process_vm_readv),
    RINGDOWN_CALL(process_vm_writev),
    RINGDOWN_CALL(pidfd_open),
    RINGDOWN_CALL(pidfd_send_signal),
    RINGDOWN_CALL(pidfd_getfd),
    RINGDOWN_CALL(rt_sigqueueinfo),
    RINGDOWN_CALL(rt_tgsigqueueinfo),
    RINGDOWN_CALL(tkill),
    RINGDOWN_CALL(setns),
    RINGDOWN_CALL(unshare),
    RINGDOWN_CALL(setpgid),
    RINGDOWN_CALL(setsid),
    // other ways to the network and to other processes
    RINGDOWN_CALL(socket),
    RINGDOWN_CALL(socketpair),
    RINGDOWN_CALL(connect),
    RINGDOWN_CALL(bind),
    RINGDOWN_CALL(listen),
    RINGDOWN_CALL(sendto),
    RINGDOWN_CALL(sendmsg),
    RINGDOWN_CALL(sendmmsg),
    RINGDOWN_CALL(shmget),
    RINGDOWN_CALL(shmat),
    RINGDOWN_CALL(msgget),
    RINGDOWN_CALL(semget),
    RINGDOWN_CALL(mq_open),
    RINGDOWN_CALL(mq_unlink),
    // files changed by name
    RINGDOWN_CALL(truncate),
    RINGDOWN_CALL(unlinkat),
    RINGDOWN_CALL(renameat2),
    RINGDOWN_CALL(linkat),
    RINGDOWN_CALL(symlinkat),
    RINGDOWN_CALL(mkdirat),
    RINGDOWN_CALL(mknodat),
    RINGDOWN_CALL(fchmod),
    RINGDOWN_CALL(fchmodat),
    RINGDOWN_CALL(fchown),
    RINGDOWN_CALL(fchownat),
    RINGDOWN_CALL(utimensat),
    RINGDOWN_CALL(setxattr),
    RINGDOWN_CALL(lsetxattr),
    RINGDOWN_CALL(fsetxattr),
    RINGDOWN_CALL(removexattr),
    RINGDOWN_CALL(lremovexattr),
    RINGDOWN_CALL(fremovexattr),
    RINGDOWN_CALL(open_by_handle_at),
    RINGDOWN_CALL(name_to_handle_at),
    RINGDOWN_CALL(fanotify_init),
    // the machine
    RINGDOWN_CALL(mount),
    RINGDOWN_CALL(umount2),
    RINGDOWN_CALL(pivot_root),
    RINGDOWN_CALL(chroot),
    RINGDOWN_CALL(move_mount),
    RINGDOWN_CALL(open_tree),
    RINGDOWN_CALL(fsopen),
    RINGDOWN_CALL(fsmount),
    RINGDOWN_CALL(swapon),
    RINGDOWN_CALL(swapoff),
    RINGDOWN_CALL(reboot),
    RINGDOWN_CALL(sethostname),
    RINGDOWN_CALL(setdomainname),
    RINGDOWN_CALL(init_module),
    RINGDOWN_CALL(finit_module),
    RINGDOWN_CALL(delete_module),
    RINGDOWN_CALL(kexec_load),
    RINGDOWN_CALL(settimeofday),
    RINGDOWN_CALL(clock_settime),
    RINGDOWN_CALL(clock_adjtime),
    RINGDOWN_CALL(adjtimex),
    RINGDOWN_CALL(acct),
    RINGDOWN_CALL(quotactl),
    RINGDOWN_CALL(bpf),
    RINGDOWN_CALL(perf_event_open),
    RINGDOWN_CALL(userfaultfd),
    RINGDOWN_CALL(io_uring_setup),
    RINGDOWN_CALL(add_key),
    RINGDOWN_CALL(request_key),
    RINGDOWN_CALL(keyctl),
    RINGDOWN_CALL(personality),
// The older names of the same calls.
#ifdef SYS_fork
    RINGDOWN_CALL(fork),
    RINGDOWN_CALL(vfork),
    RINGDOWN_CALL(creat),
    RINGDOWN_CALL(unlink),
    RINGDOWN_CALL(rename),
    RINGDOWN_CALL(link),
    RINGDOWN_CALL(symlink),
    RINGDOWN_CALL(mkdir),
    RINGDOWN_CALL(rmdir),
    RINGDOWN_CALL(mknod),
    RINGDOWN_CALL(chmod),
    RINGDOWN_CALL(chown),
    RINGDOWN_CALL(lchown),
    RINGDOWN_CALL(utime),
    RINGDOWN_CALL(utimes),
    RINGDOWN_CALL(futimesat),
#endif
#ifdef SYS_renameat
    RINGDOWN_CALL(renameat),
#endif
};
#undef RINGDOWN_CALL

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
constexpr std::uint32_t kForeignCalls = 0x40000000;  // x32
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
constexpr std::uint32_t kForeignCalls = 0x80000000;
#else
constexpr std::uint32_t kArchitecture = 0;  // no filter
constexpr std::uint32_t kForeignCalls = 0;
#endif

// A program for the kernel's filter machine: each rule tests the number of the call, which stays in the accumulator.
class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    unless_equal(kArchitecture, SECCOMP_RET_KILL_PROCESS);
    load(offsetof(seccomp_data, nr));
    add(BPF_JMP | BPF_JGE | BPF_K, kForeignCalls, 0, 1);
    end(SECCOMP_RET_KILL_PROCESS);
    for (const long call : kRefusedCalls) when(call, [this] { end(refusal(EPERM)); });
    when(SYS_openat2, [this] { end(refusal(ENOSYS)); });  // its flags are in memory, which no filter sees
    when(SYS_clone3, [this] { end(refusal(ENOSYS)); });   // the C library falls back on clone
    when(SYS_openat, [this] { refuse_flags(2, kWriting); });
#ifdef SYS_open
    when(SYS_open, [this] { refuse_flags(1, kWriting); });
#endif
    when(SYS_clone, [this] { require_flag(0, CLONE_THREAD); });
    const auto self = static_cast<std::uint32_t>(::getpid());
    for (const long call : {long{SYS_kill}, long{SYS_tgkill}}) when(call, [&] { require_argument(0, self); });
    when(SYS_prlimit64, [this] { require_argument(0, 0); });
    end(SECCOMP_RET_ALLOW);
  }

  [[nodiscard]] bool install() {
    if (kArchitecture == 0) return false;
    sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
    return ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program) == 0;
  }

 private:
  static constexpr std::uint32_t kWriting = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND;

  static std::uint32_t refusal(int error) { return SECCOMP_RET_ERRNO | static_cast<std::uint32_t>(error); }

  void add(int code, std::uint32_t operand, unsigned char if_true = 0, unsigned char if_false = 0) {
    code_.push_back({static_cast<unsigned short>(code), if_true, if_false, operand});
  }
  void load(std::size_t offset) { add(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)); }
  void end(std::uint32_t verdict) { add(BPF_RET | BPF_K, verdict); }
  void unless_equal(std::uint32_t value, std::uint32_t verdict) {
    add(BPF_JMP | BPF_JEQ | BPF_K, value, 1, 0);
    end(verdict);
  }

  // Rules for one call; they must end in a verdict.
  template <class Rules>
  void when(long call, const Rules& rules) {
    const std::size_t jump = code_.size();
    add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 0);
    rules();
    code_[jump].jf = static_cast<unsigned char>(code_.size() - jump - 1);
  }

  // The lower half of an argument, on machines that store it first.
  void load_argument(int index) { load(offsetof(seccomp_data, args) + sizeof(std::uint64_t) * index); }
  void refuse_flags(int argument, std::uint32_t flags) {
    load_argument(argument);
    add(BPF_JMP | BPF_JSET | BPF_K, flags, 0, 1);
    end(refusal(EACCES));
    end(SECCOMP_RET_ALLOW);
  }
  void require_flag(int argument, std::uint32_t flag) {
    load_argument(argument);
    add(BPF_JMP | BPF_JSET | BPF_K, flag, 1, 0);
    end(refusal(EPERM));
    end(SECCOMP_RET_ALLOW);
  }
  void require_argument(int argument, std::uint32_t value) {
    load_argument(argument);
    unless_equal(value, refusal(EPERM));
    end(SECCOMP_RET_ALLOW);
  }

  std::vector<sock_filter> code_;
};

}  // namespace

SandboxState close_sandbox(const std::vector<fs::path>& readable) {
  SandboxState state;
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return state;
  state.files = confine_files(readable);
  state.calls = Filter().install();
  return state;
}

SandboxState sandbox_of_kernel() {
  const std::uint32_t action = SECCOMP_RET_ERRNO;
  return {.files = landlock_version() >= 1,
          .calls = kArchitecture != 0 && ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0};
}

}  // namespace ringdown
