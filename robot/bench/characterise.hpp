// biopsy characterise: experiments on a stage without patient and needle.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace biopsy::robot {

struct CharacteriseOptions {
  std::vector<std::string> experiments;  // none: all
  std::string device = "sim";
  std::filesystem::path model;  // of the simulated stage; empty: the one of rehearsals
  double weight_g = 50.0;
  double drive_scale = 1.0;  // how many times the nominal voltage the stage needs for a depth
  double push_scale = 1.0;   // how many times the nominal push is laid on
  std::uint64_t seed = 1;
  bool dry_run = false;          // says what would be done
  bool bench = false;            // no patient, no needle
  bool weights_by_hand = false;  // on a real stage: somebody lays weights on under voltage
  std::filesystem::path device_config, commissioning,
      keys;  // of a real stage; keys empty: the user's own set
  std::filesystem::path out;
};

// Exit code 0: every run came to its end; 3: the supervisor stopped one.
int characterise(const CharacteriseOptions& options);

}  // namespace biopsy::robot
