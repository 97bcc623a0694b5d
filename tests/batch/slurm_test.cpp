// clients/batch/ringdown-array.sbatch, by a Slurm of the test's own: munged, slurmctld and slurmd on ports and in
// folders that nobody else uses.
#include "tests/batch/box_folder.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <netinet/in.h>
#include <optional>
#include <sys/socket.h>
#include <unistd.h>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Words = std::vector<std::string>;

const std::string kScript = RINGDOWN_SOURCE_DIR "/clients/batch/ringdown-array.sbatch";
constexpr const char* kNode = "ringdown-node";

// Two ports that are free now, bound together so that they differ.
std::array<int, 2> free_ports() {
  std::array<int, 2> sockets{}, ports{};
  for (int i = 0; i < 2; ++i) {
    sockaddr_in address{.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
    socklen_t size = sizeof address;
    sockets[i] = ::socket(AF_INET, SOCK_STREAM, 0);
    ::bind(sockets[i], reinterpret_cast<sockaddr*>(&address), size);
    ::getsockname(sockets[i], reinterpret_cast<sockaddr*>(&address), &size);
    ports[i] = ntohs(address.sin_port);
  }
  for (const int socket : sockets) ::close(socket);
  return ports;
}

std::string host_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  const std::string whole = name.data();
  return whole.substr(0, whole.find('.'));
}

class Slurm {
 public:
  explicit Slurm(const BoxFolder& boxes) : boxes_(boxes), folder_(boxes.banks().parent_path() / "slurm") {
    for (const char* part : {"munge", "state", "spool"}) fs::create_directories(folder_ / part);
    boxes.write("slurm/munge/key", std::string(1024, 'k'));  // of a test, for this machine alone
    fs::permissions(folder_ / "munge/key", fs::perms::owner_read | fs::perms::owner_write);
    for (fs::path part = folder_ / "munge"; part != boxes.banks().parent_path().parent_path();
         part = part.parent_path()) {
      fs::permissions(part, fs::perms(0755));  // munged wants its socket to be reached by all
    }
    write_settings();
    // Nothing here uses control groups. This plugin starts where none are mounted; Slurm's own choice does not.
    boxes.write("slurm/cgroup.conf", "CgroupPlugin=cgroup/v1\n");
    environment_ = {{"SLURM_CONF", folder_ / "slurm.conf"},
                    {"PATH", RINGDOWN_BIN_DIR ":" + std::string(std::getenv("PATH")) + ":/usr/sbin:/sbin"},
                    {"RINGDOWN_CACHE", "/dev/null/none"},
                    {"RINGDOWN_PRESETS", boxes.banks().parent_path() / "presets"}};
    munged_.emplace(Words{"/usr/sbin/munged", "--foreground", "--key-file=" + in("munge/key"),
                          "--socket=" + in("munge/socket"), "--pid-file=" + in("munge/pid"),
                          "--log-file=" + in("munge/log"), "--seed-file=" + in("munge/seed"), "--num-threads=10"});
    comes_true([this] { return fs::exists(folder_ / "munge/socket") || munged_->wait(0ms); });
    controller_.emplace(Words{"/usr/sbin/slurmctld", "-D", "-c"}, environment_);
    node_.emplace(Words{"/usr/sbin/slurmd", "-D", "-N", kNode}, environment_);
  }
  ~Slurm() { (void)call({"scancel", "--user=" + std::to_string(::getuid())}); }

  [[nodiscard]] Outcome call(const Words& command) const { return run(command, environment_); }
  // Waits until the node takes jobs; false when a daemon has ended, or after minutes.
  [[nodiscard]] bool is_ready() {
    return comes_true([this] { return ended() || call({"sinfo", "-h", "-o", "%T"}).output == "idle\n"; }) && !ended();
  }
  bool submit(const std::string& array) {
    const Outcome sent =
        call({"sbatch", "--array=" + array, "--output=" + in("job-%a.log"), kScript, boxes_.objects(), boxes_.banks()});
    return sent.exit_code == 0 && comes_true([this] {
             return ended() || call({"squeue", "-h"}).output.empty();
           }) &&
           !ended();
  }
  [[nodiscard]] std::string log_of(int task) const {
    std::ifstream file(in("job-" + std::to_string(task) + ".log"));
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::string said() const { return munged_->output() + controller_->output() + node_->output(); }

 private:
  [[nodiscard]] std::string in(const std::string& name) const { return folder_ / name; }
  bool ended() { return munged_->wait(0ms) || controller_->wait(0ms) || node_->wait(0ms); }
  void write_settings() const {
    const auto [controller_port, node_port] = free_ports();
    const std::string user = ::getuid() == 0 ? "root" : std::getenv("USER");
    boxes_.write(
        "slurm/slurm.conf",
        "ClusterName=ringdown\nSlurmctldHost=" + host_name() + "(127.0.0.1)\nSlurmctldPort=" +
            std::to_string(controller_port) + "\nSlurmdPort=" + std::to_string(node_port) + "\nSlurmUser=" + user +
            "\nSlurmdUser=" + user + "\nAuthType=auth/munge\nAuthInfo=socket=" + in("munge/socket") +
            "\nCryptoType=crypto/munge\nStateSaveLocation=" + in("state") + "\nSlurmdSpoolDir=" + in("spool") +
            "\nSlurmctldPidFile=" + in("controller.pid") + "\nSlurmdPidFile=" + in("node.pid") +
            "\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nJobAcctGatherType=jobacct_gather/none\n"
            "SwitchType=switch/none\nMpiDefault=none\nReturnToService=2\nSelectType=select/cons_tres\n"
            "SelectTypeParameters=CR_CPU\nSchedulerParameters=sched_interval=1\nMailProg=/bin/true\n"
            "NodeName=" +
            kNode + " NodeHostname=" + host_name() +
            " NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN\n"
            "PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n");
  }

  const BoxFolder& boxes_;
  const fs::path folder_;
  Process::Environment environment_;
  std::optional<Process> munged_, controller_, node_;
};

TEST(Slurm, AnArrayBakesAFolderAndASecondOneOnlyWhatIsMissing) {
  for (const char* program : {"/usr/sbin/munged", "/usr/sbin/slurmctld", "/usr/sbin/slurmd", "/usr/bin/sbatch"}) {
    if (!fs::exists(program)) GTEST_SKIP() << program << " is not installed: a Slurm to try needs package slurm-wlm";
  }
  const BoxFolder boxes;
  for (int n = 0; n < 4; ++n) boxes.box("b" + std::to_string(n), 80 + 10 * n);
  boxes.write("objects/b2.toml", "material = \"stuff\"\ngeometry = \"none.geo\"\n");
  fs::create_directories(boxes.banks().parent_path() / "presets");
  fs::copy(boxes.materials(), boxes.banks().parent_path() / "presets/materials", fs::copy_options::recursive);
  Slurm slurm(boxes);
  ASSERT_TRUE(slurm.is_ready()) << slurm.said();

  ASSERT_TRUE(slurm.submit("0-4")) << slurm.said();
  EXPECT_EQ(boxes.whole_banks(), (Words{"b0.glb", "b1.glb", "b3.glb"})) << slurm.log_of(0) << slurm.said();
  EXPECT_EQ(boxes.files_in_banks(), boxes.whole_banks());
  EXPECT_NE(slurm.log_of(0).find("b0: "), std::string::npos) << slurm.log_of(0);
  EXPECT_NE(slurm.log_of(2).find("none.geo"), std::string::npos) << slurm.log_of(2);
  EXPECT_NE(slurm.log_of(4).find("there is no object 4 in "), std::string::npos) << slurm.log_of(4);

  fs::remove(boxes.bank("b1"));
  boxes.box("b2", 105);
  const auto written = fs::last_write_time(boxes.bank("b0"));
  for (int n = 0; n < 4; ++n) fs::remove(boxes.banks().parent_path() / ("slurm/job-" + std::to_string(n) + ".log"));
  ASSERT_TRUE(slurm.submit("0-3"));
  EXPECT_EQ(boxes.whole_banks(), (Words{"b0.glb", "b1.glb", "b2.glb", "b3.glb"}));
  EXPECT_EQ(fs::last_write_time(boxes.bank("b0")), written);
  EXPECT_EQ(slurm.log_of(0), "b0: unchanged\n");
  EXPECT_NE(slurm.log_of(1).find(" modes, "), std::string::npos) << slurm.log_of(1);
}

}  // namespace
}  // namespace ringdown::test
