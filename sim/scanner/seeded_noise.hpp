#pragma once
#include "sim/seeded_noise.hpp"
