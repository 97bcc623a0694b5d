// Reads and writes the pieces of a body in its bank's file (docs/reference/bank-format.md). Private to bank_file.cpp.
// [worker]
//
// The file's first model and first scene are the whole body, so that a reader without fracture plays it as any bank.
// Pieces that ring are further models; all pieces have nodes in a second scene. extras.ringdown.fracture of the first
// model holds the rest.
#pragma once

#include "engine/base/result.h"
#include "engine/gltf/glb.h"
#include "engine/modal/fracture/fracture.h"

#include <functional>

namespace ringdown::modal {

// Reads a model without its own fracture, or the mass and the mesh of a piece without modes.
struct PieceReaders {
  std::function<Result<Bank>(std::size_t model)> model;
  std::function<Result<Bank>(const JsonPlace& piece)> silent;
};

// Reads the field `fracture` of a body's bank, which is otherwise read. Fails with a sentence when a count, an index or
// a number is out of range, when an entry of a handover is above 1, which no body's is, when a principal stress
// is above its mode's largest, when body or piece have no mass or no inertia, or when all pieces together take more
// than 512 MiB. Banks of earlier versions have no stress, no strength and no crack energy.
Result<Fracture> read_fracture(const Glb& glb, const JsonPlace& fracture, const Bank& body,
                               const PieceReaders& readers);

// Returns the JSON of the field and adds its arrays to the document, packed if `packed`: then each stress is rounded by
// at most 1/1024 of its mode's largest. `describe` adds a piece to the document and returns the JSON that names it
// there.
Json fracture_json(const Fracture& fracture, GlbWriter& writer, bool packed,
                   const std::function<Json(const PieceBank&)>& describe);

}  // namespace ringdown::modal
