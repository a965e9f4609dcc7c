// The image of a needle from first principles: signal void, dephasing and misplaced signal.
#pragma once

#include "robot/msg/volume.hpp"
#include "sim/scanner/susceptibility/needle_body.hpp"
#include "sim/scanner/susceptibility/needle_field.hpp"
#include "sim/scanner/susceptibility/sequence.hpp"

namespace biopsy::sim {

// `tissue` as the sequence shows it with the needle in it; grid, identity and units stay. Each voxel near the
// needle is cut into subvoxels with the voxel's signal; those within the needle give none. The others precess
// at the field's offset, f, at their place: a gradient echo gives them the phase f * TE and what a linear
// change of it across the subvoxel leaves of the signal; signal is moved by f over the bandwidth per pixel
// along the read direction, stretched or piled up as f changes, and by f over the excitation's bandwidth
// through the slices (the third axis). A voxel of the result is the magnitude of the sum. So a needle without
// contrast gives the void alone, and no signal is made or lost by a spin echo but at the borders of the
// image. Not in the model: relaxation, RF shielding and heating, signal of the metal, k-space truncation.
// Takes some tenths of a second for a field of view about the needle. Throws ConfigError: see
// refuse_bad_needle and refuse_bad_sequence; an empty volume.
Volume image_with_needle(const Volume& tissue, const NeedleBody& needle, const Sequence& sequence);

// The same with the field at hand, for many sequences of one direction of B0.
Volume image_with_needle(const Volume& tissue, const NeedleField& field, const Sequence& sequence);

}  // namespace biopsy::sim
