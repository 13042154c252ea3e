// The C reference decoder with its writing half, as the encoder uses it.
#pragma once

#define NMC_ENCODER
#include "nmc_decode.h"
