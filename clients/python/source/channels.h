// Sound in numpy arrays as the library wants it. [under Python's lock, but write_back()]
#pragma once

#include <ringdown_python.h>

#include <pybind11/numpy.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace ringdown::python {

// Channels that the library reads or writes one after the other, on behalf of an array of frames x channels. Where the
// array's columns are contiguous they are used as they are; otherwise write_back() copies what was rendered.
class Channels {
 public:
  Channels(const py::array& array, const char* name, py::ssize_t frames, std::size_t channels)
      : frames_(frames), count_(channels) {
    if (!py::isinstance<py::array_t<float>>(array) || array.ndim() != 2 || array.shape(0) != frames ||
        array.shape(1) != static_cast<py::ssize_t>(channels)) {
      refuse(std::string(name) + " must be an array of frames x " + std::to_string(channels) +
             " numbers of type float32");
    }
    if (!array.writeable()) refuse(std::string(name) + " cannot be written to");
    bytes_ = static_cast<char*>(const_cast<void*>(array.data()));
    stride_ = array.strides(0);
    channel_stride_ = array.strides(1);
    const bool is_aligned = reinterpret_cast<std::uintptr_t>(bytes_) % alignof(float) == 0 &&
                            channel_stride_ % static_cast<py::ssize_t>(alignof(float)) == 0;
    is_direct_ = stride_ == static_cast<py::ssize_t>(sizeof(float)) && is_aligned;
    if (!is_direct_) copy_.resize(static_cast<std::size_t>(frames) * channels);
  }

  float* channel(std::size_t number) {
    if (!is_direct_) return copy_.data() + number * static_cast<std::size_t>(frames_);
    return reinterpret_cast<float*>(bytes_ + static_cast<py::ssize_t>(number) * channel_stride_);
  }

  void write_back() const {
    if (is_direct_) return;
    const float* from = copy_.data();
    for (std::size_t c = 0; c < count_; ++c) {
      char* to = bytes_ + static_cast<py::ssize_t>(c) * channel_stride_;
      for (py::ssize_t n = 0; n < frames_; ++n) std::memcpy(to + n * stride_, from++, sizeof(float));
    }
  }

 private:
  py::ssize_t frames_;
  std::size_t count_;
  char* bytes_ = nullptr;
  py::ssize_t stride_ = 0, channel_stride_ = 0;
  bool is_direct_ = false;
  std::vector<float> copy_;
};

}  // namespace ringdown::python
