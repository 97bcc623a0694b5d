#include "server/session/sample_set.h"

#include "engine/base/atomic_file.h"
#include "engine/base/note.h"
#include "engine/base/version.h"
#include "engine/modal/hearing/pitch.h"
#include "server/session/rack.h"
#include "server/session/sound_file.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

namespace ringdown::session {
namespace {

constexpr double kBlow_ns = 0.05;
constexpr double kPeak = 0.7;       // peak of the loudest sample, full scale 1: -3 dB
constexpr double kSilence_db = 80;  // level below its own peak at which a sample ends
constexpr double kFade_s = 0.03, kPeakWithin_s = 0.3;
constexpr std::size_t kBlock = 256;

// One place of the surface, and the blow that rings the object there.
struct Place {
  Vec3 point_m, normal;  // outward, length 1
};

struct Blow {
  double size = 1;
  Vec3 point_m, impulse_ns;  // of the object in its own size
  double contact_time_s = 0;
};

struct Zone {
  int low, high, center;
  double size;
};

tl::unexpected<Error> stopped() { return fail(ErrorKind::cancelled, "cancelled; nothing was written"); }

Vec3 to_vector(const modal::Vec3f& v) { return {v[0], v[1], v[2]}; }

// Surface normals at the points of a bank, by the triangles around them.
std::vector<Vec3> normals_of(const modal::Bank& bank) {
  std::vector<Vec3> normals(bank.point_count());
  for (const auto& [a, b, c] : bank.triangles) {
    const Vec3 corner = to_vector(bank.positions[a]);
    const Vec3 area = cross(to_vector(bank.positions[b]) - corner, to_vector(bank.positions[c]) - corner);
    for (const std::uint32_t point : {a, b, c}) normals[point] = normals[point] + area;
  }
  for (Vec3& normal : normals) normal = length(normal) > 0 ? (1 / length(normal)) * normal : Vec3{0, 0, 1};
  return normals;
}

class Maker {
 public:
  Maker(const SampleSetOptions& options, BankFile bank, const Progress& progress)
      : options_(options), bank_(std::move(bank)), progress_(progress), normals_(normals_of(bank_.map->bank())) {}

  Result<SampleSet> make(const std::filesystem::path& folder) {
    find_places();
    find_pitch();
    for (const Zone& zone : zones()) {
      if (zone.size >= 0.01 && zone.size <= 100) continue;
      return fail(ErrorKind::bad_input,
                  "the object would have to be {:f} times as large for key {}; choose keys nearer to {}", zone.size,
                  zone.center, set_.key);
    }
    if (auto peak = find_peak(); !peak) return fail(peak);
    const std::string name = options_.folder.filename().string();
    std::error_code error;
    std::filesystem::create_directories(folder / "samples", error);
    if (error) return fail(ErrorKind::input_output, folder.string() + ": " + error.message());
    std::ostringstream sfz;
    sfz << header();
    for (std::size_t place = 0; place < places_.size(); ++place) {
      for (const Zone& zone : zones()) {
        if (auto done = write_zone(folder, place, zone, sfz); !done) return fail(done);
      }
    }
    set_.sfz = options_.folder / (name + ".sfz");
    if (auto written = write_file_atomically(folder / (name + ".sfz"), sfz.str()); !written) return fail(written);
    return set_;
  }

 private:
  [[nodiscard]] const modal::Bank& bank() const { return bank_.map->bank(); }

  // Returns the loudness of each mode after a blow of 1 N s at the place: Pa at 1 m.
  [[nodiscard]] std::vector<double> levels_at(const Place& place) const {
    std::vector<double> amplitudes(bank().mode_count());
    bank_.map->excite(place.point_m, place.normal, amplitudes);
    for (std::size_t m = 0; m < amplitudes.size(); ++m) {
      amplitudes[m] =
          std::abs(amplitudes[m]) * bank_.map->loudness().pressure_pa(bank(), m, {}, bank().frequency_hz[m]);
    }
    return amplitudes;
  }

  [[nodiscard]] Place place_near(const Vec3& point_m) const {
    const modal::SurfacePoint found = bank_.map->surface().nearest(point_m);
    Place place{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      place.point_m = place.point_m + found.weights[corner] * to_vector(bank().positions[found.points[corner]]);
      place.normal = place.normal + found.weights[corner] * normals_[found.points[corner]];
    }
    const double size = length(place.normal);
    place.normal = size > 0 ? (1 / size) * place.normal : Vec3{0, 0, 1};
    return place;
  }

  void find_places() {
    for (const Vec3& point_m : options_.places_m) places_.push_back(place_near(point_m));
    if (!places_.empty()) return;
    double loudest = -1;
    for (std::size_t p = 0; p < bank().point_count(); ++p) {
      const Place place{to_vector(bank().positions[p]), normals_[p]};
      double power = 0;
      for (const double level : levels_at(place)) power += level * level;
      if (power <= loudest) continue;
      loudest = power;
      places_ = {place};
    }
  }

  void find_pitch() {
    if (options_.pitch) {
      set_.key = *options_.pitch;
      set_.pitch_hz = note_frequency(set_.key);
      return;
    }
    const modal::Pitch pitch = modal::pitch_of(bank());
    set_.pitch_hz = pitch.tone_hz;
    set_.no_pitch = pitch.reason;
    set_.key = std::clamp(static_cast<int>(std::lround(note_of(set_.pitch_hz))), 0, kKeys - 1);
  }

  [[nodiscard]] std::vector<Zone> zones() const {
    if (!options_.keys) return {{0, kKeys - 1, set_.key, 1}};
    std::vector<Zone> zones;
    for (int low = options_.keys->low; low <= options_.keys->high; low += options_.step) {
      const int high = std::min(low + options_.step - 1, options_.keys->high), center = (low + high) / 2;
      zones.push_back({low, high, center, set_.pitch_hz / note_frequency(center)});
    }
    return zones;
  }

  // Velocities from low to high, both included, of a layer.
  [[nodiscard]] std::pair<int, int> velocities_of(int layer) const {
    const auto edge = [&](int n) { return 1 + 127 * n / options_.velocities; };
    return {edge(layer), edge(layer + 1) - 1};
  }

  // The n-th of the strikes that take turns: the place itself, then points around it.
  [[nodiscard]] Blow blow_of(const Place& place, int turn, int layer, double size) const {
    const Vec3 aside = std::abs(place.normal.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 u = (1 / length(cross(place.normal, aside))) * cross(place.normal, aside), v = cross(place.normal, u);
    const double angle = std::numbers::pi * (3 - std::sqrt(5.0)) * turn;
    const double away = options_.scatter * bank_.map->surface().size_m() *
                        std::sqrt(static_cast<double>(turn) / std::max(options_.strikes - 1, 1));
    const Place struck =
        turn == 0 ? place : place_near(place.point_m + away * (std::cos(angle) * u + std::sin(angle) * v));
    const auto [low, high] = velocities_of(layer);
    const double impulse_share = std::pow((low + high) / 254.0, 2);
    // Pressure goes as impulse / size^2: all sizes are equally loud.
    return {size, struck.point_m, -kBlow_ns * size * size * place.normal,
            options_.contact_time_s * size * std::pow(impulse_share, -0.2)};
  }

  // Renders a sample, without its end mark, until all modes are kSilence_db below their beginning, or for `seconds`.
  Result<std::vector<float>> render(const Blow& blow, double seconds) {
    const FileRoots roots;
    BankReader reader(roots);
    Rack rack(options_.sample_rate_hz, reader);
    const auto object = rack.add("object", options_.bank, bank_);
    if (!object) return fail(object);
    if (blow.size != 1) {
      if (auto resized = rack.set_material({.name = "object"}, {.size = blow.size}); !resized) return fail(resized);
    }
    static_cast<void>(
        rack.push(synth::Producer::control, {.object = *object,
                                             .verb = synth::verb::Strike{.point_m = blow.size * blow.point_m,
                                                                         .impulse_ns = blow.impulse_ns,
                                                                         .contact_time_s = blow.contact_time_s}}));
    std::vector<float> left, right(kBlock);
    const auto max = static_cast<std::size_t>(seconds * options_.sample_rate_hz);
    float peak = 0;
    std::size_t loud_until = 0;
    const auto quiet = static_cast<std::size_t>(0.2 * options_.sample_rate_hz);
    while (left.size() < max && (left.size() < loud_until + quiet || loud_until == 0)) {
      const std::size_t begin = left.size();
      left.resize(begin + kBlock);
      rack.mixer().render(synth::Outputs(left.data() + begin, right.data()), kBlock);
      for (std::size_t i = begin; i < left.size(); ++i) peak = std::max(peak, std::abs(left[i]));
      const auto limit = static_cast<float>(peak * std::pow(10, -kSilence_db / 20));
      for (std::size_t i = begin; i < left.size(); ++i) {
        if (std::abs(left[i]) > limit) loud_until = i + 1;
      }
    }
    left.resize(std::min({left.size(), max, loud_until + quiet}));
    const auto fade = std::min(static_cast<std::size_t>(kFade_s * options_.sample_rate_hz), left.size());
    for (std::size_t i = 0; i < fade; ++i)
      left[left.size() - 1 - i] *= static_cast<float>(i) / static_cast<float>(fade);
    return left;
  }

  Result<void> find_peak() {
    for (const Place& place : places_) {
      for (const Zone& zone : zones()) {
        for (int layer = 0; layer < options_.velocities; ++layer) {
          for (int turn = 0; turn < options_.strikes; ++turn) {
            const auto sample = render(blow_of(place, turn, layer, zone.size), kPeakWithin_s);
            if (!sample) return fail(sample);
            if (!progress_(0)) return stopped();
            for (const float s : *sample) peak_ = std::max(peak_, std::abs(static_cast<double>(s)));
          }
        }
      }
    }
    if (peak_ > 0) return {};
    return fail(ErrorKind::refused,
                options_.bank.string() + " is silent where it is struck; choose another place with --at");
  }

  [[nodiscard]] std::string header() const {
    std::ostringstream text;
    text << "// " << (bank().name.empty() ? options_.bank.filename().string() : bank().name)
         << ", rendered from its vibration modes by Ringdown " << kVersion << "\n"
         << "// " << (set_.no_pitch.empty() ? "Its own pitch is " : "It has no definite pitch; its key is chosen for ")
         << set_.pitch_hz << " Hz. A layer of velocities is a contact time; loudness is the\n"
         << "// player's (velocity / 127)^2; a repeated key strikes another "
            "point.\n\n<control>\ndefault_path=samples/\n\n"
         << "<global>\namp_veltrack=100\n";
    if (options_.release_s) {
      text << "loop_mode=no_loop\nampeg_release=" << *options_.release_s << "\n";
    } else {
      text << "loop_mode=one_shot\n";
    }
    if (places_.size() > 1) text << "sw_lokey=0\nsw_hikey=" << places_.size() - 1 << "\nsw_default=0\n";
    return text.str();
  }

  Result<void> write_zone(const std::filesystem::path& folder, std::size_t place, const Zone& zone,
                          std::ostringstream& sfz) {
    sfz << "\n<group>\nlokey=" << zone.low << "\nhikey=" << zone.high << "\npitch_keycenter=" << zone.center << "\n";
    if (places_.size() > 1) sfz << "sw_last=" << place << "\n";
    for (int layer = 0; layer < options_.velocities; ++layer) {
      const auto [low, high] = velocities_of(layer);
      for (int turn = 0; turn < options_.strikes; ++turn) {
        const std::string file =
            formatted("p{}-k{}-v{}-{}{}", place, zone.center, high, turn + 1, options_.flac ? ".flac" : ".wav");
        auto sample = render(blow_of(places_[place], turn, layer, zone.size), options_.max_s);
        if (!sample) return fail(sample);
        for (float& s : *sample) s *= static_cast<float>(kPeak / peak_);
        auto sound = SoundFile::create({folder / "samples" / file}, options_.sample_rate_hz, {.channels = 1});
        if (!sound) return fail(sound);
        if (auto written = sound->write(*sample); !written) return written;
        if (auto finished = sound->finish(); !finished) return finished;
        sfz << "<region> sample=" << file << " lovel=" << low << " hivel=" << high;
        if (options_.strikes > 1) sfz << " seq_length=" << options_.strikes << " seq_position=" << turn + 1;
        sfz << "\n";
        ++set_.samples;
        set_.seconds += static_cast<double>(sample->size()) / options_.sample_rate_hz;
        const std::size_t all = places_.size() * zones().size() * static_cast<std::size_t>(options_.velocities) *
                                static_cast<std::size_t>(options_.strikes);
        if (!progress_(static_cast<double>(set_.samples) / static_cast<double>(all))) return stopped();
      }
    }
    return {};
  }

  const SampleSetOptions& options_;
  BankFile bank_;
  const Progress& progress_;
  std::vector<Vec3> normals_;
  std::vector<Place> places_;
  double peak_ = 0;
  SampleSet set_;
};

}  // namespace

Result<SampleSet> write_sample_set(const SampleSetOptions& options, const Progress& progress) {
  std::error_code error;
  if (std::filesystem::exists(options.folder, error)) {
    return fail(ErrorKind::bad_input, options.folder.string() + " exists already; name another folder, or remove it");
  }
  const FileRoots roots;
  auto bank = BankReader(roots).read(options.bank);
  if (!bank) return fail(bank);
  std::filesystem::path partial = options.folder;
  partial += ".partial";
  std::filesystem::remove_all(partial, error);
  auto made = Maker(options, *std::move(bank), progress).make(partial);
  if (made) {
    std::filesystem::rename(partial, options.folder, error);
    if (!error) return made;
    made = fail(ErrorKind::input_output, options.folder.string() + ": " + error.message());
  }
  std::filesystem::remove_all(partial, error);
  return made;
}

}  // namespace ringdown::session
