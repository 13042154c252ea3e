// The one translation unit of the library that holds the reference decoder.
#define NMC_DECODE_IMPLEMENTATION
#include "codec/reference_codec.h"
