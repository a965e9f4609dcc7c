#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "robot/python/arrays.hpp"
#include "robot/python/bindings.hpp"
#include "robot/report/procedure/labels.hpp"

namespace biopsy::python {
namespace {

// Anterior and superior are the same in both; right and left, front and back change sign.
const Eigen::Vector3d kFlip(-1.0, -1.0, 1.0);

using Voxels = py::array_t<float, py::array::c_style | py::array::forcecast>;

// numpy's [k, j, i] in C order is the product's "i fastest".
Volume make_image(const py::object& given, const py::object& affine) {
  const auto voxels = real_array<Voxels>(given, "voxels");
  const Eigen::Matrix4d affine_ras = fixed_numbers<4, 4>(affine, "affine");
  if (voxels.ndim() != 3)
    throw ConfigError(fmt::format("has {} dimensions", voxels.ndim()), "voxels", "give an array [k, j, i]");
  for (int axis = 0; axis < 3; ++axis)
    if (voxels.shape(axis) < 1 || voxels.shape(axis) > 4096)
      throw ConfigError(fmt::format("axis {} has {} voxels", axis, voxels.shape(axis)), "voxels",
                        "give 1 to 4096 voxels along each axis");
  Volume image;
  image.format = "numpy";
  image.grid.size = {static_cast<int>(voxels.shape(2)), static_cast<int>(voxels.shape(1)),
                     static_cast<int>(voxels.shape(0))};
  const Eigen::Matrix3d axes = kFlip.asDiagonal() * affine_ras.topLeftCorner<3, 3>();
  const Eigen::Matrix3d unit = axes.colwise().normalized();
  const bool is_affine = affine_ras.allFinite() && affine_ras.row(3) == Eigen::RowVector4d(0, 0, 0, 1);
  if (!is_affine || !((unit.transpose() * unit - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-3))
    throw ConfigError("is not a map with perpendicular axes", "affine",
                      "give the 4 x 4 matrix from voxel (i, j, k) to RAS mm; reslice a sheared image first");
  image.grid.X_SI.linear() = axes;
  image.grid.X_SI.translation() = kFlip.cwiseProduct(affine_ras.topRightCorner<3, 1>());
  image.voxels.assign(voxels.data(), voxels.data() + voxels.size());
  if (!std::all_of(image.voxels.begin(), image.voxels.end(), [](float v) { return std::isfinite(v); }))
    throw ConfigError("a voxel is not a finite number", "voxels", "replace what is missing by 0");
  return image;
}

Eigen::Matrix4d affine_of(const Volume& image) {
  Eigen::Matrix4d affine = Eigen::Matrix4d::Identity();
  affine.topLeftCorner<3, 3>() = kFlip.asDiagonal() * image.grid.X_SI.linear();
  affine.topRightCorner<3, 1>() = kFlip.cwiseProduct(image.grid.X_SI.translation());
  return affine;
}

Voxels voxels_of(const Volume& image) {
  const Eigen::Vector3i& size = image.grid.size;
  Voxels voxels({size.z(), size.y(), size.x()});
  std::copy(image.voxels.begin(), image.voxels.end(), voxels.mutable_data());
  return voxels;
}

DepthCheck check(const Volume& before, const std::vector<Volume>& after, const py::object& entry,
                 const py::object& axis, std::optional<double> expected_mm,
                 std::optional<double> tip_offset_mm, double tip_offset_sigma_mm) {
  const Eigen::Vector3d entry_ras_mm = fixed_numbers<3, 1>(entry, "entry_ras_mm");
  const Eigen::Vector3d axis_ras = fixed_numbers<3, 1>(axis, "axis_ras");
  if (!entry_ras_mm.allFinite() || !axis_ras.allFinite() || !(axis_ras.norm() > 1e-6))
    throw ConfigError("are not finite, or the axis has no length", "entry_ras_mm, axis_ras",
                      "give three numbers each");
  if (after.empty()) throw ConfigError("there is no image", "after", "give one at least");
  imaging::DepthCheckSettings settings;
  if (expected_mm) settings.expected = Millimetres(in_range(*expected_mm, 0.0, 120.0, "expected_mm", "mm"));
  if (tip_offset_mm)
    settings.tip_offset = TipOffset{
        "by hand", "by hand", Millimetres(in_range(*tip_offset_mm, -20.0, 20.0, "tip_offset_mm", "mm")),
        Millimetres(in_range(tip_offset_sigma_mm, 0.0, 20.0, "tip_offset_sigma_mm", "mm"))};
  const py::gil_scoped_release released;
  return imaging::check_depth(before, after, kFlip.cwiseProduct(entry_ras_mm),
                              kFlip.cwiseProduct(axis_ras).normalized(), settings);
}

}  // namespace

void bind_images(py::module_& module) {
  py::class_<Volume>(module, "Image", "A volume of grey voxels with its place in the scanner.")
      .def(py::init(&make_image), py::arg("voxels"), py::arg("affine"),
           "voxels: array [k, j, i]. affine: 4 x 4, from voxel (i, j, k) to RAS mm, as of nibabel (whose "
           "arrays are "
           "[i, j, k]: give their transpose).")
      .def_property_readonly("voxels", &voxels_of, "Array [k, j, i], float32.")
      .def_property_readonly("affine", &affine_of, "4 x 4, from voxel (i, j, k) to RAS mm.")
      .def_property_readonly(
          "patient_id", [](const Volume& v) { return v.identity.patient_id; },
          "As the file says it; empty: it does not.")
      .def_readonly("format", &Volume::format, "\"DICOM\", \"NIfTI\", \"numpy\" and others.")
      .def_readonly("warnings", &Volume::warnings, "What should be known about the file, in sentences.")
      .def("__repr__", [](const Volume& v) {
        return fmt::format("<biopsy.Image {} x {} x {}, {}>", v.grid.size.x(), v.grid.size.y(),
                           v.grid.size.z(), v.format);
      });

  py::class_<DepthCheck>(module, "DepthCheck", "What two images say of the needle.")
      .def_property_readonly(
          "verdict", [](const DepthCheck& c) { return std::string(report::label(c.verdict)); },
          "\"accept\", \"reject\" or \"unsure\".")
      .def_readonly("reason", &DepthCheck::reason, "Of the verdict, as a sentence.")
      .def_readonly("tip_found", &DepthCheck::tip_found, "Without it the numbers below say nothing.")
      .def_property_readonly(
          "depth_mm", [](const DepthCheck& c) { return c.depth.value; },
          "mm, of the tip from the entry; without a tip offset of the void's end.")
      .def_property_readonly(
          "depth_sigma_mm", [](const DepthCheck& c) { return c.sigma.value; },
          "Standard deviation of it, mm.")
      .def_readonly("lateral_mm", &DepthCheck::lateral_mm, "Distance of the tip from the planned axis, mm.")
      .def_readonly("lateral_sigma_mm", &DepthCheck::lateral_sigma_mm, "Standard deviation of it, mm.")
      .def_readonly("angle_deg", &DepthCheck::angle_deg, "Between needle and planned axis, degrees.")
      .def_readonly("angle_sigma_deg", &DepthCheck::angle_sigma_deg, "Standard deviation of it, degrees.")
      .def_readonly("registration_score", &DepthCheck::registration_score,
                    "How well the images lie on each other: a correlation, at most 1.")
      .def("__repr__", [](const DepthCheck& c) {
        return fmt::format("<biopsy.DepthCheck {}: {}>", std::string(report::label(c.verdict)), c.reason);
      });

  module.def("read_image", &imaging::read_volume, py::arg("path"), py::arg("series_uid") = "",
             "A file or folder of DICOM, NIfTI, NRRD or MetaImage.");
  module.def("check_depth", &check, py::arg("before"), py::arg("after"), py::arg("entry_ras_mm"),
             py::arg("axis_ras"), py::kw_only(), py::arg("expected_mm") = py::none(),
             py::arg("tip_offset_mm") = py::none(), py::arg("tip_offset_sigma_mm") = 0.2,
             "Reads the needle's depth from a list of images taken together, compared with the image before. "
             "axis_ras: direction of insertion, of any length. Without a tip offset nothing is accepted.");
}

}  // namespace biopsy::python
