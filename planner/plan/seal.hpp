// The plan's seal: SHA-256 over one fixed serialisation of everything in the plan but the seal itself.
// Whoever holds the seal can tell whether patient, image, registration, target, layers, steps or limits were
// changed.
#pragma once

#include <cstdint>
#include <vector>

#include "robot/msg/plan.hpp"

namespace biopsy::planner {

// Fields in the order of the struct, after the tag "biopsy-plan-1". Integers little-endian; strings and lists
// with a 64-bit length before them; doubles as IEEE 754 bits, -0 as +0; X_SR as 16 doubles row by row; enums
// and flags one byte. A plan for the bench has the text "bench" and its half period behind all that; one
// with a calibrated tip offset the text "tip offset", needle, sequence, value and standard deviation.
std::vector<std::uint8_t> canonical_bytes(const Plan& plan);

Sha256 seal_of(const Plan& plan);
void seal(Plan& plan);
bool seal_holds(const Plan& plan);

// First 8 bytes of the seal, most significant first: its hexadecimal form is how the seal begins. What
// permits carry.
std::uint64_t plan_tag(const Plan& plan);

}  // namespace biopsy::planner
