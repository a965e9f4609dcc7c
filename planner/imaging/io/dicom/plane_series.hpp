// Planes that were taken together and exported as a series each, as most scanners do: three orthogonal
// slices.
#pragma once

#include <span>
#include <string>

#include "planner/imaging/io/dicom/dicom_reader.hpp"

namespace biopsy::imaging {

inline constexpr std::size_t kPlanesMax = 3;       // of one confirmation image
inline constexpr std::size_t kPlaneSlicesMax = 3;  // a series of more is an image of its own

// A series of few parallel slices: it may be one of several planes.
bool is_plane(const DicomSeries& series);

// Whether two planes are of clearly different orientation; of one orientation they are an image and its
// repetition.
bool in_other_planes(const DicomSeries& a, const DicomSeries& b);

// Why two images were not taken together: "two patients", "two studies", "two frames of reference"; empty:
// nothing that both state differs.
std::string taken_apart(const SeriesIdentity& a, const SeriesIdentity& b);

// Throws ConfigError naming `where` for images of which two were not taken together.
void refuse_taken_apart(std::span<const Volume> images, const std::string& where);

// Whether the series are two or three planes of different orientation: one image, whoever it is of.
bool are_planes(std::span<const DicomSeries> series);

}  // namespace biopsy::imaging
