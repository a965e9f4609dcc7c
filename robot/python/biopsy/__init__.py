"""The needle-biopsy robot for algorithms and laboratories: plant, gap search, depth check, planner and the control
cycle with its supervisor, on numpy arrays. Units are part of the names; points are RAS mm."""

import os as _os
import pathlib as _pathlib

# The models and cases of the installation, or of the build tree, that this package belongs to, wherever it was moved.
for _folder in _pathlib.Path(__file__).resolve().parents:
    _told = _folder / "source_folder.txt"
    _data = _pathlib.Path(_told.read_text().strip()) if _told.is_file() else _folder / "share/biopsy"
    if (_data / "sim/models").is_dir():
        _os.environ.setdefault("BIOPSY_DATA", str(_data))
        break

from ._biopsy import (  # noqa: E402  (after the folder is known)
    DepthCheck,
    Finding,
    Image,
    Model,
    Rehearsal,
    Robot,
    Run,
    __version__,
    check_depth,
    gap,
    plan,
    read_dataset,
    read_image,
    read_model,
    rehearse,
    simulate,
)
from ._errors import InputError  # noqa: E402

__all__ = [
    "DepthCheck", "Finding", "Image", "InputError", "Model", "Rehearsal", "Robot", "Run", "__version__", "check_depth",
    "gap", "plan", "read_dataset", "read_image", "read_model", "rehearse", "simulate",
]
