// The requests of the window, which reach the plug-in through its host. [UI]
#pragma once

#include "clients/plugin/strike_point.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace ringdown::plugin {

class HostLink {
 public:
  virtual ~HostLink() = default;
  // A host records automation between the first and the last call of an edit.
  virtual void begin_edit(std::size_t parameter) = 0;
  virtual void set_parameter(std::size_t parameter, float value) = 0;
  virtual void end_edit(std::size_t parameter) = 0;
  virtual void set_point(Which which, const std::string& text) = 0;
  virtual void set_file(const std::string& path) = 0;
  virtual void press_key(std::uint8_t key, std::uint8_t velocity) = 0;
  virtual void release_key(std::uint8_t key) = 0;
  virtual void browse_files() = 0;           // the window's edits get the answer
  virtual void set_scale(double scale) = 0;  // of text and controls; the window grows or shrinks with it
};

}  // namespace ringdown::plugin
