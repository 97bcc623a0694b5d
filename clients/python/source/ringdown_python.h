// Shared by the extension modules ringdown._core and ringdown._scene: failures become Python exceptions, and
// Python's paths, whole numbers and triples of numbers become C's. Values that cannot be meant raise
// ringdown.InputError, which is a ValueError too; arguments of a wrong type raise TypeError, as pybind11 does. Needs
// nothing of Ringdown but its C headers, so that `pip install` can build the modules with an installed libringdown.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <ringdown.h>

#include <array>
#include <cstddef>
#include <limits>
#include <string>

namespace ringdown::python {

namespace py = pybind11;

// Any sequence of so many numbers.
template <std::size_t size>
struct Numbers : std::array<double, size> {};
using Vector = Numbers<3>;
using Quaternion = Numbers<4>;

// A whole number of Python, which has any size, in the range of a type of C's.
template <class Integer>
struct Whole {
  Integer value = 0;
  operator Integer() const { return value; }
};

// Raises ringdown.Error with the library's sentence, or its subclass InputError.
[[noreturn]] inline void raise(ringdown_result result, const std::string& sentence) {
  static constexpr const char* kKinds[] = {"ok", "bad_input", "too_large", "refused", "no_memory", "input_output"};
  const py::object type =
      py::module_::import("ringdown.errors").attr(result == RINGDOWN_BAD_INPUT ? "InputError" : "Error");
  PyErr_SetObject(type.ptr(), type(sentence, kKinds[result]).ptr());
  throw py::error_already_set();
}

// Raises ringdown.InputError.
[[noreturn]] inline void refuse(const std::string& sentence) { raise(RINGDOWN_BAD_INPUT, sentence); }

// Calls a function of the library, whose last parameter is the error.
template <class Function, class... Arguments>
void call(Function function, Arguments... arguments) {
  ringdown_error error;
  const ringdown_result result = function(arguments..., &error);
  if (result != RINGDOWN_OK) raise(result, error.sentence);
}

// Calls a function that takes long, reads files or waits, while other threads of Python go on.
template <class Function, class... Arguments>
void call_without_lock(Function function, Arguments... arguments) {
  ringdown_error error;
  ringdown_result result = RINGDOWN_OK;
  {
    const py::gil_scoped_release released;
    result = function(arguments..., &error);
  }
  if (result != RINGDOWN_OK) raise(result, error.sentence);
}

// A text as C has it, which ends at its first 0.
inline const char* c_string(const std::string& text) {
  if (text.find('\0') != text.npos) refuse("a name or path contains the character 0");
  return text.c_str();
}

// A str, bytes or os.PathLike as the file system's bytes.
inline std::string path_of(const py::handle& path) {
  return py::module_::import("os").attr("fsencode")(path).cast<std::string>();
}

// A ringdown.Piece.
inline py::object piece_of(const ringdown_piece_info& info) {
  const auto triple = [](const double* v) { return py::make_tuple(v[0], v[1], v[2]); };
  const double* turned = info.axes_wxyz;
  return py::module_::import("ringdown.values")
      .attr("Piece")(info.object == RINGDOWN_NO_OBJECT ? py::object(py::none()) : py::int_(info.object), info.mass_kg,
                     triple(info.center_of_mass_m), triple(info.inertia_kg_m2),
                     py::make_tuple(turned[0], turned[1], turned[2], turned[3]), triple(info.velocity_m_s),
                     triple(info.spin_rad_s));
}

// The capsule in which ringdown._core hands a mixer to ringdown._scene.
inline constexpr const char* kMixerCapsule = "ringdown_mixer";

}  // namespace ringdown::python

namespace pybind11::detail {

template <class Integer>
struct type_caster<ringdown::python::Whole<Integer>> {
  PYBIND11_TYPE_CASTER(ringdown::python::Whole<Integer>, const_name("int"));

  bool load(handle source, bool /*convert*/) {
    if (!PyIndex_Check(source.ptr())) return false;
    const auto index = reinterpret_steal<object>(PyNumber_Index(source.ptr()));
    if (!index) return PyErr_Clear(), false;
    int overflow = 0;
    const long long number = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
    constexpr long long kMin = std::numeric_limits<Integer>::min(), kMax = std::numeric_limits<Integer>::max();
    if (overflow != 0 || number < kMin || number > kMax) {
      ringdown::python::refuse(str(index).cast<std::string>() + " is not a whole number from " + std::to_string(kMin) +
                               " to " + std::to_string(kMax));
    }
    value.value = static_cast<Integer>(number);
    return true;
  }
};

template <std::size_t size>
struct type_caster<ringdown::python::Numbers<size>> {
  PYBIND11_TYPE_CASTER(ringdown::python::Numbers<size>, const_name("Sequence[float]"));

  bool load(handle source, bool convert) {
    if (!PySequence_Check(source.ptr()) || isinstance<str>(source) || isinstance<bytes>(source)) return false;
    const Py_ssize_t length = PySequence_Size(source.ptr());
    if (length < 0) return PyErr_Clear(), false;
    if (length != static_cast<Py_ssize_t>(size)) {
      ringdown::python::refuse("there are " + std::to_string(length) + " numbers where " + std::to_string(size) +
                               " are needed");
    }
    for (std::size_t i = 0; i < size; ++i) {
      const auto item = reinterpret_steal<object>(PySequence_GetItem(source.ptr(), static_cast<Py_ssize_t>(i)));
      if (!item) return PyErr_Clear(), false;
      make_caster<double> number;
      if (!number.load(item, convert)) return false;
      value[i] = cast_op<double>(number);
    }
    return true;
  }

  // Makes Python's object of a default value, which the help shows.
  static handle cast(const ringdown::python::Numbers<size>& numbers, return_value_policy, handle) {
    tuple all(size);
    for (std::size_t i = 0; i < size; ++i) all[i] = float_(numbers[i]);
    return all.release();
  }
};

}  // namespace pybind11::detail
