// The module ringdown._scene: scenes of rigid bodies, by libringdown-scene. It shares no C++ type with ringdown._core:
// the mixer comes in a capsule, and the scene keeps the Python object of the mixer alive.
#include <ringdown_python.h>

#include <ringdown_scene.h>

#include <pybind11/numpy.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::python {
namespace {

class Scene {
 public:
  Scene(py::object mixer, const py::object& path, Whole<std::int64_t> frame) : mixer_(std::move(mixer)) {
    if (!py::hasattr(mixer_, "_capsule")) throw py::type_error("the first argument must be a ringdown.Mixer");
    const auto capsule = mixer_.attr("_capsule")().cast<py::capsule>();
    if (std::string(capsule.name()) != kMixerCapsule)
      throw py::type_error("the first argument must be a ringdown.Mixer");
    const std::string bytes = path_of(path);
    ringdown_scene* scene = nullptr;
    call(ringdown_scene_load, capsule.get_pointer<ringdown_mixer>(), c_string(bytes), frame.value, &scene);
    scene_.reset(scene);
  }

  [[nodiscard]] ringdown_scene* get() const { return scene_.get(); }

 private:
  struct Destroy {
    void operator()(ringdown_scene* scene) const { ringdown_scene_destroy(scene); }
  };
  py::object mixer_;  // outlives the scene
  std::unique_ptr<ringdown_scene, Destroy> scene_;
};

py::tuple poses_of(const Scene& self) {
  std::vector<ringdown_body> bodies(ringdown_scene_bodies(self.get()));
  const std::size_t count = std::min(bodies.size(), ringdown_scene_poses(self.get(), bodies.data(), bodies.size()));
  py::array_t<std::uint32_t> numbers(count);
  py::array_t<double> positions_m(std::vector<std::size_t>{count, 3}), rotations(std::vector<std::size_t>{count, 4});
  for (std::size_t b = 0; b < count; ++b) {
    numbers.mutable_data()[b] = bodies[b].number;
    std::copy_n(bodies[b].position_m, 3, positions_m.mutable_data() + 3 * b);
    std::copy_n(bodies[b].rotation_wxyz, 4, rotations.mutable_data() + 4 * b);
  }
  return py::make_tuple(numbers, positions_m, rotations);
}

}  // namespace

PYBIND11_MODULE(_scene, module) {
  module.doc() = "Scenes of libringdown-scene; `import ringdown` shows them.";
  py::class_<Scene>(
      module, "Scene",
      "Rigid bodies that fall, collide, slide and roll, and sound by a mixer, which has at most one scene.")
      .def(py::init<py::object, py::object, Whole<std::int64_t>>(), py::arg("mixer"), py::arg("path"),
           py::arg("frame") = 0,
           "Loads a scene file (.toml) and the objects that it names into the mixer; the scene starts at `frame`.")
      .def(
          "advance", [](Scene& self, Whole<std::int64_t> frame) { ringdown_scene_advance(self.get(), frame); },
          py::arg("frame"),
          "Steps the bodies until all events before `frame` have been sent to the mixer. A mixer takes 4096 events"
          " between two blocks, so advance 10 to 50 ms at a time.")
      .def(
          "pause", [](Scene& self, bool paused) { call(ringdown_scene_pause, self.get(), paused ? 1 : 0); },
          py::arg("paused") = true, "Pauses the bodies, or lets them continue.")
      .def(
          "push",
          [](Scene& self, Whole<std::uint32_t> body, const Vector& impulse_ns) {
            call(ringdown_scene_push, self.get(), body, impulse_ns.data());
          },
          py::arg("body"), py::arg("impulse_ns"), "An impulse [N s], in the scene's axes, at a body's centre of mass.")
      .def(
          "clear", [](Scene& self) { call(ringdown_scene_clear, self.get()); }, "Removes all bodies.")
      .def(
          "find_object",
          [](Scene& self, const std::string& name) {
            std::uint32_t number = 0;
            call(ringdown_scene_find_object, self.get(), c_string(name), &number);
            return number;
          },
          py::arg("name"), "The number of an object of the scene, as Mixer.strike() takes it, by its name in the file.")
      .def(
          "find_body",
          [](Scene& self, const std::string& name) {
            std::uint32_t number = 0;
            call(ringdown_scene_find_body, self.get(), c_string(name), &number);
            return number;
          },
          py::arg("name"), "The number of a body, as push() and poses() have it, by its name in the file.")
      .def("poses", &poses_of,
           "The poses of the bodies: their N numbers, N x 3 positions [m] and N x 4 quaternions w x y z.")
      .def_property_readonly(
          "duration_s", [](const Scene& self) { return ringdown_scene_duration_s(self.get()); },
          "The scene's duration in its file [s]; 0: no end.");
}

}  // namespace ringdown::python
