// The module ringdown._core, and its class Bank. Arrays of a bank are views of the library's memory, which cannot be
// written to and keep the bank alive.
#include <ringdown_python.h>

#include <pybind11/numpy.h>

#include <algorithm>
#include <cmath>
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
  explicit Bank(ringdown_bank* bank) : bank_(bank) { describe(); }

  void describe() { ringdown_bank_describe(bank_.get(), &info_); }

  [[nodiscard]] const ringdown_bank* get() const { return bank_.get(); }
  [[nodiscard]] const ringdown_bank_info& info() const { return info_; }

 private:
  struct Release {
    void operator()(ringdown_bank* bank) const { ringdown_bank_release(bank); }
  };
  std::unique_ptr<ringdown_bank, Release> bank_;
  ringdown_bank_info info_{sizeof(ringdown_bank_info), 0, 0, 0, "", "", 0, 0, 0, 0, {}, 0, 0, 0, {}, {}, {}};
};

Bank open(const py::object& path, const py::object& residual) {
  const std::string bytes = path_of(path);
  ringdown_bank* bank = nullptr;
  call_without_lock(ringdown_bank_open, c_string(bytes), &bank);
  Bank opened(bank);
  if (residual.is_none()) return opened;
  const std::string beside = path_of(residual);
  call_without_lock(ringdown_bank_read_residual, bank, c_string(beside));
  opened.describe();
  return opened;
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

// One of the lists of the bank; None if the bank does not have it.
py::object list_of(const Bank& bank, ringdown_bank_list list) {
  std::size_t count = 0;
  call(ringdown_bank_numbers, bank.get(), list, static_cast<double*>(nullptr), &count);
  if (count == 0) return py::none();
  py::array_t<double> numbers(count);
  call(ringdown_bank_numbers, bank.get(), list, numbers.mutable_data(), &count);
  return numbers;
}

// A ringdown.Losses; None if the bank does not have them.
py::object losses_of(const Bank& bank) {
  py::object found = list_of(bank, RINGDOWN_LOSSES_PER_S);
  if (found.is_none()) return found;
  return py::module_::import("ringdown.values").attr("Losses")(*found.attr("reshape")(-1, 4).attr("T"));
}

py::array undamped_of(const Bank& bank) {
  constexpr double kTurn = 6.283185307179586;
  const double* frequencies = ringdown_bank_frequencies_hz(bank.get());
  const double* decays = ringdown_bank_decays_per_s(bank.get());
  py::array_t<double> undamped(bank.info().modes);
  for (std::size_t m = 0; m < bank.info().modes; ++m)
    undamped.mutable_data()[m] = std::hypot(frequencies[m], decays[m] / kTurn);
  return undamped;
}

py::object provenance_of(const Bank& bank) {
  std::size_t bytes = 0;
  call(ringdown_bank_provenance, bank.get(), static_cast<char*>(nullptr), &bytes);
  std::string text(bytes, 0);
  call(ringdown_bank_provenance, bank.get(), text.data(), &bytes);
  return py::module_::import("json").attr("loads")(text.c_str());
}

py::bytes bytes_of(const Bank& bank) {
  std::size_t bytes = 0;
  call(ringdown_bank_write, bank.get(), static_cast<void*>(nullptr), &bytes);
  std::string glb(bytes, 0);
  call(ringdown_bank_write, bank.get(), static_cast<void*>(glb.data()), &bytes);
  return py::bytes(glb);
}

using Frequencies = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Response = py::array_t<std::complex<double>>;

// An array of the same shape as `frequencies`.
template <class Number>
py::array_t<Number> shaped_as(const Frequencies& frequencies) {
  return py::array_t<Number>(std::vector<py::ssize_t>(frequencies.shape(), frequencies.shape() + frequencies.ndim()));
}

Response frf_of(const Bank& bank, const Vector& at_m, const Vector& direction, const Vector& to_m,
                const Vector& to_direction, const Frequencies& frequencies, const std::string& kind) {
  static const std::vector<std::string> kKinds = {"receptance", "mobility", "accelerance"};
  const auto found = std::find(kKinds.begin(), kKinds.end(), kind);
  if (found == kKinds.end()) refuse("kind is '" + kind + "'; it can be receptance, mobility or accelerance");
  auto response = shaped_as<std::complex<double>>(frequencies);
  call(ringdown_bank_frf, bank.get(), static_cast<ringdown_motion>(found - kKinds.begin()), at_m.data(),
       direction.data(), to_m.data(), to_direction.data(), frequencies.data(),
       static_cast<std::size_t>(frequencies.size()), reinterpret_cast<double*>(response.mutable_data()));
  return response;
}

Response pressure_frf_of(const Bank& bank, const Vector& at_m, const Vector& direction, const Vector& to_m,
                         const Frequencies& frequencies) {
  auto response = shaped_as<std::complex<double>>(frequencies);
  call(ringdown_bank_pressure_frf, bank.get(), at_m.data(), direction.data(), to_m.data(), frequencies.data(),
       static_cast<std::size_t>(frequencies.size()), reinterpret_cast<double*>(response.mutable_data()));
  return response;
}

py::array energy_spectrum_of(const Bank& bank, const Vector& at_m, const Vector& direction,
                             const Frequencies& frequencies) {
  auto energies = shaped_as<double>(frequencies);
  call(ringdown_bank_energy_spectrum, bank.get(), at_m.data(), direction.data(), frequencies.data(),
       static_cast<std::size_t>(frequencies.size()), energies.mutable_data());
  return energies;
}

// Calls a function of ringdown.tables, which is Python, with the bank.
py::object table_of(const char* function, const py::object& self) {
  return py::module_::import("ringdown.tables").attr(function)(self);
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
      .def_static(
          "open", &open, py::arg("path"), py::arg("residual") = py::none(),
          "Reads a bank, a .glb file of ringdown-bake or another program. residual: the file that `ringdown bake"
          " --export-residual` wrote with it, for frf().")
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
          "inertia_kg_m2", [](const py::object& self) { return view(self, bank_of(self).info().inertia_kg_m2, {3}); },
          "The 3 principal moments of inertia about the centre of mass [kg m^2].")
      .def_property_readonly(
          "axes_wxyz", [](const py::object& self) { return view(self, bank_of(self).info().axes_wxyz, {4}); },
          "The rotation that turns the principal axes into the object's frame, a unit quaternion.")
      .def_property_readonly(
          "held", [](const Bank& bank) { return bank.info().held != 0; }, "True if supports hold the body.")
      .def_property_readonly(
          "levels_m",
          [](const Bank& bank) -> py::object {
            const ringdown_bank_info info = bank.info();
            if (info.level_m[0] == info.level_m[1]) return py::none();
            return py::make_tuple(info.level_m[0], info.level_m[1]);
          },
          "The bottom and the rim, between which Mixer.fill may set the level of its liquid [m]; None if it may not.")
      .def_property_readonly("undamped_frequencies_hz", &undamped_of, "M frequencies without damping [Hz].")
      .def_property_readonly(
          "frequency_errors", [](const Bank& bank) { return list_of(bank, RINGDOWN_FREQUENCY_ERRORS); },
          "M estimated relative errors of the frequencies, or None.")
      .def_property_readonly(
          "shape_errors", [](const Bank& bank) { return list_of(bank, RINGDOWN_SHAPE_ERRORS); },
          "M estimated relative errors of amplitudes between sample points, or None.")
      .def_property_readonly(
          "level_errors_db", [](const Bank& bank) { return list_of(bank, RINGDOWN_LEVEL_ERRORS_DB); },
          "M estimated errors of what the modes radiate [dB], or None.")
      .def_property_readonly("losses", &losses_of,
                             "A ringdown.Losses: the decays by cause, M numbers each [1/s]; None if not known.")
      .def_property_readonly("provenance", &provenance_of,
                             "How the bank was made: a dict with the keys of the file (bank-format.md).")
      .def_property_readonly(
          "has_residual", [](const Bank& bank) { return bank.info().has_residual != 0; },
          "True if the bank was opened with its residual: frf() then includes the modes that are not in the bank.")
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
      .def(
          "frf", &frf_of, py::arg("at_m"), py::arg("direction"), py::arg("to_m"), py::arg("to_direction"),
          py::arg("frequencies_hz"), py::arg("kind") = "receptance",
          "The motion at `to_m` along `to_direction` per newton at `at_m` along `direction`: complex numbers in the "
          "shape"
          " of `frequencies_hz`, with time as exp(+i omega t).\n\nkind: receptance [m/N], mobility [m/(N s)] or"
          " accelerance [1/kg]. Places are the nearest of the surface. The rigid motion of a free body is included, and"
          " if has_residual, so are the modes that are not in the bank.")
      .def("pressure_frf", &pressure_frf_of, py::arg("at_m"), py::arg("direction"), py::arg("to_m"),
           py::arg("frequencies_hz"),
           "The sound pressure at a point in the air, in the object's frame, per newton at `at_m` along `direction`"
           " [Pa/N]: a sum of the modes' far fields.")
      .def("energy_spectrum", &energy_spectrum_of, py::arg("at_m"), py::arg("direction"), py::arg("frequencies_hz"),
           "The energy that the object radiates per hertz after an impulse of 1 N s at `at_m` along `direction`"
           " [J/Hz/(N s)^2].")
      .def("to_bytes", &bytes_of, "The bank as the bytes of a bank file, for parse().")
      .def(
          "to_xarray", [](const py::object& self) { return table_of("to_xarray", self); },
          "The bank as an xarray.Dataset; needs xarray.")
      .def(
          "to_dataframe", [](const py::object& self) { return table_of("to_dataframe", self); },
          "The modes as a pandas.DataFrame, one row for each; needs pandas.")
      .def(
          "to_sofa",
          [](const py::object& self, const py::object& path, const py::object& at_m, const py::object& direction,
             const py::object& frequencies, double step_deg, double distance_m) {
            py::module_::import("ringdown.sofa")
                .attr("write")(self, path, at_m, direction, frequencies, step_deg, distance_m);
          },
          py::arg("path"), py::arg("at_m"), py::arg("direction"), py::arg("frequencies_hz"), py::arg("step_deg") = 5.0,
          py::arg("distance_m") = 0.0,
          "Writes the pressure per newton in all directions as a SOFA file (AES69, FreeFieldDirectivityTF); needs"
          " netCDF4.\n\ndistance_m: from the centre of mass; 0: ten times the largest distance of the surface.")
      .def(py::pickle([](const Bank& bank) { return py::make_tuple(bytes_of(bank), bank.info().name); },
                      [](const py::tuple& state) {
                        if (state.size() != 2) refuse("the pickle is not that of a bank");
                        return parse(state[0], state[1].cast<std::string>());
                      }))
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
