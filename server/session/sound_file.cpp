#include "server/session/sound_file.h"

#include <sndfile.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

namespace ringdown::session {
namespace {

tl::unexpected<Error> cannot_write(const std::filesystem::path& path, const std::string& why) {
  return fail(ErrorKind::input_output, "cannot write " + path.string() + ": " + why);
}

}  // namespace

struct SoundFile::Open {
  std::filesystem::path path, temporary;
  SNDFILE* file = nullptr;

  ~Open() {
    if (file) sf_close(file);
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
  }
};

SoundFile::SoundFile(std::unique_ptr<Open> open) : open_(std::move(open)) {}
SoundFile::SoundFile(SoundFile&&) noexcept = default;
SoundFile& SoundFile::operator=(SoundFile&&) noexcept = default;
SoundFile::~SoundFile() = default;

Result<SoundFile> SoundFile::create(const std::filesystem::path& path, double sample_rate_hz) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (ending != ".wav" && ending != ".flac") {
    return cannot_write(path, "its name must end in .wav or .flac, which says the format");
  }
  SF_INFO info{.samplerate = static_cast<int>(sample_rate_hz),
               .channels = 2,
               .format = ending == ".flac" ? SF_FORMAT_FLAC | SF_FORMAT_PCM_24 : SF_FORMAT_WAV | SF_FORMAT_FLOAT};
  auto open = std::make_unique<Open>();
  open->path = path;
  open->temporary = path.string() + "." + std::to_string(::getpid()) + ".part";
  open->file = sf_open(open->temporary.c_str(), SFM_WRITE, &info);
  if (!open->file) return cannot_write(path, sf_strerror(nullptr));
  sf_command(open->file, SFC_SET_CLIPPING, nullptr, SF_TRUE);
  // The chunk would contain the time of day, so no two files would be equal.
  sf_command(open->file, SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
  return SoundFile(std::move(open));
}

Result<void> SoundFile::write(std::span<const float> samples) {
  const auto frames = static_cast<sf_count_t>(samples.size() / 2);
  if (sf_writef_float(open_->file, samples.data(), frames) == frames) return {};
  return cannot_write(open_->path, "the disk may be full");
}

Result<void> SoundFile::finish() {
  if (sf_close(std::exchange(open_->file, nullptr)) != 0) return cannot_write(open_->path, "the disk may be full");
  std::error_code error;
  std::filesystem::rename(open_->temporary, open_->path, error);
  if (error) return cannot_write(open_->path, error.message());
  return {};
}

}  // namespace ringdown::session
