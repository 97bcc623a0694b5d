#include "clients/viewer/settings.h"

#include "engine/base/output_file.h"
#include "engine/base/quote.h"
#include "engine/base/toml_table.h"

#include <cstdlib>

namespace ringdown::viewer {
namespace {

constexpr Range kScale{0, 8}, kShare{0.05, 0.6}, kImpulse{1e-6, 100}, kContactTime{0, 0.1};

// TOML needs a decimal point in a float; %g may leave it out.
std::string number(double value) { return formatted("{:.6f}", value); }

}  // namespace

Result<std::filesystem::path> settings_file() {
  const char* config = std::getenv("XDG_CONFIG_HOME");
  if (config && *config) return std::filesystem::path(config) / "ringdown" / "viewer.toml";
  const char* home = std::getenv("HOME");
  if (!home || !*home)
    return fail(ErrorKind::input_output, "there is no home folder to keep settings in: HOME is not set");
  return std::filesystem::path(home) / ".config" / "ringdown" / "viewer.toml";
}

Result<Settings> read_settings(const std::filesystem::path& file) {
  Settings settings;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return settings;
  auto table = TomlTable::read(file);
  if (!table) return fail(table);
  if (table->has("daemon")) table->text("daemon", settings.daemon);
  table->boolean("dark", settings.dark);
  table->number("scale", settings.scale, kScale);
  table->whole("width", settings.width, Settings::kMinWidth, Settings::kMaxPixels);
  table->whole("height", settings.height, Settings::kMinHeight, Settings::kMaxPixels);
  table->number("side_share", settings.side_share, kShare);
  table->number("sound_share", settings.sound_share, kShare);
  table->number("impulse_ns", settings.impulse_ns, kImpulse);
  table->number("contact_time_s", settings.contact_time_s, kContactTime);
  table->boolean("listen", settings.listen);
  table->boolean("strength_by_time", settings.strength_by_time);
  if (auto good = table->finish(); !good) return fail(good);
  return settings;
}

Result<void> write_settings(const Settings& settings, const std::filesystem::path& file) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  if (error) return fail(ErrorKind::input_output, file.parent_path().string() + ": " + error.message());
  const auto flag = [](bool on) { return std::string(on ? "true" : "false"); };
  std::string text;
  const auto line = [&text](const std::string& key, const std::string& value) { text += key + " = " + value + "\n"; };
  if (!settings.daemon.empty()) line("daemon", toml_string(settings.daemon));
  line("dark", flag(settings.dark));
  line("scale", number(settings.scale));
  line("width", std::to_string(settings.width));
  line("height", std::to_string(settings.height));
  line("side_share", number(settings.side_share));
  line("sound_share", number(settings.sound_share));
  line("impulse_ns", number(settings.impulse_ns));
  line("contact_time_s", number(settings.contact_time_s));
  line("listen", flag(settings.listen));
  line("strength_by_time", flag(settings.strength_by_time));
  return write_output(file, text);
}

}  // namespace ringdown::viewer
