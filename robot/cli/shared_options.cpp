#include "robot/cli/shared_options.hpp"

#include <fmt/format.h>

#include <vector>

#include "drivers/needle_stage_factory.hpp"
#include "robot/common/config_error.hpp"
#include "robot/procedure/case/rehearsal_settings.hpp"

namespace biopsy::robot {

CLI::Option* add_out(CLI::App& app, std::filesystem::path& out, const std::string& content) {
  return add(app, "--out FOLDER", out, "folder for " + content);
}

CLI::Option* add_model(CLI::App& app, std::filesystem::path& model, const std::string& meaning,
                       const std::string& default_file) {
  return app.add_option("--model", model, meaning)->type_name("FILE")->default_str(default_file);
}

void add_case_options(CLI::App& app, ProcedureOptions& options) {
  add(app, "CASE", options.case_name, "case file (TOML) or a built-in case: `gap`, `liver`", "liver");
  add(app, "--image PATH", options.image,
      "planning image, instead of a case: a DICOM folder or file, NIfTI or NRRD");
  add(app, "--series UID", options.series,
      "series UID, where the folder holds several (`biopsy image` lists them)");
  add(app, "--entry R,A,S", options.entry,
      "where the needle tip waits, mm; needed with `--image` (`up --console`: set on the page)");
  add(app, "--target R,A,S", options.target, "where it shall go, mm; needed with `--entry`");
  add(app, "--markups FILE", options.markups,
      "entry and target from a file of 3D Slicer (`.mrk.json`, `.fcsv`); with it `--entry` and `--target` "
      "are "
      "labels of its points, not numbers; with `--image`",
      "the labels `entry` and `target`");
  add(app, "--labels PATH", options.labels,
      "label map or segmentation (`.seg.nrrd`, DICOM SEG) of the tissues on the same patient; with "
      "`--image`");
  app.add_flag("--labels-anyway", options.labels_anyway,
               "take the labels though they look like a grey image: you have looked at them");
  add(app, "--fiducials FILE", options.fiducials,
      "CSV of fiducial pairs, robot and scanner; replaces the case's");
  add_model(app, options.model, "plant model of the simulated stage (TOML); replaces the case's",
            "sim/models/calibrated.toml");
  add(app, "--controller FILE", options.controller,
      "gains of the PI loop, as `biopsy tune` writes them; replaces the case's", "the paper's");
  add_seed(app, options.seed, "noise and patient motion; replaces the case's");
}

void add_procedure_options(CLI::App& app, ProcedureOptions& options) {
  add_case_options(app, options);
  add_out(app, options.out, "the report; one with other people's files is refused")->required();
}

void add_image_source(CLI::App& app, ProcedureOptions& options, CLI::Option* where) {
  CLI::Option* folder =
      add(app, "--images-from FOLDER", options.images_from,
          "take the confirmation images from this folder, into which a scanner exports its series",
          "the simulated scanner");
  if (where != nullptr) folder->needs(where);
  add(app, "--images-quiet S", options.images_quiet_s,
      "a series is complete when nothing in that folder has changed for this time", "2")
      ->check(in_range(0.2, 60.0, "s"))
      ->needs(folder);
  add(app, "--images-patience S", options.images_patience_s, "how long an image is waited for", "120")
      ->check(in_range(1.0, 600.0, "s"))
      ->needs(folder);
  add(app, "--images-confirmed-by NAME", options.images_confirmed_by,
      "the person who answers for images that do not name patient, frame of reference or time (NIfTI, NRRD, "
      "MetaImage); without one such images leave the depth unsure")
      ->needs(folder);
  add(app, "--images-planes N", options.images_planes,
      "how many planes of an image the scanner exports as a series each; all are waited for",
      "three, or as many as there are after four times --images-quiet")
      ->check(in_range(1, 3))
      ->needs(folder);
  app.add_option("--scan", options.scan_s,
                 "how long a simulated image takes, where the stage can lock its needle meanwhile")
      ->type_name("S")
      ->default_str("the case's, 30; in real time 2")
      ->check(in_range(kScanMin_s, kScanMax_s, "s"))
      ->excludes(folder);
}

void add_live_options(CLI::App& app, LiveOptions& options, CLI::Option* live) {
  CLI::Option* keys = add(app, "--keys FOLDER", options.keys, "folder of `biopsy keys init`",
                          "the user's own set; for a simulated stage one made for the run");
  const std::vector<CLI::Option*> all{
      keys,
      add(app, "--domain N", options.domain, "DDS domain, one for each robot on a network", "0")
          ->check(in_range(0, 230)),
      app.add_flag("--without-security", options.without_security,
                   "no authentication and no encryption; with the simulated stage only")
          ->excludes(keys),
      add(app, "--network NAME", options.network, "network interface", "this machine only"),
      add(app, "--fifo N", options.fifo_priority,
          "SCHED_FIFO priority of the control processes, where permitted; 0: ordinary scheduling", "60")
          ->check(in_range(0, 90))};
  if (live != nullptr)
    for (CLI::Option* option : all) option->needs(live);
}

void add_device(CLI::App& app, std::string& device) {
  const std::vector<std::string> names(drivers::kStageDevices.begin(), drivers::kStageDevices.end());
  add(app, "--device NAME", device, fmt::format("the stage: `{}`", fmt::join(names, "` or `")), names[0])
      ->check(CLI::IsMember(names));
}

void add_device_options(CLI::App& app, std::string& device, HardwareOptions& hardware) {
  add_device(app, device);
  add(app, "--device-config FILE", hardware.config, "real stage: channels and scales (TOML)");
  add(app, "--commissioning FOLDER", hardware.commissioning, "real stage: folder of `biopsy commission`");
}

void check_device_options(const std::string& device, const HardwareOptions& hardware) {
  if (!drivers::is_simulated(device) && (hardware.config.empty() || hardware.commissioning.empty()))
    throw ConfigError("a real stage without --device-config or --commissioning", "command line",
                      "give both; `biopsy commission` makes the record");
  if (drivers::is_simulated(device) && (!hardware.config.empty() || !hardware.commissioning.empty()))
    throw ConfigError("--device-config or --commissioning for the simulated stage, which has neither",
                      "command line", "leave them out, or add --device nidaqmx");
}

}  // namespace biopsy::robot
