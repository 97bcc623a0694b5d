// Small hosts of the three plug-in formats, as much as a test needs of each. All of them load the built plug-in from
// its file, as a program for musicians does.
//
//   auto host = open_clap();
//   host->activate(48000);
//   host->set_parameter(0, 9);                     // counts from the next block on
//   host->render({{.frame = 17, .bytes = {0x90, 60, 100}}}, left, right, 256);
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::test {

struct MidiEvent {
  std::uint32_t frame = 0;  // of the block
  std::array<std::uint8_t, 3> bytes{};
  std::vector<std::uint8_t> exclusive = {};  // a system exclusive message, in place of `bytes`
};

class PluginHost {
 public:
  virtual ~PluginHost() = default;
  virtual void activate(double sample_rate_hz) = 0;
  virtual void deactivate() = 0;
  virtual void set_parameter(std::size_t number, double value) = 0;
  virtual double parameter(std::size_t number) = 0;
  virtual std::size_t parameters() = 0;
  virtual void render(const std::vector<MidiEvent>& events, float* left, float* right, std::uint32_t frames) = 0;
  virtual std::string save() = 0;
  virtual bool load(const std::string& state) = 0;

  // Opens the plug-in's window in one of X11; then calls what a host's timer calls, and brings the window what render()
  // has left for it; then closes it. Returns false if the plug-in has none.
  virtual bool open_window(unsigned long parent) = 0;
  virtual void idle_window() = 0;
  virtual void close_window() = 0;
};

constexpr std::uint32_t kMaxBlock = 4096;

std::unique_ptr<PluginHost> open_clap();
std::unique_ptr<PluginHost> open_lv2();
std::unique_ptr<PluginHost> open_vst3();

// Events that only CLAP has, for a host of open_clap(): a note expression, by its number in the format, and modulation.
void express(PluginHost& host, int expression, int key, double value);
void modulate(PluginHost& host, std::size_t number, double amount);

// A note expression for a host of open_vst3(), which gives every key's note a number of its own.
void express_vst3(PluginHost& host, int expression, int key, double value);

// A shared library that stays open until the program ends, as in hosts; throws std::runtime_error if it does not open.
class Module {
 public:
  explicit Module(const std::string& path);
  [[nodiscard]] void* symbol(const char* name) const;

 private:
  void* handle_;
};

}  // namespace ringdown::test
