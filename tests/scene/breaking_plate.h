// A plate that breaks into a grid of boxes. No mesh is cut for it: masses and inertias are those of boxes by formula,
// and the handover is any matrix at all.
#pragma once

#include "engine/modal/fracture/fracture.h"
#include "tests/scene/box_bank.h"

#include <cstddef>
#include <memory>
#include <random>
#include <utility>

namespace ringdown::test {

struct PlateGrid {
  Vec3 size_m = {0.3, 0.2, 0.01};
  double mass_kg = 1;
  std::size_t along = 4, across = 3;  // pieces
  double hull = 1;                    // length of a piece's hull over that of its cell; above 1 the hulls overlap
  float handover = 0.3F;              // bound on the entries of the handover
};

// The plate, its pieces and all their handovers; one mode each.
inline modal::Bank breaking_plate(const PlateGrid& grid = {}) {
  modal::Bank plate = box_bank(grid.size_m, grid.mass_kg);
  modal::BreakPattern pattern{.at_m = {}, .crack_area_m2 = 1e-3, .pieces = {}};
  std::mt19937 random(7);
  std::uniform_real_distribution<float> entry(-grid.handover, grid.handover);
  const Vec3 cell{grid.size_m.x / static_cast<double>(grid.along), grid.size_m.y / static_cast<double>(grid.across),
                  grid.size_m.z};
  const double share = 1.0 / static_cast<double>(grid.along * grid.across);
  for (std::size_t i = 0; i < grid.along * grid.across; ++i) {
    const auto middle = [](std::size_t k, std::size_t of) {
      return (static_cast<double>(k) + 0.5) / static_cast<double>(of) - 0.5;
    };
    const Vec3 center{grid.size_m.x * middle(i % grid.along, grid.along),
                      grid.size_m.y * middle(i / grid.along, grid.across), 0};
    modal::PieceBank piece{.bank = box_bank(cell, share * grid.mass_kg, center), .handover = {}};
    const modal::Bank wide = box_bank({grid.hull * cell.x, grid.hull * cell.y, cell.z}, 1, center);
    piece.bank.positions = wide.positions;
    piece.bank.frequency_hz = {4000.0 + 10.0 * static_cast<double>(i)};
    piece.handover.assign((modal::kRigidMotions + 1) * (modal::kRigidMotions + 1), 0);
    for (std::size_t row = 0; row <= modal::kRigidMotions; ++row)
      piece.handover[row * (modal::kRigidMotions + 1) + modal::kRigidMotions] = entry(random);
    pattern.pieces.push_back(std::move(piece));
  }
  auto fracture = std::make_shared<modal::Fracture>();
  fracture->patterns.push_back(std::move(pattern));
  plate.fracture = fracture;
  return plate;
}

// The plate in two halves, each of which breaks again into its half of the grid; `along` is even. The plate's own
// vibration never pays for the fine pattern.
inline modal::Bank nested_plate(const PlateGrid& grid = {}) {
  PlateGrid halves = grid;
  halves.along = 2;
  halves.across = 1;
  modal::Bank plate = breaking_plate(halves);
  modal::Fracture fracture = *plate.fracture;
  modal::BreakPattern fine = breaking_plate(grid).fracture->patterns[0];
  for (std::size_t i = 0; i < fine.pieces.size(); ++i) {
    fine.pieces[i].coarser = i % grid.along * 2 / grid.along;
    fine.pieces[i].from_coarser = fine.pieces[i].handover;
  }
  fine.crack_area_m2 = 1;
  fracture.patterns.push_back(std::move(fine));
  fracture.crack_energy_j_m2 = 1e6;
  for (modal::PieceBank& half : fracture.patterns[0].pieces) half.crack_area_m2 = 0.5;
  plate.fracture = std::make_shared<const modal::Fracture>(std::move(fracture));
  return plate;
}

// The plate as object 0, and its pieces as objects 1 and up.
inline std::vector<scene::SoundingObject> plate_objects(const modal::Bank& plate, const std::string& name = "plate") {
  std::vector<scene::SoundingObject> objects{sounding(name, 0, plate)};
  for (const modal::BreakPattern& pattern : plate.fracture->patterns) {
    for (const modal::PieceBank& piece : pattern.pieces) {
      const auto number = static_cast<synth::ObjectNumber>(objects.size());
      objects.push_back(sounding(name + "." + std::to_string(number - 1), number, piece.bank));
    }
  }
  return objects;
}

}  // namespace ringdown::test
