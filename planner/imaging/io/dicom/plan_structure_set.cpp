#include "planner/imaging/io/dicom/plan_structure_set.hpp"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>

#include "planner/imaging/io/dicom/dicom_fields.hpp"
#include "planner/imaging/io/dicom/dicom_pixels.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/sha256.hpp"

namespace biopsy::imaging {
namespace {

namespace fs = std::filesystem;

using Texts = std::initializer_list<std::pair<DcmTagKey, std::string>>;

// What a structure set says once for its patient and study, from the image; PS3.3 C.7.1.1, C.7.2.1, C.7.4.1.
// Attributes that the image does not have are there and empty (type 2).
const std::vector<DcmTagKey> kCopied{
    DCM_PatientName,      DCM_PatientID,       DCM_PatientBirthDate,    DCM_PatientSex,
    DCM_StudyInstanceUID, DCM_StudyDate,       DCM_StudyTime,           DCM_ReferringPhysicianName,
    DCM_StudyID,          DCM_AccessionNumber, DCM_FrameOfReferenceUID, DCM_PositionReferenceIndicator};

struct Structure {
  std::string name, description;
  std::vector<Point> points;  // one: a point; more: a line
};

void put(DcmItem& out, Texts texts) {
  for (const auto& [tag, text] : texts) out.putAndInsertString(tag, text.c_str());
}

DcmItem& appended_item(DcmItem& out, const DcmTagKey& sequence) {
  DcmItem* item = nullptr;
  const OFCondition made = out.findOrCreateSequenceItem(sequence, item, -2);
  if (made.bad())
    throw ConfigError(fmt::format("{} cannot be made ({})", dicom_tag_name(sequence), made.text()),
                      "DICOM library", "report this as a defect");
  return *item;
}

std::vector<Structure> structures_of(const Plan& plan) {
  const auto tip_at = [&](Millimetres depth) { return Point(plan.X_SR * Point(0.0, 0.0, depth.value)); };
  std::vector<Structure> structures{
      {"entry", "where the needle tip waits", {plan.target.p_SE}},
      {"target", "where it shall go", {plan.target.p_ST}},
      {"needle path", "way of the tip", {tip_at(Millimetres(0.0)), tip_at(plan.target_depth)}}};
  for (std::size_t n = 0; n < plan.steps.size(); ++n)
    structures.push_back({fmt::format("stage {}: {:.2f} mm", n + 1, plan.steps[n].depth.value),
                          "the tip at the end of the step",
                          {tip_at(plan.steps[n].depth)}});
  return structures;
}

std::unique_ptr<DcmFileFormat> header_of(const std::string& file) {
  auto content = std::make_unique<DcmFileFormat>();
  const OFCondition loaded = content->loadFileUntilTag(file.c_str(), EXS_Unknown, EGL_noChange,
                                                       DCM_MaxReadLength, ERM_autoDetect, DCM_PixelData);
  if (loaded.bad())
    throw ConfigError(fmt::format("cannot be read any more ({})", loaded.text()), file,
                      "leave the planning image where it is until the plan is written");
  return content;
}

void put_identity(const Plan& plan, DcmItem& image, DcmItem& out) {
  image.findAndInsertCopyOfElement(DCM_SpecificCharacterSet, &out);
  for (const DcmTagKey& tag : kCopied)
    if (image.findAndInsertCopyOfElement(tag, &out).bad()) out.insertEmptyElement(tag);
  std::string content(plan.seal.begin(), plan.seal.end());
  content += dicom_text(image, DCM_SeriesInstanceUID);
  const auto uid = [&](const char* role) {
    return fmt::format("2.25.{}", first_64_bits(sha256(content + role)));
  };
  put(out, {{DCM_SOPClassUID, UID_RTStructureSetStorage},
            {DCM_SOPInstanceUID, uid("instance")},
            {DCM_SeriesInstanceUID, uid("series")},
            {DCM_SeriesNumber, ""},
            {DCM_SeriesDescription, "needle plan"},
            {DCM_Modality, "RTSTRUCT"},
            {DCM_OperatorsName, ""},
            {DCM_Manufacturer, ""},
            {DCM_StructureSetLabel, "needle plan"},
            {DCM_StructureSetDate, ""},  // the same plan is the same file on any day
            {DCM_StructureSetTime, ""},
            {DCM_ApprovalStatus, "UNAPPROVED"}});
}

// Every instance of the image: of an enhanced image there is one.
void put_reference(const Volume& image, DcmItem& out) {
  DcmItem& frame = appended_item(out, DCM_ReferencedFrameOfReferenceSequence);
  put(frame, {{DCM_FrameOfReferenceUID, image.identity.frame_of_reference_uid}});
  DcmItem& study = appended_item(frame, DCM_RTReferencedStudySequence);
  put(study, {{DCM_ReferencedSOPClassUID, UID_RETIRED_DetachedStudyManagementSOPClass},
              {DCM_ReferencedSOPInstanceUID, image.identity.study_uid}});
  DcmItem& series = appended_item(study, DCM_RTReferencedSeriesSequence);
  put(series, {{DCM_SeriesInstanceUID, image.identity.series_uid}});
  for (const std::string& file : std::set<std::string>(image.files.begin(), image.files.end())) {
    const auto content = header_of(file);
    DcmItem& dataset = *content->getDataset();
    put(appended_item(series, DCM_ContourImageSequence),
        {{DCM_ReferencedSOPClassUID, dicom_text(dataset, DCM_SOPClassUID)},
         {DCM_ReferencedSOPInstanceUID, dicom_text(dataset, DCM_SOPInstanceUID)}});
  }
}

void put_structure(const Structure& structure, int number, const std::string& frame_uid, DcmItem& out) {
  const std::string id = std::to_string(number);
  put(appended_item(out, DCM_StructureSetROISequence), {{DCM_ROINumber, id},
                                                        {DCM_ReferencedFrameOfReferenceUID, frame_uid},
                                                        {DCM_ROIName, structure.name},
                                                        {DCM_ROIDescription, structure.description},
                                                        {DCM_ROIGenerationAlgorithm, ""}});
  std::string places;  // L, P, S mm, to 0.1 um
  for (const Point& p_S : structure.points)
    places += fmt::format("{}{:.4f}\\{:.4f}\\{:.4f}", places.empty() ? "" : "\\", p_S.x(), p_S.y(), p_S.z());
  DcmItem& contours = appended_item(out, DCM_ROIContourSequence);
  put(contours, {{DCM_ReferencedROINumber, id}});
  put(appended_item(contours, DCM_ContourSequence),
      {{DCM_ContourGeometricType, structure.points.size() == 1 ? "POINT" : "OPEN_NONPLANAR"},
       {DCM_NumberOfContourPoints, std::to_string(structure.points.size())},
       {DCM_ContourData, places}});
  put(appended_item(out, DCM_RTROIObservationsSequence), {{DCM_ObservationNumber, id},
                                                          {DCM_ReferencedROINumber, id},
                                                          {DCM_RTROIInterpretedType, ""},
                                                          {DCM_ROIInterpreter, ""}});
}

}  // namespace

bool takes_structure_set(const Volume& image) {
  return image.format == "DICOM" && !image.files.empty() && !image.identity.study_uid.empty() &&
         !image.identity.frame_of_reference_uid.empty();
}

void write_plan_structure_set(const Plan& plan, const Volume& image, const fs::path& file) {
  ready_dicom_library();
  DcmFileFormat content;
  DcmItem& out = *content.getDataset();
  put_identity(plan, *header_of(image.files.front())->getDataset(), out);
  put_reference(image, out);
  int number = 0;
  for (const Structure& structure : structures_of(plan))
    put_structure(structure, ++number, image.identity.frame_of_reference_uid, out);
  const OFCondition saved = content.saveFile(file.c_str(), EXS_LittleEndianExplicit);
  if (saved.bad())
    throw ConfigError(fmt::format("cannot be written: {}", saved.text()), file.string(),
                      "check the space left and the permissions");
}

}  // namespace biopsy::imaging
