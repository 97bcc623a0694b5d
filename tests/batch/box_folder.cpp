#include "tests/batch/box_folder.h"

#include "engine/modal/bank_file.h"

#include <algorithm>
#include <csignal>
#include <sstream>
#include <thread>

namespace ringdown::test {

namespace fs = std::filesystem;

namespace {

const std::string kFigure = "source = \"for a test\"\n";

const std::string kStuff = "name = \"stuff\"\ndescription = \"for a test\"\n[youngs_modulus_pa]\nvalue = 2e11\n" +
                           kFigure + "[poisson_ratio]\nvalue = 0.3\n" + kFigure + "[density_kg_m3]\nvalue = 7800\n" +
                           kFigure + "[alpha_per_s]\nvalue = 1\n" + kFigure + "[beta_s]\nvalue = 1e-8\n" + kFigure;

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

}  // namespace

BoxFolder::BoxFolder() {
  fs::create_directories(objects());
  fs::create_directories(materials());
  write("materials/stuff.toml", kStuff);
  write("objects/parameters.geo", "width = 40;\n");
  write("objects/box.geo",
        "SetFactory(\"OpenCASCADE\"); // made anew each time it is baked\nDefineConstant[ length = 100, mesh_size = 20 "
        "];\n"
        "Include \"parameters.geo\";\nBox(1) = {0, 0, 0, length, width, 20};\n");
}

fs::path BoxFolder::write(const std::string& name, const std::string& text) const {
  fs::create_directories((folder_ / name).parent_path());
  return folder_.write(name, text);
}

void BoxFolder::box(const std::string& name, int length_mm, const std::string& more) const {
  write("objects/" + name + ".toml", "material = \"stuff\"\ngeometry = \"" + (objects() / "box.geo").string() +
                                         "\"\nunit_m = 0.001\nmesh_size_m = 0.02\nelement = \"tet4\"\n" + more +
                                         "\n[parameters]\nlength = " + std::to_string(length_mm) + "\n");
}

void BoxFolder::slow(const std::string& name) const {
  write("objects/" + name + ".toml", "material = \"stuff\"\nunit_m = 0.001\nmesh_size_m = 0.012\ngeometry = \"" +
                                         std::string(RINGDOWN_SOURCE_DIR "/presets/objects/bronze-bell.geo\"\n"));
}

std::vector<std::string> BoxFolder::command(std::vector<std::string> options) const {
  std::vector<std::string> all = {
      RINGDOWN_BIN_DIR "/ringdown-bake", objects(), "-o", banks(), "--materials", materials(), "--no-cache"};
  all.insert(all.end(), options.begin(), options.end());
  return all;
}

Outcome BoxFolder::bake(const std::vector<std::string>& options) const {
  return run(command(options), {}, std::chrono::minutes(4));
}

std::vector<std::string> BoxFolder::files_in_banks() const {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& file : fs::recursive_directory_iterator(banks(), error)) {
    if (file.is_regular_file()) names.push_back(file.path().lexically_relative(banks()));
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> BoxFolder::whole_banks() const {
  std::vector<std::string> names = files_in_banks();
  std::erase_if(names, [this](const std::string& name) { return !modal::read_bank(banks() / name); });
  return names;
}

std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> children;
  std::error_code error;
  for (const auto& thread : fs::directory_iterator("/proc/" + std::to_string(parent) + "/task", error)) {
    std::istringstream list(text_of(thread.path() / "children"));
    for (pid_t child; list >> child;) children.push_back(child);
  }
  return children;
}

bool is_running(pid_t process) {
  const std::string status = text_of("/proc/" + std::to_string(process) + "/stat");
  const std::size_t bracket = status.rfind(')');  // after the name; a zombie has ended
  return bracket != std::string::npos && status.size() > bracket + 2 && status[bracket + 2] != 'Z';
}

bool comes_true(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(4);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

}  // namespace ringdown::test
