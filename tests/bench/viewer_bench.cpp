// What a frame of ringdown-viewer costs in processor time, against the number of bodies, all ringing: half of them
// bells, half plates, of 120 modes each, that turn in the air; a window of 1280 x 800 on a display without a screen.
//
//   ringdown_viewer_bench [--quick] [-o FILE]
//
// Medians over frames, of our own thread and of the whole process, which includes the threads of the OpenGL driver:
//
//   frame    App::draw: all that follows but `pick`, and the window
//   notice   what the daemon tells of a sixtieth of a second: poses, levels, amplitudes, sound, two contacts
//   stage    Stage::set
//   render   SceneRenderer::render, until the driver has drawn
//   sound    SoundView::draw
//   side     SideView::draw
//   pick     a click in the middle of the picture
#include "clients/viewer/app.h"
#include "protocol/wire/message.h"
#include "tests/bench/machine.h"
#include "tests/support/virtual_display.h"
#include "tests/viewer/preset_file.h"

#include <CLI/CLI.hpp>
#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <thread>
#include <utility>
#include <time.h>

namespace {

using namespace ringdown;
using namespace ringdown::viewer;

constexpr int kWidth = 1280, kHeight = 800;
constexpr double kPeriod_s = 1 / App::kNotices_hz, kPitch_m = 0.3;
constexpr int kWarmUp = 5;
constexpr std::size_t kModes = 120;
constexpr const char* kBanks[] = {"bronze-bell", "steel-plate"};

// A daemon that plays `bodies` bodies, without a network.
class Daemon {
 public:
  explicit Daemon(int bodies) : bodies_(bodies), side_(static_cast<int>(std::ceil(std::sqrt(bodies)))) {
    for (const char* name : kBanks) {
      files_.push_back(test::bytes_of(test::preset_bank(name)));
      contents_.push_back(test::content_of(files_.back()));
    }
  }

  // Tells the model everything, banks included.
  void describe(Model& model) const {
    model.watch_sound(true);
    protocol::SceneReply head{.version = 1, .bodies = bodies_, .file = "bench"};
    head.camera_m = {-0.5 * width_m(), -1.6 * width_m(), 0.9 * width_m()};
    head.field_of_view_degrees = 45;
    model.apply(head, 0);
    for (int i = 0; i < bodies_; ++i) {
      model.apply(protocol::SceneBody{1, i, name_of(i), name_of(i), "convex", {0.2, 0.2, 0.2}, false}, 0);
      protocol::ObjectReply object{.number = i, .name = name_of(i), .version = 1};
      object.bank_bytes = static_cast<std::int32_t>(file_of(i).size());
      object.bank_content = contents_[static_cast<std::size_t>(i) % files_.size()];
      object.modes = object.selected_modes = kModes;
      model.apply(object, 0);
    }
    const auto has_bank = [](const auto& entry) { return entry.second.bank != nullptr; };
    for (double now_s = 0; !std::ranges::all_of(model.objects(), has_bank); now_s += kPeriod_s) {
      if (now_s > 600) throw std::runtime_error("a bank did not come");
      serve(model, now_s);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  void notice(Model& model, double now_s) {
    model.apply(protocol::NotifyScene{1, now_s, false}, now_s);
    const std::vector<float> amplitudes(kModes, 0.01F), samples(1600, 0.1F);
    const wire::Blob told = wire::encode_floats(amplitudes);
    for (int i = 0; i < bodies_; ++i) {
      const Vec3 place{(i % side_) * kPitch_m - width_m() / 2, (i / side_) * kPitch_m - width_m() / 2, 0.2};
      const double half_turn = now_s + i;
      model.apply(
          protocol::NotifyBody{i, name_of(i), name_of(i), place, 0, 0, std::sin(half_turn), std::cos(half_turn)},
          now_s);
      model.apply(protocol::NotifyObjectPeak{name_of(i), 0.1}, now_s);
      if (i < static_cast<int>(ObjectWatches::kMaxWatched))
        model.apply(protocol::NotifyModes{name_of(i), 0, told}, now_s);
    }
    for (int i = 0; i < 2; ++i, ++contacts_) {
      model.apply(protocol::NotifyContact{name_of(contacts_ % bodies_), {0, 0, 0.1}, {0, 0, 0.01}, 0.001}, now_s);
    }
    model.apply(protocol::NotifySound{frame_, 48000, wire::encode_floats(samples)}, now_s);
    frame_ += 800;
  }

 private:
  static std::string name_of(int body) { return "object-" + std::to_string(body); }
  [[nodiscard]] const wire::Blob& file_of(int body) const {
    return files_[static_cast<std::size_t>(body) % files_.size()];
  }
  [[nodiscard]] double width_m() const { return kPitch_m * side_; }

  void serve(Model& model, double now_s) const {
    for (const protocol::Request& request : model.wants(now_s)) {
      const auto* wanted = request.get_if<protocol::ReadBank>();
      if (!wanted) continue;
      const int body = std::stoi(wanted->object.name.substr(wanted->object.name.find('-') + 1));
      model.apply(test::piece_of(file_of(body), wanted->object.name, 1, wanted->offset, wanted->bytes), now_s);
    }
  }

  int bodies_, side_;
  std::vector<wire::Blob> files_;
  std::vector<std::string> contents_;  // of the files
  int contacts_ = 0;
  std::int32_t frame_ = 0;
};

double spent_us(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return 1e6 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_nsec);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

struct Costs {
  std::vector<double> thread_us, process_us;

  template <class Work>
  void measure(Work work) {
    const double thread = spent_us(CLOCK_THREAD_CPUTIME_ID), process = spent_us(CLOCK_PROCESS_CPUTIME_ID);
    work();
    thread_us.push_back(spent_us(CLOCK_THREAD_CPUTIME_ID) - thread);
    process_us.push_back(spent_us(CLOCK_PROCESS_CPUTIME_ID) - process);
  }
};

struct Table {
  std::FILE* csv = nullptr;
  std::string driver;
  std::size_t triangles = 0;

  void add(const char* part, int bodies, const Costs& costs) const {
    for (std::FILE* file : {stdout, csv}) {
      if (!file) continue;
      std::fprintf(file, "%s,%d,%zu,%.1f,%.1f,%zu,%s\n", part, bodies, triangles, median(costs.thread_us),
                   median(costs.process_us), costs.thread_us.size(), driver.c_str());
      std::fflush(file);
    }
  }
};

template <class T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  return std::move(*result);
}

Window open_window() { return value_of(Window::open({kWidth, kHeight, true, 1})); }

// A pane of the width it has in the application.
template <class Draw>
void in_pane(const char* name, Costs& costs, float x, double width, Draw draw) {
  ImGui::SetNextWindowPos({x, 0});
  ImGui::SetNextWindowSize({static_cast<float>(width), kHeight});
  ImGui::Begin(name, nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings);
  costs.measure(draw);
  ImGui::End();
}

void measure_parts(int bodies, int frames, Table& table) {
  Window window = open_window();
  table.driver = bench::this_machine(reinterpret_cast<const char*>(glGetString(GL_RENDERER)));
  Daemon daemon(bodies);
  Model model(App::kNotices_hz);
  daemon.describe(model);
  Commands commands(model, [](const protocol::Request&) {});
  SceneRenderer renderer = value_of(SceneRenderer::create());
  Stage stage;
  SoundView sound;
  Settings settings;
  const Skin skin = make_skin(true);
  apply(skin, 1);
  SideView side("osc.udp://127.0.0.1:1");
  const int height = kHeight, width = static_cast<int>(kWidth * (1 - settings.side_share - settings.sound_share));
  Costs notice, set, render, sounding, sided, picked;
  double now_s = 1000;
  for (int i = -kWarmUp; i < frames; ++i, now_s += kPeriod_s) {
    if (i == 0) notice = set = render = sounding = sided = picked = {};
    notice.measure([&] { daemon.notice(model, now_s); });
    commands.update(now_s);
    set.measure([&] { stage.update(model, commands, renderer, true, now_s); });
    if (stage.contents().items.size() != static_cast<std::size_t>(bodies))
      throw std::runtime_error("a body is not shown");
    const float aspect = static_cast<float>(width) / static_cast<float>(height);
    Camera camera = stage.home(model, aspect);
    glFinish();
    render.measure([&] {
      renderer.render(stage.contents().frame, camera, width, height);
      glFinish();
    });
    picked.measure(
        [&] { pick(camera.ray_through(width / 2.0F, height / 2.0F, width, height), stage.contents().picked); });
    window.begin_frame();
    in_pane("sound", sounding, kWidth / 2, kWidth * settings.sound_share,
            [&] { sound.draw(skin, model, commands, false); });
    in_pane("side", sided, 0, kWidth * settings.side_share,
            [&] { side.draw(skin, {}, model, commands, settings, camera); });
    window.end_frame();
  }
  table.triangles = 0;
  for (const PickedBody& body : stage.contents().picked) {
    table.triangles += std::get<const DrawnMesh*>(body.shape)->triangles.size();
  }
  table.add("notice", bodies, notice);
  table.add("stage", bodies, set);
  table.add("render", bodies, render);
  table.add("sound", bodies, sounding);
  table.add("side", bodies, sided);
  table.add("pick", bodies, picked);
}

void measure_frame(int bodies, int frames, const Table& table) {
  using Clock = std::chrono::steady_clock;
  Daemon daemon(bodies);
  const auto start = Clock::now();
  Window window = open_window();
  SceneRenderer renderer = value_of(SceneRenderer::create());
  App app(std::move(window), std::move(renderer), Settings{},
          {.daemon = "osc.udp://127.0.0.1:1", .scene = {}, .only = Pane::any, .shown_at_s = {}});
  daemon.describe(app.model());
  Costs costs;
  for (int i = -kWarmUp; i < frames; ++i) {
    if (i == 0) costs = {};
    costs.measure([&] {
      daemon.notice(app.model(), std::chrono::duration<double>(Clock::now() - start).count());
      app.draw();
      glFinish();
    });
  }
  if (app.scene_view().stage().contents().items.size() != static_cast<std::size_t>(bodies)) {
    throw std::runtime_error("a body is not shown");
  }
  table.add("frame", bodies, costs);
}

}  // namespace

int main(int count, char** words) {
  bool quick = false;
  std::string path;
  CLI::App app("What a frame of the viewer costs by the number of bodies", "ringdown_viewer_bench");
  app.add_flag("--quick", quick, "Fewer frames");
  app.add_option("-o", path, "CSV file");
  CLI11_PARSE(app, count, words);
  const test::VirtualDisplay display;
  if (!display.works()) return std::fprintf(stderr, "ringdown_viewer_bench: it needs Xvfb (package xvfb)\n"), 1;
  Table table{path.empty() ? nullptr : std::fopen(path.c_str(), "w"), {}};
  for (std::FILE* file : {stdout, table.csv}) {
    if (file) std::fprintf(file, "part,bodies,triangles,thread_us,process_us,frames,machine\n");
  }
  try {
    for (const int bodies : {1, 10, 100}) {
      measure_parts(bodies, quick ? 10 : 30, table);
      measure_frame(bodies, quick ? 10 : 30, table);
    }
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "ringdown_viewer_bench: %s\n", error.what()), 1;
  }
  return table.csv && std::fclose(table.csv) != 0 ? 1 : 0;
}
