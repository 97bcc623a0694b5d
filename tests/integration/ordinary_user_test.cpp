// The main flows as an ordinary user has them: no capability, no real-time priority, no locked memory, and nothing to
// write to but a folder of the user's own. As root, the programs run as `nobody`.
#include "tests/integration/daemon_fixture.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <pwd.h>
#include <unistd.h>

#include <filesystem>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class OrdinaryUser : public testing::Test {
 protected:
  void SetUp() override {
    if (::geteuid() == 0) {
      const passwd* nobody = ::getpwnam("nobody");
      if (!nobody || !installed("setpriv")) GTEST_SKIP() << "there is no user `nobody`, or no setpriv";
      ASSERT_EQ(::chown(home_.path().c_str(), nobody->pw_uid, nobody->pw_gid), 0);
    }
    if (shell("test -x '" + program("ringdown") + "'").exit_code != 0) {
      GTEST_SKIP() << "an ordinary user cannot reach " << program("ringdown");
    }
  }

  // Runs a line of bash in the folder.
  [[nodiscard]] Outcome shell(const std::string& line) const {
    std::vector<std::string> words = {"prlimit", "--rtprio=0", "--memlock=65536", "--nice=0"};
    if (::geteuid() == 0) {
      words.insert(words.end(), {"setpriv", "--reuid=nobody", "--regid=nogroup", "--clear-groups",
                                 "--bounding-set=-all", "--inh-caps=-all", "--no-new-privs"});
    }
    words.insert(
        words.end(),
        {"env", "-C", home_.path(), "HOME=" + home_.path().string(), "XDG_RUNTIME_DIR=" + home_.path().string(),
         "XDG_CONFIG_HOME=" + (home_ / "config").string(), "XDG_CACHE_HOME=" + (home_ / "cache").string(),
         "TMPDIR=" + home_.path().string(), "RINGDOWN_CACHE=" + (home_ / "cache").string(),
         "PATH=" RINGDOWN_BIN_DIR ":/usr/bin:/bin", "bash", "-c", line});
    return run(words, {}, 3min);
  }

  void expect_made(const std::string& line, const std::string& file) const {
    const Outcome ran = shell(line);
    EXPECT_EQ(ran.exit_code, 0) << line << ":\n" << ran.output;
    std::error_code error;
    EXPECT_GT(fs::file_size(home_ / file, error), 100u) << line << ":\n" << ran.output;
    EXPECT_FALSE(error) << file << " is missing";
  }

  TemporaryFolder home_;
};

TEST_F(OrdinaryUser, RendersAScene) { expect_made("ringdown render --scene demo --seconds 1 -o a.wav", "a.wav"); }

TEST_F(OrdinaryUser, BakesAnObject) {
  if (!fs::exists(program("ringdown-bake"))) GTEST_SKIP() << "ringdown-bake is not built";
  const fs::path box = home_.write("box.geo", "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 0.1, 0.04, 0.02};\n");
  expect_made("ringdown bake " + box.string() + " -m steel -e tet4 --mesh-size 0.02 -o box.glb", "box.glb");
}

TEST_F(OrdinaryUser, PlaysWithoutASoundCard) {
  expect_made("ringdownd --driver null --port 0 --scene demo --seconds 2 --record a.osc", "a.osc");
}

// A server of the user's own; jackd keeps names of servers, so that the name is always this one.
TEST_F(OrdinaryUser, PlaysWithJack) {
  if (!installed("jackd")) GTEST_SKIP() << "jackd is not installed";
  expect_made(
      "export JACK_DEFAULT_SERVER=ringdown-user JACK_NO_START_SERVER=1 JACK_NO_AUDIO_RESERVATION=1\n"
      "jackd -r --name ringdown-user --port-max 128 -d dummy -r 48000 -p 1024 >jackd.log 2>&1 & server=$!\n"
      "jack_wait --server ringdown-user --wait --timeout 20 >/dev/null\n"
      "ringdownd --port 0 --scene demo --seconds 2 --record a.osc; code=$?\n"
      "kill $server; wait $server; exit $code",
      "a.osc");
}

TEST_F(OrdinaryUser, TakesAPicture) {
  if (!fs::exists(program("ringdown-viewer")) || !installed("xvfb-run")) GTEST_SKIP() << "no viewer, or no display";
  expect_made("xvfb-run -a ringdown-viewer --scene " RINGDOWN_SOURCE_DIR
              "/presets/scenes/demo.toml --at 0.1 --size 320 240 --screenshot a.png",
              "a.png");
}

}  // namespace
}  // namespace ringdown::test
