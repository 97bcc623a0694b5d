#include "server/describe.h"

#include "engine/modal/bank_file.h"
#include "engine/modal/fracture/strength.h"
#include "server/browse.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

namespace ringdown::server {
namespace {

using Answer = Result<std::vector<protocol::Reply>>;

template <class Number>
std::int32_t whole(Number number) {
  return static_cast<std::int32_t>(number);
}

Answer describe(const protocol::DescribeObject& question, const session::Session& session) {
  const auto found = session.rack().find(question.object);
  if (!found) return fail(found);
  const session::ObjectState& object = **found;
  const std::size_t modes = object.map->bank().mode_count();
  return std::vector<protocol::Reply>{protocol::ObjectReply{
      .number = whole(object.number),
      .name = object.name,
      .version = object.bank_version,
      .bank_bytes = whole(object.bank_bytes),
      .bank_content = object.bank_content.text(),
      .bank = object.bank.string(),
      .modes = whole(modes),
      .first_mode = whole(object.modes.first),
      .selected_modes =
          whole(std::min<std::size_t>(object.modes.count, modes - std::min<std::size_t>(object.modes.first, modes))),
      .scale = object.material,
      .gain = object.gain,
      .pan = object.pan,
      .mute = object.mute,
      .solo = object.solo,
      .level_m = present_level_m(object),
      .group = object.group.empty() ? std::nullopt : std::optional(object.group),
  }};
}

Answer read(const protocol::ReadBank& question, const session::Session& session) {
  const auto found = session.rack().find(question.object);
  if (!found) return fail(found);
  const session::ObjectState& object = **found;
  const std::string file = object.bank.string();
  if (question.offset >= object.bank_bytes) {
    return fail(ErrorKind::bad_input, "offset: {} is past the end of {}, which has {} bytes", question.offset, file,
                object.bank_bytes);
  }
  if (object.bank_alone) {
    const auto rest = std::span(*object.bank_alone).subspan(question.offset);
    const auto piece = rest.first(std::min<std::size_t>(rest.size(), question.bytes));
    return std::vector<protocol::Reply>{protocol::BankReply{object.name,
                                                            object.bank_version,
                                                            whole(question.offset),
                                                            whole(object.bank_alone->size()),
                                                            {piece.begin(), piece.end()}}};
  }
  auto piece = session.roots().read_piece(modal::split_bank_path(object.bank).file, question.offset, question.bytes);
  if (!piece) return fail(piece);
  if (piece->total != object.bank_bytes) {
    return fail(ErrorKind::refused, "{} is no longer the file from which \"{}\" was loaded; /load it again", file,
                object.name);
  }
  return std::vector<protocol::Reply>{protocol::BankReply{object.name, object.bank_version, whole(question.offset),
                                                          whole(piece->total), std::move(piece->bytes)}};
}

void append_pieces(const std::vector<session::PieceReport>& pieces, std::vector<protocol::Reply>& answer) {
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const session::PieceReport& piece = pieces[i];
    const auto& [x, y, z, w] = piece.mass.orientation;
    answer.emplace_back(protocol::PieceReply{whole(i), piece.name, piece.number ? whole(*piece.number) : -1,
                                             piece.mass.mass_kg, piece.mass.center_of_mass_m, piece.mass.inertia_kg_m2,
                                             x, y, z, w, piece.velocity_m_s, piece.spin_rad_s});
  }
}

Answer describe(const protocol::DescribePieces& question, const session::Session& session) {
  std::optional<std::size_t> pattern;
  if (question.pattern >= 0) pattern = static_cast<std::size_t>(question.pattern);
  const auto report = session.breakage().report(question.object, pattern);
  if (!report) return fail(report);
  const auto object = *session.rack().find(question.object);
  const modal::Fracture& fracture = *object->map->bank().fracture;
  std::vector<protocol::Reply> answer{
      protocol::PiecesReply{report->name, whole(report->pattern), whole(fracture.patterns.size()), report->broken,
                            whole(report->pieces.size()), report->armed, report->strength_pa}};
  const double size = object->material.size;
  for (std::size_t p = 0; p < fracture.patterns.size(); ++p) {
    const modal::BreakPattern& one = fracture.patterns[p];
    answer.emplace_back(
        protocol::PatternReply{whole(p), size * one.at_m, whole(one.pieces.size()),
                               modal::crack_cost_j(size * size * one.crack_area_m2, fracture.crack_energy_j_m2)});
  }
  append_pieces(report->pieces, answer);
  return answer;
}

Answer describe(const session::ScenePlayer& player) {
  const session::ScenePlayer::Description scene = player.describe();
  protocol::SceneReply head{.version = scene.version,
                            .bodies = whole(scene.bodies.size()),
                            .statics = whole(scene.statics.size()),
                            .duration_s = scene.duration_s};
  if (scene.camera) {
    head.camera_m = scene.camera->position_m;
    head.target_m = scene.camera->target_m;
    head.field_of_view_degrees = scene.camera->field_of_view_degrees;
  }
  if (scene.file) head.file = scene.file->string();
  std::vector<protocol::Reply> answer{head};
  for (const scene::BodyOutline& body : scene.bodies) {
    answer.emplace_back(protocol::SceneBody{scene.version, whole(body.id), body.name,
                                            body.object.empty() ? std::string("-") : body.object, to_text(body.shape),
                                            body.size_m, body.fixed});
  }
  for (std::size_t i = 0; i < scene.statics.size(); ++i) {
    const scene::StaticOutline& still = scene.statics[i];
    const scene::Rotation& q = still.rotation;
    answer.emplace_back(protocol::SceneStatic{scene.version, whole(i), still.name, to_text(still.type), still.size_m,
                                              still.position_m, q.x, q.y, q.z, q.w});
  }
  return answer;
}

Answer browse_all(const session::FileRoots& roots) {
  const auto files = browse(roots);
  if (!files) return fail(files);
  std::vector<protocol::Reply> answer{protocol::BrowseReply{whole(files->size())}};
  answer.insert(answer.end(), files->begin(), files->end());
  return answer;
}

}  // namespace

std::vector<protocol::Reply> news_of(const session::BrokenObject& object) {
  std::vector<protocol::Reply> news{
      protocol::BrokenReply{object.name, whole(object.pattern), whole(object.pieces.size())}};
  append_pieces(object.pieces, news);
  return news;
}

Answer answer_to(const protocol::Question& question, const session::Session& session) {
  return visit(Overloaded{
                   [&](const protocol::DescribeObject& object) { return describe(object, session); },
                   [&](const protocol::DescribePieces& pieces) { return describe(pieces, session); },
                   [&](const protocol::ReadBank& bank) { return read(bank, session); },
                   [&](const protocol::SceneDescribe&) { return describe(session.scene()); },
                   [&](const protocol::Browse&) { return browse_all(session.roots()); },
                   [&](const protocol::Sync& sync) { return Answer({protocol::Synced{sync.id}}); },
               },
               question);
}

}  // namespace ringdown::server
