// Who may include whom, checked on every source file of the project. The two tables are the rule;
// docs/how/architecture.md says why.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

// A file below `folder` may include project headers whose path begins with one of `allowed` and with none of `refused`.
// The first row that fits counts.
struct FolderRule {
  std::string folder;
  std::vector<std::string> allowed;
  std::vector<std::string> refused = {};
};

const std::vector<FolderRule> kFolderRules = {
    {"engine/base/", {"engine/base/"}},
    // the real-time half
    {"engine/gltf/", {"engine/base/", "engine/gltf/"}},
    {"engine/modal/", {"engine/base/", "engine/gltf/", "engine/modal/"}},
    {"engine/materials/", {"engine/base/", "engine/modal/", "engine/materials/", "engine/fem/elastic.h"}},
    {"engine/breaking/",
     {"engine/base/", "engine/modal/", "engine/contact/", "engine/synth/events/", "engine/breaking/"}},
    {"engine/contact/", {"engine/base/", "engine/contact/"}},
    {"engine/microtuning/", {"engine/base/", "engine/microtuning/"}},
    {"engine/synth/kernels/",
     {"engine/base/", "engine/modal/air_absorption.h", "engine/modal/direction_map.h", "engine/synth/kernels/"}},
    {"engine/synth/events/", {"engine/base/", "engine/synth/kernels/", "engine/synth/events/"}},
    {"engine/synth/modes/",
     {"engine/base/", "engine/modal/", "engine/synth/kernels/", "engine/synth/events/", "engine/synth/modes/"}},
    {"engine/synth/contact/",
     {"engine/base/", "engine/modal/", "engine/synth/kernels/", "engine/synth/events/", "engine/synth/modes/",
      "engine/synth/contact/"}},
    {"engine/synth/output/",
     {"engine/base/", "engine/modal/", "engine/synth/kernels/", "engine/synth/events/", "engine/synth/modes/",
      "engine/synth/output/"}},
    {"engine/synth/listening/",
     {"engine/base/", "engine/modal/", "engine/synth/kernels/", "engine/synth/events/", "engine/synth/modes/",
      "engine/synth/output/", "engine/synth/listening/"}},
    {"engine/synth/objects/",
     {"engine/base/", "engine/modal/", "engine/synth/kernels/", "engine/synth/events/", "engine/synth/modes/",
      "engine/synth/contact/", "engine/synth/output/", "engine/synth/listening/", "engine/synth/objects/"}},
    {"engine/synth/touching/",
     {"engine/base/", "engine/modal/", "engine/contact/", "engine/synth/kernels/", "engine/synth/events/",
      "engine/synth/modes/", "engine/synth/contact/", "engine/synth/objects/", "engine/synth/touching/"}},
    {"engine/synth/", {"engine/base/", "engine/modal/", "engine/contact/", "engine/synth/"}},
    // the offline half
    {"engine/dense/", {"engine/dense/"}},
    {"engine/mesh/files/gltf_mesh", {"engine/base/", "engine/dense/", "engine/mesh/", "engine/gltf/gltf_file.h"}},
    {"engine/mesh/", {"engine/base/", "engine/dense/", "engine/mesh/"}},
    {"engine/fem/", {"engine/base/", "engine/dense/", "engine/mesh/", "engine/fem/"}},
    {"engine/solve/", {"engine/base/", "engine/dense/", "engine/mesh/", "engine/fem/", "engine/solve/"}},
    {"engine/radiate/", {"engine/base/", "engine/dense/", "engine/modal/", "engine/mesh/", "engine/radiate/"}},
    {"engine/shatter/", {"engine/base/", "engine/mesh/", "engine/shatter/"}},
    {"engine/liquid/", {"engine/base/", "engine/dense/", "engine/mesh/", "engine/radiate/", "engine/liquid/"}},
    {"engine/tube/",
     {"engine/base/", "engine/dense/", "engine/modal/", "engine/mesh/", "engine/radiate/", "engine/tube/"}},
    {"engine/cavity/",
     {"engine/base/", "engine/dense/", "engine/modal/", "engine/mesh/", "engine/radiate/", "engine/tube/",
      "engine/cavity/"}},
    {"engine/bake/",
     {"engine/base/", "engine/dense/", "engine/materials/", "engine/modal/", "engine/mesh/", "engine/fem/",
      "engine/solve/", "engine/radiate/", "engine/shatter/", "engine/liquid/", "engine/tube/", "engine/cavity/",
      "engine/bake/"}},
    {"engine/fit/", {"engine/base/", "engine/dense/", "engine/modal/", "engine/fit/"}},
    // rigid bodies
    {"engine/scene/",
     {"engine/base/", "engine/gltf/", "engine/modal/", "engine/breaking/", "engine/scene/",
      "engine/synth/events/event.h"}},
    // the programs
    {"protocol/wire/", {"engine/base/", "protocol/wire/"}},
    {"protocol/",
     {"engine/base/", "engine/modal/damper.h", "engine/modal/material_scale.h", "engine/modal/mode_range.h",
      "engine/modal/tubes/tube_tuning.h", "engine/synth/events/event.h", "protocol/"}},
    {"packaging/manual/",
     {"engine/base/version.h", "protocol/defaults.h", "protocol/exit_codes.h", "packaging/manual/"}},
    {"server/session/",
     {"engine/base/", "engine/gltf/", "engine/modal/", "engine/microtuning/", "engine/breaking/", "engine/synth/",
      "engine/scene/", "protocol/", "server/session/"},
     {"protocol/wire/codec.h", "protocol/wire/score.h", "protocol/wire/socket.h"}},
    {"server/",
     {"engine/base/", "engine/gltf/", "engine/modal/", "engine/synth/", "engine/scene/", "protocol/",
      "packaging/manual/", "server/"}},
    {"clients/library/",
     {"engine/base/", "engine/modal/", "engine/breaking/", "engine/synth/", "protocol/", "server/session/",
      "clients/library/"},
     {"protocol/wire/codec.h", "protocol/wire/score.h", "protocol/wire/socket.h"}},
    {"clients/python/", {}},  // the C headers of clients/library, as an installed library has them
    {"clients/plugin/window/",
     {"engine/base/", "engine/modal/bank.h", "clients/library/ringdown.h", "clients/plugin/", "clients/viewer/render/",
      "clients/viewer/panels/drop_panel.h", "clients/viewer/panels/font.h", "clients/viewer/panels/skin.h",
      "clients/viewer/material_choice.h"}},
    {"clients/plugin/",
     {"engine/base/", "engine/microtuning/", "clients/library/ringdown.h", "clients/plugin/",
      "server/session/held_keys.h", "server/session/midi_messages.h", "server/session/note_map_file.h",
      "server/session/registered_parameters.h"}},
    {"clients/cli/slepc/", {"engine/base/", "engine/solve/distributed_files.h", "clients/cli/slepc/"}},
    {"clients/cli/fit/",
     {"engine/base/", "engine/modal/", "engine/mesh/files/file_kinds.h", "engine/fit/",
      "engine/synth/modes/mode_table.h", "server/session/offline.h", "protocol/", "packaging/manual/", "clients/cli/"}},
    {"clients/cli/bake/",
     {"engine/base/", "engine/gltf/", "engine/materials/", "engine/modal/", "engine/mesh/", "engine/fem/",
      "engine/bake/", "engine/scene/gltf/silent.h", "protocol/", "packaging/manual/", "clients/cli/"}},
    {"clients/",
     {"engine/base/", "engine/modal/", "engine/synth/", "engine/scene/", "engine/gltf/", "engine/materials/",
      "protocol/", "packaging/manual/", "server/", "clients/"}},
};

// A third-party header whose name begins with `header` may be included by files whose path begins with one of
// `allowed`, and by at most `max_files` of them; by headers of ours only if they are `shown` in one of these folders.
struct LibraryRule {
  std::string header;
  std::vector<std::string> allowed;
  std::size_t max_files = 1000;
  std::vector<std::string> shown = {};
};

const std::vector<LibraryRule> kLibraryRules = {
    {"jack/", {"server/jack_client.cpp"}, 1},
    {"lo/", {"protocol/wire/codec.cpp"}, 1},
    {"ebur128.h", {"server/session/loudness.cpp"}, 1},
    {"microhttpd.h", {"server/query_server.cpp"}, 1},
    {"Distrho", {"clients/plugin/plugin.cpp", "clients/plugin/window/window.cpp"}, 2},
    {"src/clap/", {"clients/plugin/clap_"}, 3, {"clients/plugin/"}},
    {"src/travesty/", {"clients/plugin/vst3_entry.cpp"}, 1},
    {"btBullet", {"clients/bullet/"}, 1},
    {"ode/", {"engine/scene/ode/", "tests/scene/ode_"}, 13},
    {"Spectra/", {"engine/solve/spectra.cpp"}, 1},
    {"Eigen/CholmodSupport", {}, 0},
    {"cholmod.h", {}, 0},
    {"suitesparse/", {}, 0},
    {"gmsh", {"engine/mesh/"}},
    {"CGAL/", {"engine/mesh/"}, 4},
    {"meshoptimizer.h", {"engine/gltf/meshopt_codec.cpp", "engine/mesh/surface/simplify.cpp"}, 2},
    {"Eigen/",
     {"engine/dense/", "engine/mesh/", "engine/fem/", "engine/solve/", "engine/radiate/", "engine/shatter/",
      "engine/liquid/", "engine/tube/", "engine/cavity/", "engine/bake/", "engine/fit/"},
     1000,
     {"engine/dense/", "engine/mesh/", "engine/fem/", "engine/solve/", "engine/radiate/", "engine/shatter/",
      "engine/liquid/", "engine/tube/", "engine/cavity/", "engine/bake/", "engine/fit/"}},
    {"slepc", {"clients/cli/slepc/"}, 1, {"clients/cli/slepc/"}},
    {"petsc", {"clients/cli/slepc/"}, 2, {"clients/cli/slepc/"}},
    {"metis.h", {"engine/solve/"}, 1},
    {"hwy/",
     {"engine/synth/"},
     1000,
     {"engine/synth/kernels/coupled_kernel-inl.h", "engine/synth/kernels/direction_kernel-inl.h",
      "engine/synth/kernels/drive_kernel-inl.h", "engine/synth/kernels/field_sums-inl.h",
      "engine/synth/kernels/glide_kernel-inl.h", "engine/synth/kernels/heard_moments-inl.h",
      "engine/synth/kernels/mix_kernel-inl.h", "engine/synth/kernels/mode_kernel-inl.h",
      "engine/synth/kernels/mode_vectors-inl.h", "engine/synth/kernels/moment_synthesis-inl.h",
      "engine/synth/kernels/moments-inl.h", "engine/synth/kernels/pulse_kernel-inl.h"}},
    {"nlohmann/", {"engine/gltf/glb.h"}, 1, {"engine/gltf/glb.h"}},
    {"tl/", {"engine/base/"}, 1, {"engine/base/"}},
    {"fmt/", {"engine/base/formatted.h"}, 1, {"engine/base/formatted.h"}},
    {"toml++/", {"engine/base/"}, 1},
    {"xxhash.h", {"engine/base/"}, 1},
    {"CLI/", {"packaging/manual/command_line.cpp"}, 1},
    {"sndfile", {"server/session/", "clients/"}},
    {"cairo", {"clients/cli/picture/canvas.cpp"}, 1},
    {"GLFW/", {"clients/viewer/window.cpp"}, 1},
    {"imgui.h", {"clients/viewer/", "clients/plugin/window/"}, 1000, {"clients/viewer/panels/"}},
    {"backends/imgui", {"clients/viewer/window.cpp", "clients/plugin/window/window.cpp"}, 2},
    {"fontconfig/", {"clients/viewer/panels/font.cpp"}, 1},
    {"kiss_fftr.h", {"clients/viewer/spectrum.cpp", "server/session/head.cpp"}, 2},
    {"mysofa.h", {"server/session/head.cpp", "tests/server/head_test.cpp"}, 2},
    {"epoxy/", {"clients/viewer/"}, 2, {"clients/viewer/render/gl.h"}},
    {"glm/", {"clients/viewer/", "clients/plugin/window/"}, 1000, {"clients/viewer/", "clients/plugin/window/"}},
    {"pybind11/", {"clients/python/source/"}, 5, {"clients/python/source/"}},
    {"png.h", {"clients/viewer/render/picture_file.cpp", "engine/scene/gltf/normal_map.cpp"}, 2},
};

// Within these folders a file is a header with its .cpp, and files include each other in one direction only.
const std::vector<std::string> kLayeredFolders = {
    "engine/base/",   "engine/modal/", "engine/mesh/",   "engine/fem/",  "engine/radiate/", "engine/shatter/",
    "engine/liquid/", "engine/tube/",  "engine/cavity/", "engine/bake/", "engine/fit/"};

struct Include {
  std::string file;  // relative to the source folder
  int line = 0;
  std::string header;
  bool quoted = false;
};

bool begins_with_any(const std::string& text, const std::vector<std::string>& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(), [&text](const auto& p) { return text.rfind(p, 0) == 0; });
}

std::vector<Include> includes_of(const fs::path& path, const std::string& relative) {
  std::vector<Include> found;
  std::ifstream file(path);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const auto hash = line.find_first_not_of(" \t");
    if (hash == std::string::npos || line[hash] != '#') continue;
    const auto word = line.find("include", hash);
    const auto open = line.find_first_of("<\"", hash);
    if (word == std::string::npos || open == std::string::npos || word > open) continue;
    const auto close = line.find_first_of(">\"", open + 1);
    if (close == std::string::npos) continue;
    found.push_back({relative, number, line.substr(open + 1, close - open - 1), line[open] == '"'});
  }
  return found;
}

std::vector<Include> all_includes() {
  const fs::path root = RINGDOWN_SOURCE_DIR;
  std::vector<Include> all;
  for (const char* folder : {"engine", "protocol", "packaging", "server", "clients"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cpp") continue;
      const auto found = includes_of(entry.path(), fs::relative(entry.path(), root).generic_string());
      all.insert(all.end(), found.begin(), found.end());
    }
  }
  return all;
}

std::string place(const Include& include) {
  return include.file + ":" + std::to_string(include.line) + " includes " + include.header;
}

bool is_allowed(const Include& include) {
  const auto rule = std::find_if(kFolderRules.begin(), kFolderRules.end(),
                                 [&](const FolderRule& r) { return include.file.rfind(r.folder, 0) == 0; });
  return rule != kFolderRules.end() && begins_with_any(include.header, rule->allowed) &&
         !begins_with_any(include.header, rule->refused);
}

bool is_of_project(const Include& include) {
  return begins_with_any(include.header, {"engine/", "protocol/", "packaging/", "server/", "clients/", "tests/"});
}

TEST(Structure, EveryFolderIncludesOnlyWhatItMay) {
  const auto all = all_includes();
  ASSERT_GT(all.size(), 100u);
  for (const Include& include : all) {
    if (!is_of_project(include)) continue;
    EXPECT_TRUE(is_allowed(include)) << place(include) << ", which its folder may not";
  }
}

// A path without its ending: what a header and its .cpp have in common.
std::string unit_of(const std::string& file) { return file.substr(0, file.rfind('.')); }

using Graph = std::map<std::string, std::set<std::string>>;  // unit -> the units of its folder that it includes

Graph units_of(const std::vector<Include>& includes, const std::string& folder) {
  Graph graph;
  for (const Include& include : includes) {
    if (include.file.rfind(folder, 0) != 0 || include.header.rfind(folder, 0) != 0) continue;
    if (unit_of(include.file) != unit_of(include.header)) graph[unit_of(include.file)].insert(unit_of(include.header));
  }
  return graph;
}

// A unit that includes itself by way of others; empty when there is none. Units that include nothing of the folder are
// removed again and again: what is left stands in a circle, or leads to one.
std::string unit_in_a_circle(Graph graph) {
  for (bool removed = true; removed;) {
    removed = false;
    for (auto unit = graph.begin(); unit != graph.end();) {
      std::erase_if(unit->second, [&graph](const std::string& included) { return !graph.contains(included); });
      removed = removed || unit->second.empty();
      unit = unit->second.empty() ? graph.erase(unit) : std::next(unit);
    }
  }
  return graph.empty() ? "" : graph.begin()->first;
}

TEST(Structure, NoRoomOfTheEngineHasMoreThanFortyFiles) {
  std::map<std::string, int> files;
  const fs::path root = RINGDOWN_SOURCE_DIR;
  for (const auto& entry : fs::recursive_directory_iterator(root / "engine")) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".h" || ending == ".cpp") ++files[fs::relative(entry.path().parent_path(), root).string()];
  }
  EXPECT_GT(files.size(), 20u);
  for (const auto& [room, count] : files) EXPECT_LE(count, 40) << room;
}

TEST(Structure, FilesOfAFolderIncludeEachOtherInOneDirection) {
  const auto all = all_includes();
  for (const std::string& folder : kLayeredFolders) {
    const Graph units = units_of(all, folder);
    EXPECT_FALSE(units.empty()) << folder;
    EXPECT_EQ(unit_in_a_circle(units), "") << "its includes lead back to it";
  }
  EXPECT_EQ(unit_in_a_circle({{"a", {"b"}}, {"b", {"c"}}}), "");
  EXPECT_EQ(unit_in_a_circle({{"a", {"b"}}, {"b", {"c"}}, {"c", {"b"}}}), "a") << "it leads to the circle of b and c";
}

TEST(Structure, ProjectHeadersAreNamedFromTheRoot) {
  for (const Include& include : all_includes()) {
    // The few generated or third-party headers that come quoted are none of the project's own.
    if (!include.quoted || is_of_project(include)) continue;
    const fs::path beside = fs::path(RINGDOWN_SOURCE_DIR) / fs::path(include.file).parent_path() / include.header;
    EXPECT_FALSE(fs::exists(beside)) << place(include) << "; write its path from the root of the project";
  }
}

TEST(Structure, ThirdPartyHeadersStayWhereTheyBelong) {
  std::map<std::string, std::set<std::string>> users;
  for (const Include& include : all_includes()) {
    for (const LibraryRule& rule : kLibraryRules) {
      if (include.quoted || include.header.rfind(rule.header, 0) != 0) continue;
      EXPECT_TRUE(begins_with_any(include.file, rule.allowed)) << place(include) << ", which its folder may not";
      EXPECT_TRUE(include.file.ends_with(".cpp") || begins_with_any(include.file, rule.shown))
          << place(include) << ", which belongs into a .cpp";
      users[rule.header].insert(include.file);
    }
  }
  for (const LibraryRule& rule : kLibraryRules) {
    EXPECT_LE(users[rule.header].size(), rule.max_files)
        << "<" << rule.header << "> is private to " << rule.max_files << " file(s), but is included by "
        << testing::PrintToString(users[rule.header]);
  }
}

// The session layer is a library for other programs: it opens no socket, starts no log, reads
// no command line and owns nothing global.
TEST(Structure, ASessionNeedsNeitherSocketsNorLogsNorCommandLinesNorGlobals) {
  for (const Include& include : all_includes()) {
    if (include.file.rfind("server/session/", 0) != 0) continue;
    EXPECT_FALSE(begins_with_any(include.header, {"sys/socket.h", "sys/un.h", "netinet/", "arpa/", "netdb.h", "lo/",
                                                  "jack/", "CLI/", "microhttpd.h", "avahi", "csignal", "iostream"}))
        << place(include) << ", which its folder may not";
  }
  const std::regex mutable_static(
      R"(^\s*(static|inline|thread_local)\s+(?!const|inline|thread_local)[^(]*(=|\{).*;\s*$)");
  const std::regex mutable_global(
      R"re(^(?!using|const|constexpr|inline const|namespace|return|static_assert|template))re"
      R"([A-Za-z][\w:<>,* ]*\s[a-z]\w*( = .*|\{.*\})?;$)");
  const fs::path root = RINGDOWN_SOURCE_DIR;
  for (const auto& entry : fs::recursive_directory_iterator(root / "server/session")) {
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      EXPECT_FALSE(std::regex_search(line, mutable_static) || std::regex_search(line, mutable_global))
          << entry.path() << " has a variable that outlives every session: " << line;
    }
  }
}

// The rules can fail: what they forbid is found.
TEST(Structure, TheIncludeRulesRefuseWhatTheyShould) {
  EXPECT_FALSE(is_allowed({"engine/synth/mixer.cpp", 1, "engine/mesh/boundary.h", true}));
  EXPECT_FALSE(is_allowed({"engine/base/vec3.h", 1, "engine/modal/bank.h", true}));
  EXPECT_FALSE(is_allowed({"engine/synth/modes/voice.h", 1, "protocol/schema.h", true}));
  EXPECT_FALSE(is_allowed({"engine/scene/world.h", 1, "protocol/wire/message.h", true}));
  EXPECT_FALSE(is_allowed({"protocol/wire/codec.h", 1, "protocol/schema.h", true}));
  EXPECT_FALSE(is_allowed({"server/session/recorder.cpp", 1, "protocol/wire/socket.h", true}));
  EXPECT_FALSE(is_allowed({"server/session/rack.h", 1, "server/driver.h", true}));
  EXPECT_FALSE(is_allowed({"server/session/session.cpp", 1, "packaging/manual/command_line.h", true}));
  EXPECT_FALSE(is_allowed({"server/main.cpp", 1, "engine/bake/bake.h", true}));
  EXPECT_FALSE(is_allowed({"engine/modal/bank.h", 1, "tests/support/signal.h", true}));
  EXPECT_FALSE(is_allowed({"clients/cli/main.cpp", 1, "engine/bake/bake.h", true}));
  EXPECT_FALSE(is_allowed({"clients/python/source/core.cpp", 1, "engine/modal/bank.h", true}));
  EXPECT_TRUE(is_allowed({"protocol/request.h", 1, "engine/synth/events/event.h", true}));
}

}  // namespace
