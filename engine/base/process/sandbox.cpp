#include "engine/base/process/sandbox.h"

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

// The filter lists the refused calls rather than the allowed ones, because the calls that the C and C++ libraries need
// differ between their versions, while a new harmful call needs a new kernel.
constexpr std::array kRefusedCalls = {
    // programs and processes
    SYS_execve,
    SYS_execveat,
    SYS_ptrace,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_pidfd_open,
    SYS_pidfd_send_signal,
    SYS_pidfd_getfd,
    SYS_rt_sigqueueinfo,
    SYS_rt_tgsigqueueinfo,
    SYS_tkill,
    SYS_setns,
    SYS_unshare,
    SYS_setpgid,
    SYS_setsid,
    // other ways to the network and to other processes
    SYS_socket,
    SYS_socketpair,
    SYS_connect,
    SYS_bind,
    SYS_listen,
    SYS_sendto,
    SYS_sendmsg,
    SYS_sendmmsg,
    SYS_shmget,
    SYS_shmat,
    SYS_msgget,
    SYS_semget,
    SYS_mq_open,
    SYS_mq_unlink,
    // files changed by name
    SYS_truncate,
    SYS_unlinkat,
    SYS_renameat2,
    SYS_linkat,
    SYS_symlinkat,
    SYS_mkdirat,
    SYS_mknodat,
    SYS_fchmod,
    SYS_fchmodat,
    SYS_fchown,
    SYS_fchownat,
    SYS_utimensat,
    SYS_setxattr,
    SYS_lsetxattr,
    SYS_fsetxattr,
    SYS_removexattr,
    SYS_lremovexattr,
    SYS_fremovexattr,
    SYS_open_by_handle_at,
    SYS_name_to_handle_at,
    SYS_fanotify_init,
    // the machine
    SYS_mount,
    SYS_umount2,
    SYS_pivot_root,
    SYS_chroot,
    SYS_move_mount,
    SYS_open_tree,
    SYS_fsopen,
    SYS_fsmount,
    SYS_swapon,
    SYS_swapoff,
    SYS_reboot,
    SYS_sethostname,
    SYS_setdomainname,
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
    SYS_settimeofday,
    SYS_clock_settime,
    SYS_clock_adjtime,
    SYS_adjtimex,
    SYS_acct,
    SYS_quotactl,
    SYS_bpf,
    SYS_perf_event_open,
    SYS_userfaultfd,
    SYS_io_uring_setup,
    SYS_add_key,
    SYS_request_key,
    SYS_keyctl,
    SYS_personality,
// Older variants of refused calls.
#ifdef SYS_fork
    SYS_fork,
    SYS_vfork,
    SYS_creat,
    SYS_unlink,
    SYS_rename,
    SYS_link,
    SYS_symlink,
    SYS_mkdir,
    SYS_rmdir,
    SYS_mknod,
    SYS_chmod,
    SYS_chown,
    SYS_lchown,
    SYS_utime,
    SYS_utimes,
    SYS_futimesat,
#endif
#ifdef SYS_renameat
    SYS_renameat,
#endif
};

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

// Builds a program for the kernel's filter machine. Each rule tests the number of the call, which stays in the
// accumulator.
class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    unless_equal(kArchitecture, SECCOMP_RET_KILL_PROCESS);
    load(offsetof(seccomp_data, nr));
    add(BPF_JMP | BPF_JGE | BPF_K, kForeignCalls, 0, 1);
    end(SECCOMP_RET_KILL_PROCESS);
    for (const long call : kRefusedCalls) when(call, [this] { end(refusal(EPERM)); });
    when(SYS_openat2, [this] { end(refusal(ENOSYS)); });  // its flags are in memory, which filters cannot read
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

  // Loads the lower half of an argument, on machines that store the lower half first.
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
