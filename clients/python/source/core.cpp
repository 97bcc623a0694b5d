// The module ringdown._core, and its class Bank. Arrays of a bank are views of the library's memory, which cannot be
// written to and keep the bank alive.
#include <ringdown_python.h>

#include <pybind11/numpy.h>

#include <complex>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::python {

void add_mixer(py::module_& module);  // mixer.cpp

namespace {

class Bank {
 public:
  explicit Bank(ringdown_bank* bank) : bank_(bank) { ringdown_bank_describe(bank, &info_); }

  [[nodiscard]] const ringdown_bank* get() const { return bank_.get(); }
  [[nodiscard]] const ringdown_bank_info& info() const { return info_; }

 private:
  struct Release {
    void operator()(ringdown_bank* bank) const { ringdown_bank_release(bank); }
  };
  std::unique_ptr<ringdown_bank, Release> bank_;
  ringdown_bank_info info_{sizeof(ringdown_bank_info), 0, 0, 0, "", "", 0, 0, 0, 0, {}, 0};
};

Bank open(const py::object& path) {
  const std::string bytes = path_of(path);
  ringdown_bank* bank = nullptr;
  call_without_lock(ringdown_bank_open, c_string(bytes), &bank);
  return Bank(bank);
}

Bank parse(const py::object& glb, const std::string& name) {
  Py_buffer view;
  if (PyObject_GetBuffer(glb.ptr(), &view, PyBUF_SIMPLE) != 0) throw py::error_already_set();
  const std::unique_ptr<Py_buffer, decltype(&PyBuffer_Release)> release(&view, PyBuffer_Release);
  ringdown_bank* bank = nullptr;
  call(ringdown_bank_parse, view.buf, static_cast<std::size_t>(view.len), c_string(name), &bank);
  return Bank(bank);
}

// The bank's own memory as an array. `owner` is the Python object of the bank.
template <class Number>
py::array view(const py::object& owner, const Number* numbers, const std::vector<std::size_t>& shape) {
  py::array_t<Number> array(shape, numbers, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

const Bank& bank_of(const py::object& self) { return self.cast<const Bank&>(); }

py::object material_of(const Bank& bank) {
  const ringdown_bank_info& info = bank.info();
  if (!(info.density_kg_m3 > 0)) return py::none();
  return py::module_::import("ringdown.values")
      .attr("Material")(info.material, info.youngs_modulus_pa, info.poisson_ratio, info.density_kg_m3);
}

py::array levels_of(const Bank& bank) {
  py::array_t<double> levels(bank.info().modes);
  const ringdown_result result = ringdown_bank_levels_pa(bank.get(), levels.mutable_data());
  if (result != RINGDOWN_OK) raise(result, "the levels cannot be computed");
  return levels;
}

using Directions = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::array far_field_of(const Bank& bank, Whole<std::uint32_t> mode, const Directions& directions) {
  const bool is_one = directions.ndim() == 1 && directions.shape(0) == 3;
  if (!is_one && !(directions.ndim() == 2 && directions.shape(1) == 3)) {
    refuse("directions must be an array of N x 3 numbers");
  }
  const auto count = static_cast<std::size_t>(directions.size() / 3);
  py::array_t<std::complex<float>> field(count);
  call(ringdown_bank_far_field, bank.get(), std::size_t{mode}, directions.data(), count,
       reinterpret_cast<float*>(field.mutable_data()));
  return field;
}

ringdown_piece_info piece_info(const Bank& bank, std::uint32_t pattern, std::uint32_t piece) {
  ringdown_piece_info info{};
  info.size = sizeof info;
  call(ringdown_breakable_piece, bank.get(), pattern, piece, &info);
  return info;
}

// An empty tuple for a bank without pieces.
py::tuple patterns_of(const Bank& bank) {
  py::list patterns;
  ringdown_pattern_info info{};
  info.size = sizeof info;
  for (std::uint32_t p = 0; ringdown_breakable(bank.get(), p, &info, nullptr) == RINGDOWN_OK; ++p) {
    py::list pieces;
    for (std::uint32_t i = 0; i < info.pieces; ++i) pieces.append(piece_of(piece_info(bank, p, i)));
    patterns.append(py::module_::import("ringdown.values")
                        .attr("Pattern")(py::make_tuple(info.at_m[0], info.at_m[1], info.at_m[2]), info.crack_energy_j,
                                         py::tuple(pieces)));
    if (p + 1 == info.patterns) break;
  }
  return py::tuple(patterns);
}

py::tuple piece_mesh(const py::object& self, Whole<std::uint32_t> pattern, Whole<std::uint32_t> piece) {
  const ringdown_piece_info info = piece_info(bank_of(self), pattern, piece);
  return py::make_tuple(view(self, info.points_m, {info.points, 3}),
                        view(self, info.triangle_points, {info.triangles, 3}));
}

std::string text_of(const Bank& bank) {
  const ringdown_bank_info& info = bank.info();
  return "<ringdown.Bank '" + std::string(info.name) + "': " + std::to_string(info.modes) + " modes at " +
         std::to_string(info.points) + " points>";
}

void add_bank(py::module_& module) {
  const auto modes = [](const Bank& bank) { return bank.info().modes; };
  const auto points = [](const Bank& bank) { return bank.info().points; };
  const auto triangles = [](const Bank& bank) { return bank.info().triangles; };
  py::class_<Bank>(module, "Bank",
                   "The M vibration modes of an object, known at P points of its surface with T triangles between them."
                   " Arrays are views without copies: they cannot be written to, and keep the bank alive.")
      .def_static("open", &open, py::arg("path"), "Reads a bank, a .glb file of ringdown-bake or another program.")
      .def_static("parse", &parse, py::arg("glb"), py::arg("name") = "bank",
                  "Reads a bank from the bytes of a bank file; error sentences contain `name` in place of the path.")
      .def_property_readonly(
          "name", [](const Bank& bank) { return bank.info().name; }, "The object's name, '' without one.")
      .def_property_readonly(
          "frequencies_hz",
          [=](const py::object& self) {
            const Bank& bank = bank_of(self);
            return view(self, ringdown_bank_frequencies_hz(bank.get()), {modes(bank)});
          },
          "M damped frequencies [Hz], in order of decreasing importance to the ear.")
      .def_property_readonly(
          "decays_per_s",
          [=](const py::object& self) {
            const Bank& bank = bank_of(self);
            return view(self, ringdown_bank_decays_per_s(bank.get()), {modes(bank)});
          },
          "M decays of the amplitude [1/s]; T60 is 6.91 / decay.")
      .def_property_readonly(
          "shapes",
          [=](const py::object& self) {
            const Bank& bank = bank_of(self);
            return view(self, ringdown_bank_shapes(bank.get()), {modes(bank), points(bank), 3});
          },
          "M x P x 3 mode shapes, mass-normalised [kg^-1/2].")
      .def_property_readonly(
          "points_m",
          [=](const py::object& self) {
            const Bank& bank = bank_of(self);
            return view(self, ringdown_bank_points_m(bank.get()), {points(bank), 3});
          },
          "P x 3 sample points on the surface [m].")
      .def_property_readonly(
          "triangles",
          [=](const py::object& self) {
            const Bank& bank = bank_of(self);
            return view(self, ringdown_bank_triangles(bank.get()), {triangles(bank), 3});
          },
          "T x 3 numbers of points.")
      .def_property_readonly("material", &material_of, "A ringdown.Material, or None if the bank names none.")
      .def_property_readonly(
          "mass_kg",
          [](const Bank& bank) -> py::object {
            if (!(bank.info().mass_kg > 0)) return py::none();
            return py::float_(bank.info().mass_kg);
          },
          "The mass [kg], or None if it is not known.")
      .def_property_readonly(
          "center_of_mass_m",
          [](const py::object& self) { return view(self, bank_of(self).info().center_of_mass_m, {3}); },
          "The centre of mass, 3 coordinates [m].")
      .def_property_readonly(
          "has_radiation", [](const Bank& bank) { return bank.info().has_radiation != 0; },
          "True if the modes have radiation maps, which far_field() needs.")
      .def_property_readonly("patterns", &patterns_of,
                             "A ringdown.Pattern for each way in which the object can break; none if it cannot break.")
      .def("piece_mesh", &piece_mesh, py::arg("pattern"), py::arg("piece"),
           "The surface of a piece: its points, P x 3 [m], and T x 3 numbers of points.")
      .def("levels_pa", &levels_of,
           "M levels: the sound pressure at 1 m per modal velocity, rms over directions [Pa / (kg^1/2 m/s)].")
      .def("far_field", &far_field_of, py::arg("mode"), py::arg("directions"),
           "The far field of one mode towards N directions (N x 3, of any length but 0): N complex numbers"
           " [m^2 kg^-1/2].\n\nThe pressure at distance r is i rho omega v F exp(ikr) / r for a modal velocity v, with"
           " time as exp(-i omega t).")
      .def("__repr__", &text_of);
}

}  // namespace

const ringdown_bank* native_bank(const py::handle& bank) {
  if (!py::isinstance<Bank>(bank)) throw py::type_error("the bank must be a ringdown.Bank");
  return bank.cast<const Bank&>().get();
}

PYBIND11_MODULE(_core, module) {
  module.doc() = "Banks and mixers of libringdown; `import ringdown` shows them.";
  module.def("version", &ringdown_version, "The version of libringdown.");
  add_bank(module);
  add_mixer(module);
}

}  // namespace ringdown::python
