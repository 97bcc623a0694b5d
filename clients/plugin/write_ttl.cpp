// Lets the LV2 plug-in write its Turtle files into the present folder, and adds presets.ttl: write_ttl PLUGIN.so NAME.
// Used only by the build. DPF 1.6 could write presets, too, but mixes up their states.
#include "clients/plugin/parameters.h"
#include "clients/plugin/sources.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <ostream>
#include <set>
#include <string>
#include <string_view>

namespace {

using namespace ringdown::plugin;

constexpr const char* kPlugin = "urn:ringdown:instrument";

std::string preset(std::size_t number) {
  return "<" + std::string(kPlugin) + "#" + std::string(kPresets[number]) + ">";
}

// Families of presets are banks: "Cymbals and gongs" is bank_Cymbals_and_gongs.
std::string bank(std::string_view family) {
  std::string word(family);
  std::replace(word.begin(), word.end(), ' ', '_');
  return "<" + std::string(kPlugin) + "#bank_" + word + ">";
}

// Every preset names its object and the defaults of all other parameters that presets have.
void write_presets(std::ostream& manifest, std::ostream& file) {
  const std::string prefixes = "@prefix pset: <http://lv2plug.in/ns/ext/presets#> .\n";
  manifest << prefixes;
  file << prefixes << "@prefix lv2: <http://lv2plug.in/ns/lv2core#> .\n";
  std::set<std::string_view> families;
  for (std::size_t number = 0; number < kPresets.size(); ++number) {
    const std::string_view family = family_of(kPresets[number]);
    if (families.insert(family).second) {
      manifest << bank(family) << "\n    a pset:Bank ;\n    rdfs:label \"" << family << "\" .\n";
    }
    manifest << preset(number) << "\n    a pset:Preset ;\n    lv2:appliesTo <" << kPlugin << "> ;\n    pset:bank "
             << bank(family) << " ;\n    rdfs:label \"" << kPresets[number]
             << "\" ;\n    rdfs:seeAlso <presets.ttl> .\n";
    file << preset(number) << "\n    lv2:port ";
    const char* separator = "";
    for (std::size_t i = 0; i < kParameters; ++i) {
      if (!is_of_preset(i)) continue;
      const float value = i == static_cast<std::size_t>(Parameter::object) ? static_cast<float>(kFirstPreset + number)
                                                                           : kParameterInfo[i].standard;
      file << separator << "[ lv2:symbol \"" << kParameterInfo[i].symbol << "\" ; pset:value " << value << " ]";
      separator = " ,\n        ";
    }
    file << " .\n";
  }
}

// Removes two properties of a vendor's hosts that no vocabulary in Debian defines, so that validators accept the file.
// Lets hosts show three significant digits, and keys by their names.
void tidy(const std::string& path) {
  std::ifstream before(path);
  std::string text;
  for (std::string line; std::getline(before, line);) {
    if (line.find(" mod:brand ") != line.npos || line.find(" mod:label ") != line.npos) continue;
    if (const auto at = line.find("unit:render \"%f "); at != line.npos) line.replace(at + 13, 2, "%.3g");
    text += line + "\n";
    if (line.find("lv2:symbol \"root_key\"") != line.npos) text += "        unit:unit unit:midiNote ;\n";
  }
  std::ofstream(path) << text;
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::fprintf(stderr, "usage: write_ttl PLUGIN.so NAME\n");
    return 1;
  }
  void* const plugin = dlopen(words[1], RTLD_NOW);
  if (!plugin) {
    std::fprintf(stderr, "%s\n", dlerror());
    return 1;
  }
  using Generate = void (*)(const char*);
  const auto generate = reinterpret_cast<Generate>(dlsym(plugin, "lv2_generate_ttl"));
  if (!generate) {
    std::fprintf(stderr, "%s is not a plug-in of DPF\n", words[1]);
    return 1;
  }
  generate(words[2]);
  tidy(std::string(words[2]) + ".ttl");
  std::ofstream manifest("manifest.ttl", std::ios::app), file("presets.ttl");
  write_presets(manifest, file);
  if (manifest.flush() && file.flush()) return 0;
  std::fprintf(stderr, "cannot write manifest.ttl and presets.ttl\n");
  return 1;
}
