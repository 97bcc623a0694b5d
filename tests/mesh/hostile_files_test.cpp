// Files that are made to break their reader, run programs or read what is not theirs, through ringdown-check as its
// user meets it: one sentence with the file's name and an exit code of its kind, and nothing else happens.
#include "engine/base/process/child_process.h"
#include "engine/base/process/sandbox.h"
#include "tests/mesh/sample_surfaces.h"
#include "tests/mesh/surface_files.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <utility>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace ringdown {
namespace {

using test::TemporaryFolder;

const std::string kBox = "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 0.1, 0.1, 0.1};\n";
constexpr int kFailure = 1, kBadInput = 3;  // protocol/exit_codes.h

struct Checked {
  int exit_code = 0;
  std::string error;  // what it printed to stderr
};

Checked check(const std::filesystem::path& file, std::map<std::string, std::string> environment = {}) {
  const auto done = run_child({.command = {RINGDOWN_BIN_DIR "/ringdown-check", "mesh", file.string()},
                               .environment = std::move(environment),
                               .limit_s = 60});
  if (!done) return {-1, done.error().message};
  return {done->out_of_time ? -1 : done->exit_code, done->errors};
}

// One line that names the file and has each of the words.
void expect_refused(const std::filesystem::path& file, const Checked& checked, int exit_code,
                    const std::vector<std::string>& words) {
  EXPECT_EQ(checked.exit_code, exit_code) << checked.error;
  EXPECT_EQ(std::count(checked.error.begin(), checked.error.end(), '\n'), 1) << checked.error;
  EXPECT_NE(checked.error.find(file.filename().string()), std::string::npos) << checked.error;
  for (const std::string& word : words) EXPECT_NE(checked.error.find(word), std::string::npos) << checked.error;
}

std::string ply(const std::string& format, const std::string& body) {
  return "ply\nformat " + format +
         " 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
         "property list uchar int vertex_indices\nend_header\n" +
         body;
}

const std::string kTextBody = "0 0 0\n0.1 0 0\n0 0.1 0\n0 0 0.1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

TEST(HostileFiles, SurfacesThatBreakTheirReaderAreRefused) {
  const TemporaryFolder folder;
  const std::pair<const char*, std::string> files[] = {
      {"little.ply", ply("binary_little_endian", kTextBody)},
      {"big.ply", ply("binary_big_endian", kTextBody)},
      {"indices.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999\nf -99 1 2\n"},
      {"nodes.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n99999999999\n1 0 0 0\n"},
  };
  for (const auto& [name, content] : files) {
    const auto path = folder.write(name, content);
    expect_refused(path, check(path), kBadInput, {});
  }
}

// Triangles whose areas are below the smallest double are still triangles.
TEST(HostileFiles, ASurfaceOfNoSizeBreaksNothingAndIsQuestioned) {
  const TemporaryFolder folder;
  const auto path =
      folder.write("tiny.obj", "v 0 0 0\nv 1e-31 0 0\nv 0 1e-31 0\nv 0 0 1e-31\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  bool questioned = false;
  const auto done = run_child({.command = {RINGDOWN_BIN_DIR "/ringdown-check", "mesh", path.string()},
                               .limit_s = 60,
                               .on_line = [&](std::string_view line) {
                                 questioned = questioned || line.find("is this size right?") != line.npos;
                               }});
  ASSERT_TRUE(done);
  EXPECT_EQ(done->exit_code, 0) << done->errors;
  EXPECT_TRUE(questioned);
}

TEST(HostileFiles, GeometriesThatNeverEndAreEnded) {
  const TemporaryFolder folder;
  const std::pair<const char*, std::string> files[] = {
      {"for.geo", kBox + "For i In {1:1e18}\n  a = i;\nEndFor\n"},
      {"count.geo", kBox + "For (1:1000000000)\n  a = 1;\nEndFor\n"},
      {"macro.geo", kBox + "Macro m\n  Call m;\nReturn\nCall m;\n"},
      {"fine.geo", kBox + "Mesh.MeshSizeMax = 1e-6;\n"},
  };
  for (const auto& [name, content] : files) {
    const auto path = folder.write(name, content);
    expect_refused(path, check(path, {{"RINGDOWN_MESH_SECONDS", "1"}}), kBadInput, {"1 s of processor time"});
  }
}

TEST(HostileFiles, AGeometryThatFillsTheMemoryIsRefusedByItsMemory) {
  const TemporaryFolder folder;
  const auto path = folder.write("memory.geo", kBox + "a[] = {0:1e12};\n");
  expect_refused(path, check(path, {{"RINGDOWN_MESH_MIB", "300"}}), kFailure, {"300 MiB of memory"});
}

TEST(HostileFiles, GeometriesThatBreakGmshAreRefused) {
  const TemporaryFolder folder;
  const std::pair<const char*, std::string> files[] = {
      {"self.geo", "Include \"self.geo\";\n"},
      {"merged.geo", kBox + "Merge \"merged.geo\";\n"},
      {"threads.geo", kBox + "General.NumThreads = 1000000;\nMesh.MaxNumThreads3D = 100000;\n"},
      {"abort.geo", kBox + "General.AbortOnError = 4;\nBox(1) = {0,,0};\n"},
      {"algorithm.geo", kBox + "Mesh.Algorithm = 99;\nMesh.Algorithm3D = 99;\n"},
  };
  for (const auto& [name, content] : files) {
    const auto path = folder.write(name, content);
    expect_refused(path, check(path), kBadInput, {});
  }
}

// Each with its name and its line; in an included file with that file's.
TEST(HostileFiles, WhatDoesMoreThanDescribeABodyIsRefusedByName) {
  const TemporaryFolder folder;
  const std::string made = (folder / "made").string();
  const std::pair<const char*, std::string> statements[] = {
      {"SystemCall", "SystemCall \"touch " + made + "\";"},
      {"NonBlockingSystemCall", "NonBlockingSystemCall \"touch " + made + "\";"},
      {"Save", "Mesh 3; Save \"" + made + ".msh\";"},
      {"Print", "Print \"" + made + ".msh\";"},
      {"Printf", "Printf(\"text\") > \"" + made + "\";"},
      {"Printf", "Printf(\"%g\", 1) >> \"" + made + "\";"},
      {"CreateDir", "CreateDir \"" + made + "\";"},
      {"Exit", "Exit;"},
      {"Merge", "Merge \"/etc/passwd\";"},
      {"Include", "Include \"../secret.geo\";"},
      {"CommandLine", "Field[1] = ExternalProcess; Field[1].CommandLine = \"touch " + made + "\";"},
  };
  for (const auto& [name, statement] : statements) {
    const auto path = folder.write("body.geo", kBox + statement + "\n");
    const std::string word = name == std::string("CommandLine") ? "ExternalProcess" : name;
    expect_refused(path, check(path), kBadInput, {"line 3", "'" + word + "'"});
    const auto part = folder.write("part.txt", "// SystemCall\n" + statement + "\n");
    expect_refused(part, check(folder.write("whole.geo", kBox + "Include \"part.txt\";\n")), kBadInput, {"line 2"});
    const auto other = folder.write("program.msh", kBox + statement + "\n");
    expect_refused(other, check(other), kBadInput, {"line 3"});
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with("made")) << entry.path();
  }
}

// A material library of an OBJ was read from anywhere, and a line of it stood in the sentence.
TEST(HostileFiles, AnObjReadsNoOtherFile) {
  const TemporaryFolder folder, secret;
  const auto shadow = secret.write("shadow", "newmtl a\nKd TOPSECRET\n");
  const auto fifo = folder / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  const std::string box = test::file_of(test::box({0, 0, 0}, {0.1, 0.1, 0.1}), ".obj");
  for (const std::string& name :
       {"../" + secret.path().filename().string() + "/shadow", shadow.string(), fifo.string()}) {
    const auto checked = check(folder.write("box.obj", "mtllib " + name + "\nusemtl a\n" + box));
    EXPECT_EQ(checked.exit_code, 0) << name << ": " << checked.error;
    EXPECT_EQ(checked.error, "");
  }
}

// By a way that no scan for names sees: an option of gmsh names a file of sizes.
TEST(HostileFiles, AGeometryReadsNothingOutsideOfItsFolderWithLandlock) {
  if (!sandbox_of_kernel().files) GTEST_SKIP() << "this kernel has no Landlock";
  const TemporaryFolder folder, other;
  const std::string sizes = "0 0 0\n0.1 0.1 0.1\n2 2 2\n0.05 0.05 0.05 0.05 0.05 0.05 0.05 0.05\n";
  const auto body_with = [&folder](const std::filesystem::path& file) {
    return folder.write("body.geo", kBox + "Field[1] = Structured;\nField[1].FileName = \"" + file.string() +
                                        "\";\nField[1].TextFormat = 1;\nBackground Field = 1;\n");
  };
  EXPECT_EQ(check(body_with(folder.write("sizes.txt", sizes))).exit_code, 0);
  const auto path = body_with(other.write("sizes.txt", sizes));
  expect_refused(path, check(path), kBadInput, {"gmsh cannot make a mesh", "file"});
}

// An object file may name a geometry in another folder; what lies there is that folder's.
TEST(HostileFiles, AnObjectMayNameAGeometryElsewhereWhichIncludesWhatIsBesideIt) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "shapes");
  std::filesystem::create_directories(folder / "objects");
  (void)folder.write("shapes/part.geo", "Box(1) = {0, 0, 0, 0.1, 0.02, 0.01};\n");
  (void)folder.write("shapes/bar.geo", "SetFactory(\"OpenCASCADE\");\nInclude \"part.geo\";\n");
  const auto object =
      folder.write("objects/bar.toml",
                   "name = \"bar\"\ngeometry = \"../shapes/bar.geo\"\nmaterial = \"steel\"\nmesh_size_m = 0.02\n");
  const auto done = run_child({.command = {RINGDOWN_BIN_DIR "/ringdown-bake", object.string(), "--no-cache", "-q", "-o",
                                           (folder / "bar.glb").string()}});
  ASSERT_TRUE(done);
  EXPECT_EQ(done->exit_code, 0) << done->errors;
}

TEST(HostileFiles, AMeshSizeIsRefusedByTheNumberOfElementsItMeans) {
  const TemporaryFolder folder;
  const std::string box = test::file_of(test::box({0, 0, 0}, {0.1, 0.1, 0.1}), ".stl");
  const std::filesystem::path files[] = {
      folder.write("box.geo", kBox), folder.write("box.stl", box),
      folder.write("box.toml", "name = \"box\"\ngeometry = \"box.stl\"\nmaterial = \"steel\"\nmesh_size_m = 1e-6\n")};
  for (const auto& file : files) {
    std::vector<std::string> command = {RINGDOWN_BIN_DIR "/ringdown-bake", file.string(), "--no-cache", "-q", "-o",
                                        (folder / "box.glb").string()};
    if (file.extension() != ".toml") command.insert(command.end(), {"-m", "steel", "--mesh-size", "1e-9"});
    const auto done = run_child({.command = command, .limit_s = 60});
    ASSERT_TRUE(done);
    EXPECT_EQ(done->exit_code, kBadInput) << file;
    EXPECT_NE(done->errors.find("it means about"), std::string::npos) << done->errors;
  }
}

// The processes whose command line names the file.
std::vector<pid_t> readers_of(const std::filesystem::path& file) {
  std::vector<pid_t> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ifstream words(entry.path() / "cmdline");
    std::string word, last;
    bool mesher = false;
    while (std::getline(words, word, '\0')) {
      mesher = mesher || word.ends_with("ringdown-mesher");
      last = word;
    }
    if (mesher && last == file) found.push_back(std::stoi(entry.path().filename().string()));
  }
  return found;
}

TEST(HostileFiles, ASignalEndsTheReadingProcessToo) {
  const TemporaryFolder folder;
  const auto file = folder.write("for.geo", kBox + "For i In {1:1e18}\n  a = i;\nEndFor\n");
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    const pid_t id = ::fork();
    if (id == 0) {
      ::execl(RINGDOWN_BIN_DIR "/ringdown-check", "ringdown-check", "mesh", file.c_str(), nullptr);
      ::_exit(127);
    }
    while (readers_of(file).empty()) ::usleep(10'000);
    ::kill(id, signal);
    int status = 0;
    ::waitpid(id, &status, 0);
    if (signal != SIGKILL) {
      EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 130) << signal;
    }
    while (!readers_of(file).empty()) ::usleep(10'000);
  }
}

// As on a kernel without Landlock: its calls fail with ENOSYS.
TEST(HostileFiles, AKernelWithoutLandlockIsSaidOnceAndNamesAreStillRefused) {
  if (!sandbox_of_kernel().calls) GTEST_SKIP() << "this kernel has no seccomp filters";
  const TemporaryFolder folder;
  const auto run = [&folder](const std::filesystem::path& file) {
    const auto out = folder / "stderr";
    const pid_t id = ::fork();
    if (id == 0) {
      sock_filter code[] = {{BPF_LD | BPF_W | BPF_ABS, 0, 0, 0},
                            {BPF_JMP | BPF_JEQ | BPF_K, 0, 1, SYS_landlock_create_ruleset},
                            {BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ERRNO | ENOSYS},
                            {BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ALLOW}};
      sock_fprog program{4, code};
      ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
      ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &program);
      if (!std::freopen(out.c_str(), "w", stderr) || !std::freopen("/dev/null", "w", stdout)) ::_exit(126);
      ::execl(RINGDOWN_BIN_DIR "/ringdown-check", "ringdown-check", "mesh", file.c_str(), nullptr);
      ::_exit(127);
    }
    int status = 0;
    ::waitpid(id, &status, 0);
    std::ifstream text(out);
    return Checked{WEXITSTATUS(status), {std::istreambuf_iterator<char>(text), {}}};
  };
  const auto good = run(folder.write("box.geo", kBox));
  EXPECT_EQ(good.exit_code, 0);
  EXPECT_EQ(good.error.find("no Landlock"), good.error.rfind("no Landlock")) << good.error;
  EXPECT_NE(good.error.find("no Landlock"), std::string::npos);
  const auto bad = run(folder.write("bad.geo", kBox + "Merge \"/etc/passwd\";\n"));
  EXPECT_EQ(bad.exit_code, kBadInput);
  EXPECT_NE(bad.error.find("'Merge' reads '/etc/passwd'"), std::string::npos) << bad.error;
}

}  // namespace
}  // namespace ringdown
