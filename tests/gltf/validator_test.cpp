// Banks before the public glTF validator: those of the presets and a fresh one have no fault, broken ones do.
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
const std::string kFetch = kSource / "tests/gltf/fetch_validator.sh";
constexpr int kCannotBeFetched = 77;

Outcome validate(const std::vector<std::string>& files) {
  std::vector<std::string> command = {"node", kSource / "tests/gltf/validate.js",
                                      RINGDOWN_VALIDATOR_FOLDER "/gltf-validator"};
  command.insert(command.end(), files.begin(), files.end());
  return run(command);
}

Outcome bake_bar(const fs::path& bank) {
  return run({RINGDOWN_BIN_DIR "/ringdown-bake", kSource / "presets/objects/wooden-bar.toml", "--element", "tet4",
              "--mesh-size", "0.03", "--no-cache", "-o", bank});
}

class GltfValidator : public testing::Test {
 protected:
  void SetUp() override {
    if (!installed("node")) GTEST_SKIP() << "nodejs is not installed, which runs the glTF validator";
    const Outcome fetched = run({kFetch, RINGDOWN_VALIDATOR_FOLDER}, {}, std::chrono::seconds(120));
    if (fetched.exit_code == kCannotBeFetched) GTEST_SKIP() << fetched.output;
    ASSERT_EQ(fetched.exit_code, 0) << fetched.output;
  }
  TemporaryFolder folder_;
};

TEST_F(GltfValidator, TheValidatorFindsNoFaultInThePresetsBanks) {
  std::vector<std::string> banks;
  for (const auto& file : fs::directory_iterator(kSource / "presets/banks")) {
    if (file.path().extension() == ".glb") banks.push_back(file.path());
  }
  ASSERT_GE(banks.size(), 12u);
  const Outcome checked = validate(banks);
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

TEST_F(GltfValidator, TheValidatorFindsWhatIsBroken) {
  const std::string whole = modal::test::file_content(kSource / "presets/banks/coin.glb");
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
