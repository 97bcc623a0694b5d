// Where the compiler is told to believe that a call is fit for the audio thread (engine/base/realtime.h). A new place
// belongs into this list, with its reason above it in the source.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const std::map<std::string, int> kTrusted = {
    {"engine/synth/objects/time_budget.cpp", 1},  // reads the clock: the kernel's page, no system call
    {"engine/synth/worker_pool.cpp", 1},          // runs what its constructor was given and promised
    {"engine/synth/kernels/drive_kernel-inl.h",
     1},  // Highway's choice of an instruction set, a table of functions; so the next
    {"engine/synth/kernels/coupled_kernel-inl.h", 1},
    {"engine/synth/kernels/direction_kernel-inl.h", 1},
    {"engine/synth/kernels/field_sums-inl.h", 1},
    {"engine/synth/kernels/glide_kernel-inl.h", 1},
    {"engine/synth/kernels/heard_moments-inl.h", 1},
    {"engine/synth/kernels/mix_kernel-inl.h", 1},
    {"engine/synth/kernels/mode_kernel-inl.h", 1},
    {"engine/synth/kernels/moment_synthesis-inl.h", 1},
    {"engine/synth/kernels/moments-inl.h", 1},
    {"engine/synth/kernels/pulse_kernel-inl.h", 1},
    {"clients/plugin/bows.cpp", 1},  // libringdown's functions for the audio thread, which are C; so the next three
    {"clients/plugin/instrument.cpp", 1},
    {"clients/plugin/keyboard.cpp", 1},
    {"clients/plugin/mallets.cpp", 1},
    {"clients/plugin/vst3_notes.cpp", 1},  // a variable of the thread, which the entry has set
    {"server/jack_client.cpp", 1},         // JACK's functions for the process callback
    {"server/load_meter.cpp", 1},          // reads the clock
};

// How often each source file has one of these words outside comments.
std::map<std::string, int> uses_of(const std::vector<std::string>& words) {
  const fs::path root = RINGDOWN_SOURCE_DIR;
  std::map<std::string, int> uses;
  for (const char* folder : {"engine", "protocol", "server", "clients"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);) {
        const std::string code = line.substr(0, line.find("//"));
        for (const std::string& word : words) {
          if (code.find(word) != code.npos) ++uses[fs::relative(entry.path(), root).generic_string()];
        }
      }
    }
  }
  return uses;
}

TEST(RealTime, WhatTheRealTimeChecksTrustIsListed) {
  std::map<std::string, int> uses = uses_of({"TRUST_REALTIME_BEGIN"});
  EXPECT_EQ(uses.erase("engine/base/realtime.h"), 1u) << "where it is defined";
  EXPECT_EQ(uses, kTrusted);
}

TEST(RealTime, NothingElseSilencesTheRealTimeChecks) {
  std::map<std::string, int> uses =
      uses_of({"diagnostic ignored", "no_sanitize", "rtsan", "__tsan", "disable_sanitizer_instrumentation"});
  EXPECT_EQ(uses.erase("engine/base/realtime.h"), 1u) << "where trust is defined";
  EXPECT_EQ(uses, (std::map<std::string, int>{}));
}

}  // namespace
