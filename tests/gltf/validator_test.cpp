// Banks before the public glTF validator: those of the presets and a fresh one have no fault, broken ones do.
// Compressed ones are unpacked by npm's meshoptimizer first, and our reader must read from them what it reads from the
// unpacked ones.
#include "tests/integration/process.h"
#include "tests/modal/glb_editor.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <limits>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;
using modal::test::GlbParts;

const fs::path kSource = RINGDOWN_SOURCE_DIR;
const std::string kFetch = kSource / "tests/gltf/fetch_packages.sh";
constexpr int kCannotBeFetched = 77;

Outcome validate(const std::vector<std::string>& files) {
  std::vector<std::string> command = {"node", kSource / "tests/gltf/validate.js",
                                      RINGDOWN_NPM_FOLDER "/gltf-validator"};
  command.insert(command.end(), files.begin(), files.end());
  return run(command);
}

Outcome bake_bar(const fs::path& bank, std::vector<std::string> options = {}) {
  std::vector<std::string> command = {RINGDOWN_BIN_DIR "/ringdown-bake",
                                      kSource / "presets/objects/wooden-bar.toml",
                                      "--element",
                                      "tet4",
                                      "--mesh-size",
                                      "0.03",
                                      "--no-cache",
                                      "-o",
                                      bank};
  command.insert(command.end(), options.begin(), options.end());
  return run(command);
}

// Unpacks `files` into `folder` and expects the same banks there; returns the new files.
std::vector<std::string> unpack(const std::vector<std::string>& files, const fs::path& folder) {
  fs::create_directories(folder);
  std::vector<std::string> command = {"node", kSource / "tests/gltf/unpack.js", RINGDOWN_NPM_FOLDER "/meshoptimizer",
                                      folder};
  command.insert(command.end(), files.begin(), files.end());
  const Outcome outcome = run(command);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  std::vector<std::string> unpacked;
  for (const fs::path file : files) {
    unpacked.push_back(folder / file.filename());
    const auto packed = modal::read_bank(file), plain = modal::read_bank(unpacked.back());
    EXPECT_TRUE(packed && plain) << file;
    if (!packed || !plain) continue;
    EXPECT_EQ(packed->frequency_hz, plain->frequency_hz) << file;
    EXPECT_EQ(packed->decay_per_s, plain->decay_per_s) << file;
    EXPECT_TRUE(packed->positions == plain->positions) << file;
    EXPECT_TRUE(packed->shapes == plain->shapes) << file;
    EXPECT_TRUE(packed->triangles == plain->triangles) << file;
  }
  return unpacked;
}

class GltfValidator : public testing::Test {
 protected:
  void SetUp() override {
    if (!installed("node")) GTEST_SKIP() << "nodejs is not installed, which runs the glTF validator";
    const Outcome fetched = run({kFetch, RINGDOWN_NPM_FOLDER}, {}, std::chrono::seconds(120));
    if (fetched.exit_code == kCannotBeFetched) GTEST_SKIP() << fetched.output;
    ASSERT_EQ(fetched.exit_code, 0) << fetched.output;
  }
  TemporaryFolder folder_;
};

TEST_F(GltfValidator, TheValidatorFindsNoFaultInThePresetsBanks) {
  std::vector<std::string> banks;
  for (const auto& file : fs::recursive_directory_iterator(kSource / "presets/banks")) {
    if (file.path().extension() == ".glb") banks.push_back(file.path());
  }
  ASSERT_GE(banks.size(), 12u);
  const Outcome checked = validate(unpack(banks, folder_ / "unpacked"));
  std::printf("%s", checked.output.c_str());
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  std::size_t clean = 0;
  for (std::size_t at = 0; (at = checked.output.find(": 0 errors, 0 warnings", at)) != std::string::npos; ++at) ++clean;
  EXPECT_EQ(clean, banks.size());
}

TEST_F(GltfValidator, TheValidatorFindsNoFaultInAFreshBake) {
  const Outcome baked = bake_bar(folder_ / "bar.glb");
  ASSERT_EQ(baked.exit_code, 0) << baked.output;
  const Outcome checked = validate({folder_ / "bar.glb"});
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  EXPECT_NE(checked.output.find("0 errors, 0 warnings (1 UNSUPPORTED_EXTENSION"), std::string::npos) << checked.output;
}

TEST_F(GltfValidator, TheValidatorFindsNoFaultInACompressedBakeOnceItIsUnpacked) {
  const fs::path bank = folder_ / "bar.glb", plain = folder_ / "plain.glb";
  const Outcome baked = bake_bar(bank, {"--compress"});
  ASSERT_EQ(baked.exit_code, 0) << baked.output;
  EXPECT_NE(modal::test::file_content(bank).find("EXT_meshopt_compression"), std::string::npos);
  ASSERT_EQ(bake_bar(plain).exit_code, 0);
  EXPECT_LT(fs::file_size(bank), fs::file_size(plain));
  const Outcome checked = validate(unpack({bank}, folder_ / "unpacked"));
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
}

TEST_F(GltfValidator, TheValidatorFindsWhatIsBroken) {
  const std::string whole = modal::test::written(modal::read_bank(kSource / "presets/banks/coin.glb").value());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::pair<const char*, std::function<std::string(GlbParts)>> cases[] = {
      {"ACCESSOR_INVALID_FLOAT", [nan](GlbParts bank) { return bank.set("positions", 4, nan), bank.join(); }},
      {"ACCESSOR_INDEX_OOB", [](GlbParts bank) { return bank.set("indices", 7, 0x00ffffff), bank.join(); }},
      {"ACCESSOR_MAX_MISMATCH", [](GlbParts bank) { return bank.accessor("positions")["max"][1] = 9, bank.join(); }},
      {"ACCESSOR_TOO_LONG", [](GlbParts bank) { return bank.accessor("shapes")["count"] = 9999999, bank.join(); }},
      {"UNRESOLVED_REFERENCE", [](GlbParts bank) { return bank.json["nodes"][0]["mesh"] = 5, bank.join(); }},
      {"UNDECLARED_EXTENSION", [](GlbParts bank) { return bank.json.erase("extensionsUsed"), bank.join(); }},
      {"INVALID_JSON", [](GlbParts bank) { return bank.join().replace(20, 1, "?"); }},
      {"GLB_EXTRA_DATA", [](GlbParts bank) { return bank.join() + "more"; }},
  };
  for (const auto& [code, broken] : cases) {
    const fs::path bank = folder_.write("broken.glb", broken(GlbParts(whole)));
    const Outcome checked = validate({bank});
    EXPECT_EQ(checked.exit_code, 1) << code;
    EXPECT_NE(checked.output.find(code), std::string::npos) << checked.output;
  }
  EXPECT_EQ(validate({folder_.write("whole.glb", GlbParts(whole).join())}).exit_code, 0) << "taken apart and joined";
}

// A registry of one file, on a port of its own, for a machine without npm.
struct Registry {
  Registry(const TemporaryFolder& folder, const std::string& content)
      : server({"node", "-e",
                "const s = require('http').createServer((q, a) => a.end(require('fs').readFileSync(process.argv[1])));"
                "s.listen(0, '127.0.0.1', () => console.log(`port ${s.address().port}.`));",
                folder.write("sent", content)}) {
    const std::string tools = folder / "tools";
    run({"bash", "-c",
         "mkdir -p " + tools + "; for tool in bash env node mkdir mktemp sha512sum tar gzip touch mv rm tail; do " +
             "ln -sf \"$(command -v $tool)\" " + tools + "/; done"});
    EXPECT_TRUE(server.wait_for_output(".", std::chrono::seconds(60)));
    const std::string output = server.output();
    address = "http://127.0.0.1:" + output.substr(5, output.find('.') - 5);
    environment = {{"PATH", tools}, {"npm_config_registry", address}};
  }
  Process server;
  std::string address;
  Process::Environment environment;
};

TEST(GltfValidatorFetch, TheFetchThrowsAwayWhatIsNotThePinnedFile) {
  if (!installed("node")) GTEST_SKIP() << "nodejs is not installed, which runs the glTF validator";
  const TemporaryFolder folder;
  const Registry registry(folder, "something else");
  const Outcome fetched = run({kFetch, folder / "here"}, registry.environment);
  EXPECT_EQ(fetched.exit_code, 1) << fetched.output;
  EXPECT_NE(fetched.output.find("is not the file that was pinned"), std::string::npos) << fetched.output;
  EXPECT_TRUE(fs::is_empty(folder / "here"));
}

TEST(GltfValidatorFetch, TheFetchSaysWhenThereIsNoNetwork) {
  if (!installed("node")) GTEST_SKIP() << "nodejs is not installed, which runs the glTF validator";
  const TemporaryFolder folder;
  Process::Environment environment;
  {
    const Registry registry(folder, "");
    environment = registry.environment;
  }  // nothing listens at its port any more
  const Outcome fetched = run({kFetch, folder / "here"}, environment);
  EXPECT_EQ(fetched.exit_code, kCannotBeFetched) << fetched.output;
  EXPECT_NE(fetched.output.find("cannot be fetched from the npm registry"), std::string::npos) << fetched.output;
  EXPECT_TRUE(fs::is_empty(folder / "here"));
}

}  // namespace
}  // namespace ringdown::test
