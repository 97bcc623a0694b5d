// Reads and writes extras.ringdown of a bank's file, which goes beyond the public draft: provenance, estimated errors,
// the parts of the losses, and radiation maps (docs/reference/bank-format.md). Playing needs none of these. A value
// that does not fit its type or the bank's modes counts as absent; only the arrays of radiation maps are checked as
// strictly as the bank's own. Private to bank_file.cpp. [worker]
#pragma once

#include "engine/gltf/glb.h"
#include "engine/modal/bank.h"

namespace ringdown::modal {

// Reads the extras into `bank`, whose modes and material must have been read before.
Result<void> read_extras(const Glb& glb, const JsonPlace& extras, Bank& bank);

// Returns the JSON of the extras, and adds their arrays to `writer`.
Json extras_json(const Bank& bank, GlbWriter& writer);

// Returns true if Rayleigh's two numbers reproduce the material loss of every mode to 1 %. The bank must have a
// material.
bool rayleigh_reproduces_material(const Bank& bank);

}  // namespace ringdown::modal
