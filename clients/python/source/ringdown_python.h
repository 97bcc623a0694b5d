// Shared by the extension modules ringdown._core and ringdown._scene: failures become Python exceptions, and
// Python's paths and triples of numbers become C's. Needs nothing of Ringdown but its C headers, so that `pip install`
// can build the modules with an installed libringdown.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <ringdown.h>

#include <array>
#include <string>

namespace ringdown::python {

namespace py = pybind11;

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>;

// Raises ringdown.Error with the library's sentence.
[[noreturn]] inline void raise(ringdown_result result, const std::string& sentence) {
  static constexpr const char* kKinds[] = {"ok", "bad_input", "too_large", "refused", "no_memory", "input_output"};
  const py::object type = py::module_::import("ringdown.errors").attr("Error");
  PyErr_SetObject(type.ptr(), type(sentence, kKinds[result]).ptr());
  throw py::error_already_set();
}

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
  if (text.find('\0') != text.npos) throw py::value_error("a name or path contains the character 0");
  return text.c_str();
}

// A str, bytes or os.PathLike as the file system's bytes.
inline std::string path_of(const py::handle& path) {
  return py::module_::import("os").attr("fsencode")(path).cast<std::string>();
}

// The capsule in which ringdown._core hands a mixer to ringdown._scene.
inline constexpr const char* kMixerCapsule = "ringdown_mixer";

}  // namespace ringdown::python
