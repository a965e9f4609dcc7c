// Diagnostics of the libraries that have their own: into our log instead of onto stderr.
#pragma once

namespace biopsy::robot {

// Ceres (glog), DCMTK and OpenCV. Once, in main, before any of them is used.
void log_library_messages();

}  // namespace biopsy::robot
