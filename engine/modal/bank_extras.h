// Reads and writes extras.ringdown of a bank's file, which goes beyond the public draft: how the bank was made, how far
// it can be trusted, what its modes lose to what, and what they radiate (docs/reference/bank-format.md). None of it is
// needed to play: what does not fit its type or the bank's modes counts as absent, but for the maps of what modes
// radiate, whose arrays are checked as the bank's own are. Private to bank_file.cpp. [worker]
#pragma once

#include "engine/gltf/glb.h"
#include "engine/modal/bank.h"

namespace ringdown::modal {

// Reads what belongs to the bank's modes and material, which the bank must have already.
Result<void> read_extras(const Glb& glb, const JsonPlace& extras, Bank& bank);

// Adds its arrays to the writer's.
Json extras_json(const Bank& bank, GlbWriter& writer);

// Whether Rayleigh's two numbers give every mode of the bank what its material takes, to 1 %. The bank has a material.
bool rayleigh_reproduces_material(const Bank& bank);

}  // namespace ringdown::modal
